"""The rough surface of a case in metres, made from a measured map, and what was done to the map."""

from __future__ import annotations

import os
from collections.abc import Callable
from dataclasses import dataclass, field, replace

from asperity.arguments import choice
from asperity.spectral import Grid
from asperity.surface.form import add_sphere
from asperity.surface.height_map import HeightMap, MapError
from asperity.surface.measured import missing_settings
from asperity.surface.reading import Inspected, Reading, inspect_map
from asperity.surface.treatment import TreatedMap, Treatment, treat_map
from asperity.surface.unpacked_size import DEFAULT_LIMIT
from asperity.types import Array
from asperity.units import shown_si

BOUNDARIES = ("periodic", "free")
"""The surface repeats sideways, or nothing surrounds it."""

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
        Radius in m of a sphere whose form is added to the roughness, its lowest point in the middle.
    max_memory : float
        Largest size in GiB to which the file may unpack.
    option : callable
        Gives the name of a setting in the interface of the user, for messages.
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
    max_memory: float = DEFAULT_LIMIT
    option: Callable[[str], str] = field(default=str, repr=False, compare=False)

    def __post_init__(self) -> None:
        choice(self.option("boundary"), self.boundary, BOUNDARIES)
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

    def on_map(self, y: float, x: float) -> tuple[float, float]:
        """Place on the map of a place in the cell, which may lie in a mirror image of the map.

        Mirror images repeat the outermost row and column: the mirror stands half a spacing beyond the last
        node.
        """
        (length_y, length_x), (spacing_y, spacing_x) = self.map_length, self.grid.spacing
        return _folded(y, length_y, spacing_y), _folded(x, length_x, spacing_x)


def _folded(position: float, length: float, spacing: float) -> float:
    return position if position < length - spacing / 2 else abs(2 * length - spacing - position)


def read_indenter(source: str | os.PathLike[str] | HeightMap, settings: MapSettings) -> Indenter:
    """Read a map and prepare it.

    Parameters
    ----------
    source : path or HeightMap
        A height map is in metres.
    settings : MapSettings

    Raises
    ------
    MapError
        If the map cannot be read, has no unit, or needs a setting that is not given.
    """
    if isinstance(source, HeightMap):
        found = Inspected(replace(source, unit=source.unit or "m"), [], [])
        name, path = source.name or "map", source.name
    else:
        found = inspect_map(source, settings.reading, settings.option)
        name, path = os.path.splitext(os.path.basename(os.fspath(source)))[0], os.fspath(source)
    treatment = settings.treatment(found.map)
    if problems := missing_settings(found, treatment, settings.option):
        raise MapError(path, problems)
    return _indenter(name, treat_map(found.map, treatment, settings.option), settings)


def _indenter(name: str, treated: TreatedMap, settings: MapSettings) -> Indenter:
    record, grid = treated.treatment, treated.grid
    factor = 2 if record.periodic == "mirrored" else 1
    free = settings.boundary == "free"
    done, height = record.lines(), treated.height
    if settings.radius is not None:
        height = add_sphere(height, grid, settings.radius)
        done.append(f"form of a sphere of radius {shown_si(settings.radius, 'm')} added")
    return Indenter(
        name=name,
        height=height,
        grid=grid,
        map_length=(grid.length[0] / factor, grid.length[1] / factor),
        wavelength_short=treated.wavelength_short,
        boundary=settings.boundary,
        altered_share=record.altered_fraction,
        edge_step=0.0 if free else record.edge_step,
        filled_share=record.filled_fraction,
        done=tuple(done),
    )
