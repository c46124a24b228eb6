"""Contacts at the ends of every range of settings, and at the ends of every two ranges at once.

A case is a small rough contact with twelve settings. Each setting has a few levels, from one end of the
accepted range to the other, and every level is tried alone and with every level of every other setting.
Floating-point overflow, division by zero and invalid operations raise, and warnings are errors. A case is
solved, refused with a message that names the setting, or ends with `ConvergenceError`; anything else is a
defect. A solution counts only if `solution_check` confirms it.
"""

import math
import warnings
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cache
from itertools import combinations_with_replacement
from typing import Any, NamedTuple

import numpy as np
import pandas as pd
from solution_check import check_solution, mode_compliance

from asperity.contact import solve_contact
from asperity.core.errors import ConvergenceError
from asperity.core.types import Array
from asperity.elasticity.solid import Solid
from asperity.elasticity.two_bodies import Solids
from asperity.fourier.grid import Grid
from asperity.surface.heights import johnson
from asperity.surface.roughness import roughness_parameters
from asperity.surface.self_affine import self_affine

Arguments = tuple[Array, Solids, dict[str, Any], dict[str, Any]]
"""Height, solid, the imposed quantity, and the other keywords of `asperity.solve_contact`."""

TOLERANCES = {"float64": 1e-6, "float32": 1e-4}
"""Tolerance of the solver in each precision."""

CHECKED, CERTIFIED = "certified and checked", "certified"
NOT_CONVERGED, REFUSED = "not converged", "refused"
WRONG, WARNED, FAILED = "wrong", "warned", "failed"
ACCEPTABLE = (CHECKED, CERTIFIED, NOT_CONVERGED, REFUSED)
"""Certified solutions and named errors; all other outcomes are defects."""

OUTCOMES = (*ACCEPTABLE, WRONG, WARNED, FAILED)

NAMING = (" = ", "height:")
"""A message that names an argument contains one of them."""


@dataclass(frozen=True)
class ExtremeCase:
    """Settings of a rough contact. The defaults are the base case, of which one or two settings are changed.

    `scaled_height` is 2π height / L, infinite for the half-space. `imposed` is ``("load", part)`` of the mean
    pressure that closes the last gap, ``("area", fraction)`` of the nodes, or ``("approach", part)`` of the
    way from the lowest to the mean height. Wavelengths are over the edge of the cell and over the grid
    spacing. `johnson` has γ and δ of Eq. 23, None for Gaussian heights. `points` are those on an edge.
    """

    poisson: float = 0.33
    scaled_height: float = math.inf
    bottom: str = "bonded"
    imposed: tuple[str, float] = ("load", 0.03)
    rms_gradient: float = 0.1
    hurst: float = 0.8
    wavelength_long: float = 0.5
    nodes_short: float = 4.0
    johnson: tuple[float, float] | None = None
    precision: str = "float64"
    points: int = 24
    method: str = "active_set"


EXTREME_LEVELS: dict[str, tuple[Any, ...]] = {
    "poisson": (-0.95, 0.33, 0.4999, 0.5),
    "scaled_height": (1e-6, 0.1, 1.0, 1e5, math.inf),
    "bottom": ("bonded", "frictionless", "free"),
    "imposed": (
        *(("load", part) for part in (0.0, 1e-100, 1e-9, 0.03, 1.0, 1e3)),
        *(("area", fraction) for fraction in (1e-9, 0.1, 1.0)),
        *(("approach", part) for part in (-0.5, 0.999)),
    ),
    "rms_gradient": (1e-6, 0.1, 10.0),
    "hurst": (0.0, 0.8, 1.0),
    "wavelength_long": (1.0, 0.5, 1 / 6),
    "nodes_short": (2.0, 4.0, 8.0),
    "johnson": (None, (-1.25, 1.0), (1.25, 1.0), (1.25, 0.01)),
    "precision": ("float64", "float32"),
    "points": (24, 25, 128),
    "method": ("active_set", "gfmd"),
}
"""Levels of each setting, the default among them."""

BEYOND: dict[str, tuple[Any, ...]] = {
    "poisson": (-1.0, 0.51, math.nan),
    "scaled_height": (0.0, -1.0),
    "bottom": ("glued",),
    "imposed": (("load", -1.0), ("load", math.inf), ("area", 0.0), ("area", 1.01), ("approach", 1.0)),
    "rms_gradient": (math.inf, math.nan),
    "hurst": (-0.01, 1.01),
    "wavelength_long": (0.0, math.inf),
    "nodes_short": (1.9, 0.0),
    "johnson": ((1.25, 0.0), (1e3, 0.01), (math.nan, 1.0)),
    "precision": ("float16",),
    "points": (0,),
    "method": ("magic",),
}
"""Values just out of range; each must be refused with a message that names the setting."""


class Attempt(NamedTuple):
    """Outcome of a case, one of `OUTCOMES`, with the numbers of `SolutionCheck` and the reason."""

    outcome: str
    violation: float = math.nan
    error: float = math.nan
    reason: str = ""


