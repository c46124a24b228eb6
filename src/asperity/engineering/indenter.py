"""The rough surface of a case in metres, made from a measured map, and what was done to the map."""

from __future__ import annotations

import os
import warnings
from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np

from asperity.spectral import Grid
from asperity.surface.measured import TAPER, HeightMap, edge_step, make_periodic, read_map
from asperity.types import Array
from asperity.units import shown_si, to_si

DEFAULT_PERIODICITY = "mirrored"
"""How a map that does not call itself periodic becomes periodic: no height is altered."""


@dataclass(frozen=True)
class MapSettings:
    """What is known of a map beside its file, and how it is prepared.

    Parameters
    ----------
    unit : str, optional
        Unit of all lengths in the file, such as ``"um"``, for files that do not say it.
    physical_size : (length_y, length_x), optional
        Edges in m, for files that do not say them.
    detrend : "none", "tilt" or "curvature"
    periodic : "declared", "mirrored" or "windowed", optional
        As of `make_periodic`; by default a map that does not call itself periodic is mirrored.
    undefined : "harmonic", optional
        How points without data are filled; None refuses them.
    wavelength_short : float, optional
        Waves shorter than this, in m, are removed.
    points : int, optional
        Nodes on the longer edge of the cell.
    option : callable
        Gives the name of a setting in the interface of the user, for messages.
    """

    unit: str | None = None
    physical_size: tuple[float, float] | None = None
    detrend: str = "tilt"
    periodic: str | None = None
    undefined: str | None = "harmonic"
    wavelength_short: float | None = None
    points: int | None = None
    option: Callable[[str], str] = field(default=str, repr=False, compare=False)


@dataclass(frozen=True)
class Indenter:
    """One period of a rough surface, as the lower face of an indenter.

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
    altered_share : float
        Share of the area in which a window lowered the heights.
    edge_step : float
        Rms step of the heights across the edges of the cell over that between neighbouring nodes.
    filled_share : float
        Share of the points of the map that had no data.
    done : tuple of str
        What was done to the map, in words.
    """

    name: str
    height: Array
    grid: Grid
    map_length: tuple[float, float]
    wavelength_short: float
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
        A height map in m has its peaks upward.
    settings : MapSettings

    Raises
    ------
    ValueError
        If the map cannot be read, has no unit, or needs a setting that is not given.
    """
    if isinstance(source, HeightMap):
        return prepared(source, settings, "map")
    unit, given = _metres(source, settings)
    size = None if settings.physical_size is None else tuple(edge / unit for edge in settings.physical_size)
    found = read_map(source, physical_size=size)  # type: ignore[arg-type]
    surface = HeightMap(found.height * unit, (found.length[0] * unit, found.length[1] * unit), found.periodic)
    indenter = prepared(surface, settings, os.path.splitext(os.path.basename(os.fspath(source)))[0])
    return replace(indenter, done=(f"lengths in the file are in {given}", *indenter.done))


def prepared(surface: HeightMap, settings: MapSettings, name: str) -> Indenter:
    """The indenter made from a map in metres."""
    periodic = settings.periodic or (None if surface.periodic else DEFAULT_PERIODICITY)
    factor = 2 if periodic == "mirrored" else 1
    edge = factor * max(surface.length)
    kept = make_periodic(
        surface,
        settings.detrend,
        periodic,
        settings.undefined,
        None if settings.wavelength_short is None else settings.wavelength_short / edge,
        settings.points,
    )
    grid = Grid(kept.grid.shape, (kept.grid.length[0] * edge, kept.grid.length[1] * edge))
    missing = int(np.count_nonzero(~np.isfinite(surface.height)))
    altered = 1 - (1 - 2 * TAPER) ** 2 if periodic == "windowed" else 0.0
    return Indenter(
        name=name,
        height=kept.height * edge,
        grid=grid,
        map_length=(grid.length[0] / factor, grid.length[1] / factor),
        wavelength_short=kept.wavelength_short * edge,
        altered_share=altered,
        edge_step=edge_step(kept.height),
        filled_share=missing / surface.height.size,
        done=tuple(_done(surface, settings, periodic, missing, altered)),
    )


def _done(
    surface: HeightMap, settings: MapSettings, periodic: str | None, missing: int, altered: float
) -> list[str]:
    """What was done to a map, one sentence a step."""
    ny, nx = surface.height.shape
    length_y, length_x = (shown_si(edge, "m") for edge in surface.length)
    done = [f"{nx} x {ny} points over {length_x} x {length_y}, peaks upward; pressed face down"]
    if missing:
        share = 100 * missing / surface.height.size
        done.append(f"{missing} points without data ({share:.2g} %) filled by a harmonic function")
    done.append(
        {
            "none": "mean height subtracted, no trend",
            "tilt": "mean plane subtracted",
            "curvature": "polynomial of degree two subtracted",
        }[settings.detrend]
    )
    done.append(
        {
            "mirrored": "continued by its mirror images, so that it is periodic: no height is altered",
            "windowed": f"lowered to its mean plane near the edges, on {100 * altered:.0f} % of the area",
            "declared": "taken as one period, as asked",
            None: "taken as one period, as its file says",
        }[periodic]
    )
    if settings.wavelength_short is not None:
        done.append(f"waves shorter than {shown_si(settings.wavelength_short, 'm')} removed")
    if settings.points is not None:
        done.append(f"interpolated to {settings.points} nodes on the longer edge of the cell")
    return done


def _metres(path: str | os.PathLike[str], settings: MapSettings) -> tuple[float, str]:
    """Size of the file's unit of length in metres, and its name.

    Raises
    ------
    ValueError
        If neither the file nor the settings name a unit, or they contradict each other.
    """
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # of packages that SurfaceTopography can do without
        from SurfaceTopography.IO import open_topography

    name, unit = settings.option("unit"), None
    if os.path.isfile(path):
        try:
            with open_topography(os.fspath(path)) as reader:
                unit = reader.default_channel.unit
        except Exception:  # the reader of maps says what is wrong with the file
            return 1.0, "m"
    else:
        return 1.0, "m"
    said = None if unit in (None, "") else to_si(f"1 {unit}", "length", "unit")
    asked = None if settings.unit is None else to_si(f"1 {settings.unit}", "length", "unit")
    if said is not None and asked is not None and not np.isclose(said, asked, rtol=1e-12):
        raise ValueError(f"{name} = {settings.unit!r}: the file says that its unit is {unit}; leave it out")
    if said is None and asked is None:
        raise ValueError(f"{name}: the file does not say its unit of length; set it, such as um")
    return (said, unit) if said is not None else (asked, settings.unit)  # type: ignore[return-value]
