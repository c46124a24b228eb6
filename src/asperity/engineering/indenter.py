"""The rough surface of a case in metres, made from a measured map, and what was done to the map."""

from __future__ import annotations

import os
from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np

from asperity.arguments import choice
from asperity.spectral import Grid
from asperity.surface.face_to_face import face_to_face
from asperity.surface.form import AXES, add_cylinder, add_sphere
from asperity.surface.height_map import PEAKS_UP, HeightMap, MapError
from asperity.surface.levelling import mirrored as mirror_images
from asperity.surface.measured import missing_settings
from asperity.surface.reading import Inspected, Reading, inspect_map
from asperity.surface.treatment import TreatedMap, Treatment, treat_map
from asperity.surface.unpacked_size import DEFAULT_LIMIT
from asperity.types import Array
from asperity.units import shown_si

BOUNDARIES = ("periodic", "free")
"""The surface repeats sideways, or nothing surrounds it."""

FORMS = ("sphere", "cylinder")
"""Forms that can be added to the roughness."""

DEFAULT_PERIODICITY = {"periodic": "mirrored", "free": "none"}
"""How a map that does not call itself periodic is treated for each boundary: no height is altered."""


@dataclass(frozen=True)
class MapSettings:
    """What is known of a map beside its file, and how it is prepared and pressed.

    Parameters
    ----------
    unit, channel, orientation : str, optional
        As of `asperity.surface.reading.Reading`, for files that do not say them.
    physical_size : (length_y, length_x), optional
        Edges in m, for files that do not say them.
    height_factor : float, optional
        Factor from the numbers in the file to heights in its unit.
    detrend : "none", "tilt" or "curvature"
    periodic : str, optional
        As of `asperity.surface.treatment.Treatment`; by default a map that does not call itself periodic is
        mirrored, and with a free boundary left as it is.
    undefined : "harmonic", optional
        How points without data are filled; None refuses them.
    despike : float, optional
        Threshold above which spikes are removed, in robust standard deviations.
    wavelength_short : float, optional
        Waves shorter than this, in m, are removed.
    points : int, optional
        Nodes on the longer edge of the cell.
    boundary : "periodic" or "free"
        The surface repeats sideways, or nothing surrounds the map.
    radius : float, optional
        Radius in m of a sphere or cylinder whose form is added to the roughness, its lowest point or line in
        the middle of the map.
    form : "sphere" or "cylinder"
        What the radius is of.
    cylinder_axis : "y" or "x"
        Direction of the axis of a cylinder.
    max_memory : float
        Largest size in GiB to which the file may unpack.
    option : callable
        Gives the name of a setting in the interface of the user, for messages.

    Examples
    --------
    >>> settings = MapSettings(despike=8, wavelength_short=16e-6, points=192)
    >>> MapSettings(boundary="free", radius=5e-3).boundary  # a rough ball
    'free'
    """

    unit: str | None = None
    channel: str | None = None
    orientation: str | None = None
    physical_size: tuple[float, float] | None = None
    height_factor: float | None = None
    detrend: str = "tilt"
    periodic: str | None = None
    undefined: str | None = "harmonic"
    despike: float | None = None
    wavelength_short: float | None = None
    points: int | None = None
    boundary: str = "periodic"
    radius: float | None = None
    form: str = "sphere"
    cylinder_axis: str = "y"
    max_memory: float = DEFAULT_LIMIT
    option: Callable[[str], str] = field(default=str, repr=False, compare=False)

    def __post_init__(self) -> None:
        choice(self.option("boundary"), self.boundary, BOUNDARIES)
        choice(self.option("form"), self.form, FORMS)
        choice(self.option("cylinder_axis"), self.cylinder_axis, AXES)
        if self.boundary == "free" and self.periodic not in (None, "none"):
            raise ValueError(
                f"{self.option('periodic')} = {self.periodic!r}: not accepted with a free boundary, which "
                "takes the map as it is"
            )

    @property
    def reading(self) -> Reading:
        """What is known of the file."""
        size = self.physical_size
        return Reading(
            physical_size=None if size is None else (f"{size[0]:.17g} m", f"{size[1]:.17g} m"),
            height_factor=self.height_factor,
            unit=self.unit,
            channel=self.channel,
            orientation=self.orientation,
            max_memory=self.max_memory,
        )

    def treatment(self, surface: HeightMap) -> Treatment:
        """How a map is prepared."""
        own = None if surface.periodic and self.boundary == "periodic" else DEFAULT_PERIODICITY[self.boundary]
        return Treatment(
            detrend=self.detrend,
            periodic=self.periodic or own,
            undefined=self.undefined,
            despike=self.despike,
            wavelength_short=self.wavelength_short,
            points=self.points,
        )