def outcomes(levels: str = "all") -> pd.DataFrame:
    """Settings, outcome and reason of contacts with every level of every setting, alone and in pairs.

    `levels` is ``"all"``, or ``"ends"``: of each setting the default, the first and the last.
    """
    pairs = combinations_with_replacement(list(chosen_levels(levels)), 2)
    cases = [dict(pair) for pair in pairs if pair[0] == pair[1] or pair[0][0] != pair[1][0]]
    return _attempted(cases)


def refusals() -> pd.DataFrame:
    """The same for all values just out of range."""
    return _attempted([{name: value} for name, values in BEYOND.items() for value in values])


def _attempted(cases: list[dict[str, Any]]) -> pd.DataFrame:
    found = [attempt(ExtremeCase(**case)) for case in cases]
    rows = [(str(case), one.outcome, one.reason) for case, one in zip(cases, found, strict=True)]
    return pd.DataFrame(rows, columns=["settings", "outcome", "reason"])


def chosen_levels(levels: str) -> Iterator[tuple[str, Any]]:
    """Setting and value of every level that is tried."""
    if levels not in ("all", "ends"):
        raise ValueError(f"levels = {levels!r}: all or ends is needed")
    for name, values in EXTREME_LEVELS.items():
        ends = (values[0], values[-1], getattr(ExtremeCase(), name))
        yield from ((name, value) for value in values if levels == "all" or value in ends)


@cache
def attempt(case: ExtremeCase) -> Attempt:
    """Outcome of a case."""
    return solve_and_check(lambda: extreme_arguments(case))


def solve_and_check(arguments: Callable[[], Arguments]) -> Attempt:
    """Outcome of making the arguments of a contact and solving it.

    Floating-point errors raise, and warnings are errors.
    """
    with np.errstate(over="raise", divide="raise", invalid="raise"), warnings.catch_warnings():
        warnings.simplefilter("error")
        try:
            height, solid, imposed, settings = arguments()
            contact = solve_contact(height, solid, **imposed, **settings)
        except ConvergenceError as error:
            return Attempt(NOT_CONVERGED, reason=str(error))
        except Exception as error:
            text = " ".join(str(error).split())
            if isinstance(error, ValueError | TypeError) and any(mark in text for mark in NAMING):
                return Attempt(REFUSED, reason=text)
            outcome = WARNED if isinstance(error, Warning | FloatingPointError) else FAILED
            return Attempt(outcome, reason=f"{type(error).__name__}: {text}")
        check = check_solution(contact, imposed, settings["rtol"], height)
    outcome = (CHECKED if check.direct else CERTIFIED) if check.holds else WRONG
    return Attempt(outcome, check.violation, check.error, check.reason)


def extreme_arguments(case: ExtremeCase) -> Arguments:
    """Height, solid, the imposed quantity, and the other keywords of `asperity.solve_contact`."""
    unit = unit_surface(case)
    tall = None if math.isinf(case.scaled_height) else case.scaled_height / (2 * math.pi)
    layer = Solid(1.0, case.poisson, tall, case.bottom)
    imposed = imposed_quantity(case, unit, layer)
    rtol = TOLERANCES.get(case.precision, TOLERANCES["float64"])
    return (
        *(case.rms_gradient * unit, layer, imposed),
        {"method": case.method, "dtype": case.precision, "rtol": rtol},
    )


def unit_surface(case: ExtremeCase) -> Array:
    """Height of the indenter of a case, scaled to an rms gradient of one, (points, points)."""
    shape = (case.points, case.points)
    short = case.nodes_short / max(case.points, 1)
    height = self_affine(shape, case.hurst, case.wavelength_long, short, rms_height=1.0, seed=1)
    if case.johnson is not None:
        height = johnson(height, *case.johnson)
    return height / roughness_parameters(height).rms_gradient


def imposed_quantity(case: ExtremeCase, unit_height: Array, layer: Solid) -> dict[str, Any]:
    """Imposed area fraction, approach or mean pressure, as a keyword of `asperity.solve_contact`."""
    kind, amount = case.imposed
    if kind == "area":
        return {"contact_area_fraction": amount}
    if kind == "approach":
        lowest = float(unit_height.min())
        return {"approach": case.rms_gradient * (lowest + amount * (float(unit_height.mean()) - lowest))}
    return {"mean_pressure": case.rms_gradient * amount * closing_pressure(unit_height, layer)}


def closing_pressure(height: Array, layer: Solid) -> float:
    """Mean pressure at which the last gap closes.

    It is the largest tension needed to hold the surface to the indenter everywhere at zero mean pressure.
    """
    grid = Grid(height.shape)
    compliance = mode_compliance(layer, grid)
    compliance[0, 0] = np.inf
    return float(np.fft.irfft2(np.fft.rfft2(height) / compliance, grid.shape).max())
