"""Outcome and work of contacts of every family of surfaces with every level of every setting.

The other settings of each contact are drawn, so that the settings meet in all combinations. A contact is
solved and confirmed by `solution_check`, or refused with a message that names an argument; anything else is
a defect.
"""

import math

import numpy as np
import xarray as xr
from extremes import CERTIFIED, CHECKED, FAILED, OUTCOMES, REFUSED, Attempt, label, solve_and_check
from families import FAMILIES, FamilyCase, drawn, family_arguments, family_levels

SOLVED = (CHECKED, CERTIFIED)
ACCEPTABLE = (*SOLVED, REFUSED)
"""Outcomes that are no defect."""

REFUSALS = ("area_fraction = ", "approach = ", "dtype = ")
"""Beginnings of the messages that refuse problems without a solution: full contact beyond the hardness, an
approach to the mean height on a solid without uniform displacement, and heights that single precision
cannot hold."""

REPEATED = 4.0
"""A contact that takes more than this multiple of the median of its grid is timed twice, and the shorter
time counts."""


def family_outcomes(every: int = 1) -> xr.Dataset:
    """Contacts of every family with every level, or with one in so many.

    Returns
    -------
    Dataset
        Over (family, level): ``outcome`` and ``reason`` as in `extremes.Attempt`, the number of ``nodes``,
        ``microseconds`` of processor time per node, and ``multiple``, that time over the median of all
        solved contacts on the same grid.
    """
    solve_and_check(lambda: family_arguments(FamilyCase("rough")))  # compiles
    columns = range(every // 2, len(list(family_levels())), every)
    levels = [list(family_levels())[column] for column in columns]
    cases = [[family_case(family, column) for column in columns] for family in FAMILIES]
    attempts = [[attempt_family(case) for case in row] for row in cases]
    outcome, seconds = (
        np.array([[getattr(found, name) for found in row] for row in attempts])
        for name in ("outcome", "seconds")
    )
    shape = np.array([[label(case.shape) for case in row] for row in cases])
    solid = np.array([[case.solid for case in row] for row in cases])
    nodes = np.array([[math.prod(case.shape) for case in row] for row in cases])
    multiple = over_median(seconds / nodes, shape)
    for row, column in np.argwhere(multiple > REPEATED):
        again = attempt_family(cases[row][column]).seconds
        seconds[row, column] = min(seconds[row, column], again)
    both = ("family", "level")
    meanings = " ".join(name.replace(" ", "_") for name in OUTCOMES)
    flags = {"flag_values": np.arange(len(OUTCOMES), dtype=np.int8), "flag_meanings": meanings}
    return xr.Dataset(
        {
            "outcome": (both, outcome.astype(np.int8), flags),
            "reason": (both, np.array([[found.reason for found in row] for row in attempts], object)),
            "case": (both, np.array([[repr(case) for case in row] for row in cases], object)),
            "shape": (both, shape),
            "solid": (both, solid),
            "nodes": (both, nodes),
            "microseconds": (both, 1e6 * seconds / nodes),
            "multiple": (both, over_median(seconds / nodes, shape)),
            "level_axis": ("level", [name for name, _ in levels]),
            "level_value": ("level", [label(value) for _, value in levels]),
        },
        coords={"family": list(FAMILIES)},
    )


def family_case(family: str, column: int) -> FamilyCase:
    """The contact of a family with a level, by its number in `family_levels`."""
    name, value = list(family_levels())[column]
    return drawn(np.random.default_rng([list(FAMILIES).index(family), column]), family, **{name: value})


def attempt_family(case: FamilyCase) -> Attempt:
    """Outcome of a contact of a family; only a contact without a solution may be refused."""
    found = solve_and_check(lambda: family_arguments(case))
    is_wrong_refusal = found.outcome == REFUSED and not found.reason.startswith(REFUSALS)
    return found._replace(outcome=FAILED) if is_wrong_refusal else found


def over_median(values: np.ndarray, shape: np.ndarray) -> np.ndarray:
    """Values over the median of all those of the same shape that are numbers."""
    out = np.full(values.shape, np.nan)
    for one in np.unique(shape):
        same = (shape == one) & np.isfinite(values)
        out[same] = values[same] / np.median(values[same])
    return out