@dataclass(frozen=True)
class CounterMap:
    """A map of the upper body, and how it is laid on that of the lower one.

    Parameters
    ----------
    source : path or HeightMap
        File of a map, or a map in metres, with its peaks upward as measured.
    settings : MapSettings, optional
        What is known of the file, and how trend, spikes and points without data are treated; by default as
        for the other map.
    turned_about : "y" or "x"
        Axis about which the map is turned over, to face down.
    shift : (y, x)
        Position in m of the middle of this map over that of the other one.
    """

    source: str | os.PathLike[str] | HeightMap
    settings: MapSettings | None = None
    turned_about: str = "y"
    shift: tuple[float, float] = (0.0, 0.0)


@dataclass(frozen=True)
class Indenter:
    """A rough surface as the lower face of an indenter.

    Parameters
    ----------
    name : str
        Name of the map.
    height : (ny, nx) array
        In m, measured upward: the lowest points touch first.
    grid : Grid
        In m.
    map_length : (length_y, length_x)
        Edges of the map in m; those of the cell of a mirrored map are twice as long.
    wavelength_short : float
        Shortest wavelength that was kept, in m.
    boundary : "periodic" or "free"
    altered_share : float
        Share of the area in which a window lowered the heights.
    edge_step : float
        Rms step of the heights across the edges of the cell over that between neighbouring nodes; 0 with a
        free boundary.
    filled_share : float
        Share of the points of the map that had no data or were spikes.
    done : tuple of str
        What was done to the map, in words.
    """

    name: str
    height: Array
    grid: Grid
    map_length: tuple[float, float]
    wavelength_short: float
    boundary: str = "periodic"
    altered_share: float = 0.0
    edge_step: float = 0.0
    filled_share: float = 0.0
    done: tuple[str, ...] = ()

    @property
    def map_area(self) -> float:
        """Nominal area in m²."""
        return self.map_length[0] * self.map_length[1]

    @property
    def is_mirrored(self) -> bool:
        """True if the cell holds the map and its mirror images."""
        return self.map_length != self.grid.length

    @property
    def map_shape(self) -> tuple[int, int]:
        """Nodes (y, x) of the map in the cell."""
        images = 2 if self.is_mirrored else 1
        return self.grid.shape[0] // images, self.grid.shape[1] // images

    def is_on_map(self, y: Array, x: Array) -> Array:
        """True for places in the cell that belong to the map, and not to one of its mirror images.

        A peak on the mirror is found between a node of the map and its image, to rounding: places up to the
        nearest nodes of the images belong to the map. There is no second peak so near to the mirror.
        """
        own = np.ones(np.shape(y), bool)
        if self.is_mirrored:
            for place, length, spacing in zip((y, x), self.map_length, self.grid.spacing, strict=True):
                own &= (place < length) | (place >= 2 * length - spacing)
        return own

    def map_alone(self) -> Indenter:
        """The surface without its periodic images and mirror images: nothing surrounds it."""
        rows, columns = self.map_shape
        grid = Grid((rows, columns), self.map_length)
        return replace(self, height=self.height[:rows, :columns], grid=grid, boundary="free", edge_step=0.0)

    def on_map(self, y: float, x: float) -> tuple[float, float]:
        """Place on the map of a place in the cell, which may lie in a mirror image of the map.

        Mirror images repeat the outermost row and column: the mirror stands half a spacing beyond the last
        node.
        """
        (length_y, length_x), (spacing_y, spacing_x) = self.map_length, self.grid.spacing
        return _folded(y, length_y, spacing_y), _folded(x, length_x, spacing_x)


def _folded(position: float, length: float, spacing: float) -> float:
    if position < length - spacing / 2:
        return position
    # Between the mirror and the first node the map has no node of its own.
    return max(2 * length - spacing - position, 0.0)


