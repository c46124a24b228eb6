"""From a file with a measured map to the lower face of an indenter.

`prepare_map` reads and treats in one go, in metres, and reports everything that is missing at once.
`make_periodic` is the same treatment in units of the longer edge of the periodic cell, as the study of the
paper uses it.
"""

from __future__ import annotations

import os

from asperity.surface.height_map import HeightMap, MapError, OptionName
from asperity.surface.reading import Inspected, Reading, inspect_map, unit_missing
from asperity.surface.treatment import (
    PERIODICITIES,
    WITHOUT_PERIOD,
    TreatedMap,
    Treatment,
    treat_map,
    treatment_problems,
)


def prepare_map(
    path: str | os.PathLike[str],
    reading: Reading | None = None,
    treatment: Treatment | None = None,
    option: OptionName = str,
) -> TreatedMap:
    """The lower face of an indenter, in metres, from a file with a measured map.

    Parameters
    ----------
    path : path
    reading : Reading, optional
        What the caller says about the file.
    treatment : Treatment, optional
    option : callable
        Gives the name of an argument in the interface of the user, for messages.

    Raises
    ------
    MapError
        If the file cannot be used; the message names everything that is wrong or missing, also that its unit
        is not known.

    Examples
    --------
    >>> import tempfile
    >>> from pathlib import Path
    >>> heights = asp.self_affine((40, 40), 0.8, 60e-6, 10e-6, rms_height=1e-7, seed=1, length=80e-6)
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     np.save(Path(folder) / "map.npy", heights * 1e9)
    ...     what = asp.Reading(physical_size=("80 um", "80 um"), unit="nm", orientation="peaks up")
    ...     made = asp.prepare_map(Path(folder) / "map.npy", what, asp.Treatment(periodic="windowed"))
    >>> made.height.shape, [round(edge, 9) for edge in made.grid.length]
    ((40, 40), [8e-05, 8e-05])
    """
    surface = checked_map(path, reading, treatment, option)
    return treat_map(surface, treatment, option)


def checked_map(
    path: str | os.PathLike[str],
    reading: Reading | None = None,
    treatment: Treatment | None = None,
    option: OptionName = str,
    for_cell: bool = False,
) -> HeightMap:
    """A map that was read and has all that its treatment needs; nothing is computed.

    Parameters are those of `prepare_map`. With `for_cell` the map is meant for `make_periodic`: it may be of
    unknown unit, and has to become periodic.

    Raises
    ------
    MapError
        As for `prepare_map`.
    """
    found = inspect_map(path, reading, option)
    if problems := missing_settings(found, treatment or Treatment(), option, for_cell):
        raise MapError(os.fspath(path), problems)
    return found.map


def missing_settings(
    found: Inspected, treatment: Treatment, option: OptionName = str, for_cell: bool = False
) -> list[str]:
    """Everything that a file lacks or contradicts for a treatment; parameters as for `checked_map`."""
    problems = list(found.problems)
    unit = option("unit")
    if not for_cell and found.map.unit is None and not any(p.startswith(unit) for p in problems):
        problems.append(unit_missing(unit))
    periodicities = PERIODICITIES if for_cell else WITHOUT_PERIOD
    try:
        needed = treatment_problems(found.map, treatment, option, periodicities)
    except MapError as error:
        needed = [] if problems else list(error.problems)
    return problems + [problem for problem in needed if problem not in problems]


def make_periodic(
    surface: HeightMap,
    detrend: str,
    periodic: str | None = None,
    undefined: str | None = None,
    wavelength_short: float | None = None,
    points: int | None = None,
    despike: float | None = None,
    option: OptionName = str,
) -> TreatedMap:
    """The periodic lower face of an indenter, in units of the longer edge of its cell.

    Parameters
    ----------
    surface : HeightMap
    detrend, periodic, undefined, points, despike
        As in `asperity.surface.treatment.Treatment`, but for ``periodic="none"``.
    wavelength_short : float, optional
        Waves shorter than this are removed; in units of the longer edge of the cell, which has twice the
        edges of the map if it is mirrored.
    option : callable
        Gives the name of an argument in the interface of the user, for messages.

    Returns
    -------
    TreatedMap
        Its lengths, and those of its record, are in units of the longer edge of the cell.

    Raises
    ------
    MapError
        As for `asperity.surface.treatment.treat_map`.

    Examples
    --------
    >>> edges = 80e-6, 120e-6
    >>> heights = asp.self_affine((40, 60), 0.8, 60e-6, 10e-6, rms_height=1e-7, seed=1, length=edges)
    >>> surface = asp.HeightMap(heights, edges)
    >>> made = asp.make_periodic(surface, detrend="tilt", periodic="mirrored")
    >>> made.height.shape, made.grid.length  # four mirror images; the longer edge is 1
    ((80, 120), (0.6666666666666667, 1.0))
    """
    treatment = Treatment(detrend, periodic, undefined, despike, wavelength_short, points)
    surface.check()
    return treat_map(surface.scaled(1 / cell_edge(surface, periodic)), treatment, option, PERIODICITIES)


def cell_edge(surface: HeightMap, periodic: str | None) -> float:
    """Longer edge of the periodic cell that a map becomes."""
    return max(surface.length) * (2 if periodic == "mirrored" else 1)