def read_indenter(
    source: str | os.PathLike[str] | HeightMap, settings: MapSettings, counter: CounterMap | None = None
) -> Indenter:
    """Read a map and prepare it, with the map of the counter body if that is rough too.

    Parameters
    ----------
    source : path or HeightMap
        A height map is in metres.
    settings : MapSettings
    counter : CounterMap, optional

    Raises
    ------
    MapError, TypeError, ValueError
        If a map cannot be read, has no unit, or needs a setting that is not given, or if the two do not go
        together.
    """
    name, surface = _read(source, settings)
    if counter is None:
        treated = treat_map(surface, settings.treatment(surface), settings.option)
        record = treated.treatment
        return _indenter(name, treated, settings, record.filled_fraction, record.lines())
    own = counter.settings or settings
    counter_name, counter_surface = _read(counter.source, own)
    map_face, map_filled, map_done = _levelled(surface, settings)
    counter_face, counter_filled, counter_done = _levelled(counter_surface, own)
    pair = face_to_face(map_face, counter_face, counter.turned_about, counter.shift)
    treatment = replace(settings.treatment(pair.map), despike=None)
    treated = treat_map(pair.map, treatment, settings.option)
    levelled = () if pair.whole else ("levelled",)
    done = [
        *(f"map: {line}" for line in map_done),
        *(f"counter map: {line}" for line in counter_done),
        *pair.lines(),
        *(line for line in treated.treatment.lines()[1:] if not line.startswith("levelled") or levelled),
    ]
    return _indenter(f"{name} on {counter_name}", treated, settings, map_filled + counter_filled, done)


def _read(source: str | os.PathLike[str] | HeightMap, settings: MapSettings) -> tuple[str, HeightMap]:
    """Name and heights of a map that has all that its treatment needs."""
    if isinstance(source, HeightMap):
        found = Inspected(replace(source, unit=source.unit or "m"), [], [])
        name, path = source.name or "map", source.name
    else:
        found = inspect_map(source, settings.reading, settings.option)
        name, path = os.path.splitext(os.path.basename(os.fspath(source)))[0], os.fspath(source)
    if problems := missing_settings(found, settings.treatment(found.map), settings.option):
        raise MapError(path, problems)
    return name, found.map


def _levelled(surface: HeightMap, settings: MapSettings) -> tuple[HeightMap, float, list[str]]:
    """A map without spikes, missing points and trend; the share that was filled, and what was done."""
    treatment = replace(settings.treatment(surface), periodic="none", wavelength_short=None, points=None)
    treated = treat_map(surface, treatment, settings.option)
    height = -treated.height if surface.orientation == PEAKS_UP else treated.height
    done = [line for line in treated.treatment.lines()[1:] if not line.startswith("not made periodic")]
    return replace(surface, height=height), treated.treatment.filled_fraction, done


def _indenter(
    name: str, treated: TreatedMap, settings: MapSettings, filled_share: float, done: list[str]
) -> Indenter:
    record, grid = treated.treatment, treated.grid
    factor = 2 if record.periodic == "mirrored" else 1
    indenter = Indenter(
        name=name,
        height=treated.height,
        grid=grid,
        map_length=(grid.length[0] / factor, grid.length[1] / factor),
        wavelength_short=treated.wavelength_short,
        boundary=settings.boundary,
        altered_share=record.altered_fraction,
        edge_step=0.0 if settings.boundary == "free" else record.edge_step,
        filled_share=filled_share,
        done=tuple(done),
    )
    return indenter if settings.radius is None else _with_form(indenter, settings, settings.radius)


def _with_form(indenter: Indenter, settings: MapSettings, radius: float) -> Indenter:
    """The surface with the form of a sphere or cylinder, on every mirror image of the map."""
    if indenter.is_mirrored and any(nodes % 2 for nodes in indenter.grid.shape):
        raise ValueError(
            f"radius = {radius:g}: even numbers of points are needed on a mirrored map, "
            f"not {indenter.grid.shape}"
        )
    part = Grid(indenter.map_shape, indenter.map_length)
    flat = np.zeros(part.shape)
    if settings.form == "sphere":
        form, word = add_sphere(flat, part, radius), "a sphere"
    else:
        form = add_cylinder(flat, part, radius, axis=settings.cylinder_axis)
        word = f"a cylinder along {settings.cylinder_axis}"
    line = f"form of {word} of radius {shown_si(radius, 'm')} added"
    if indenter.is_mirrored:
        form = mirror_images(form)
    return replace(indenter, height=indenter.height + form, done=(*indenter.done, line))
