"""Contacts at the ends of every range, and of every two at once: solved, refused by name, or wrong.

A *scene* is a small rough contact with twelve settings, each an axis with a few levels from one end of what
is accepted to the other. Every level is tried alone and with every level of every other axis. Floating-point
overflow, division by zero and invalid operations raise, and warnings are errors. A solution counts only if

* its certificate, recomputed in double precision from the pressure, holds to `ALLOWED` times the tolerance
  or to what an error of the pressure of that size may do to the gap, and
* its pressure is not farther than that from the solution, relative to its norm: that of
  `asperity.reference.pivoting` with up to `DIRECT_NODES` nodes in contact, else by a bound in the norm of
  the elastic energy. The compliance of some nodes has a smaller inverse than the same part of the inverse
  of the whole compliance, so that what the gap misses, met by the whole layer's stiffness, bounds the energy
  of the error.
"""

from __future__ import annotations

import math
import warnings
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import cache
from itertools import combinations
from typing import Any, NamedTuple

import numpy as np
import xarray as xr

from asperity.contact import Contact, solve, verify_contact
from asperity.elasticity.layer import Layer
from asperity.errors import ConvergenceError
from asperity.reference.pivoting import PivotingError, pivot
from asperity.surface.roughness import johnson, roughness_parameters, self_affine
from asperity.types import Array

Progress = Callable[[float, float], None]

TOLERANCES = {"float64": 1e-6, "float32": 1e-4}
"""Asked of the solver."""

ALLOWED = 10.0
"""Violation of the conditions and error of the pressure that pass, in units of the tolerance."""

DIRECT_NODES = 700
"""Nodes in contact up to which a solution is held against the direct one."""

OUTCOMES = (
    "no cell",
    "certified and checked",
    "certified",
    "not converged",
    "refused",
    "wrong",
    "warned",
    "failed",
)
NO_CELL, CHECKED, CERTIFIED, NOT_CONVERGED, REFUSED, WRONG, WARNED, FAILED = range(len(OUTCOMES))
ACCEPTABLE = (NO_CELL, CHECKED, CERTIFIED, NOT_CONVERGED, REFUSED)
"""A certified solution or a named error; the others are defects."""

Imposed = tuple[str, float]


@dataclass(frozen=True)
class Scene:
    """Settings of a contact; the defaults are the scene that one or two levels change.

    Attributes
    ----------
    poisson : float
    scaled_height : float
        2π height / L, the smallest q height of the cell; infinite for the half-space.
    bottom : str
    imposed : tuple
        ``("load", part)`` of the mean pressure that closes the last gap, ``("area", fraction)``, or
        ``("approach", part)`` of the way from the lowest to the mean height.
    rms_gradient, hurst, wavelength_long : float
    nodes_short : float
        Shortest wavelength in grid spacings.
    johnson : tuple, optional
        γ and δ of Eq. 23.
    precision : str
    points : int
        Nodes on an edge.
    method : str
    """

    poisson: float = 0.33
    scaled_height: float = math.inf
    bottom: str = "bonded"
    imposed: Imposed = ("load", 0.03)
    rms_gradient: float = 0.1
    hurst: float = 0.8
    wavelength_long: float = 0.5
    nodes_short: float = 4.0
    johnson: tuple[float, float] | None = None
    precision: str = "float64"
    points: int = 24
    method: str = "active_set"


LEVELS: dict[str, tuple[Any, ...]] = {
    "poisson": (-0.95, 0.0, 0.33, 0.4999, 0.5),
    "scaled_height": (1e-6, 1e-3, 0.1, 1.0, 10.0, 1e5, math.inf),
    "bottom": ("bonded", "frictionless", "free"),
    "imposed": (
        ("load", 0.0),
        ("load", 1e-100),
        ("load", 1e-9),
        ("load", 1e-3),
        ("load", 0.03),
        ("load", 0.5),
        ("load", 1.0),
        ("load", 1e3),
        ("area", 1e-9),
        ("area", 0.1),
        ("area", 1.0),
        ("approach", -0.5),
        ("approach", 0.5),
        ("approach", 0.999),
    ),
    "rms_gradient": (1e-6, 1e-3, 0.1, 10.0),
    "hurst": (0.0, 0.8, 1.0),
    "wavelength_long": (1.0, 0.5, 1 / 6),
    "nodes_short": (2.0, 2.5, 4.0, 8.0),
    "johnson": (None, (1.25, 100.0), (1.25, 1.0), (-1.25, 1.0), (1.25, 0.1), (1.25, 0.01)),
    "precision": ("float64", "float32"),
    "points": (24, 25, 64, 128, 512),
    "method": ("active_set", "gfmd"),
}
"""Levels of each axis, the default among them."""

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
"""Values just outside, each to be refused by name."""


class Result(NamedTuple):
    """What became of a scene: violation and error of the pressure in units of the tolerance."""

    outcome: int
    violation: float = math.nan
    error: float = math.nan
    reason: str = ""


_RECORD = np.dtype([("outcome", np.int8), ("violation", float), ("error", float), ("reason", object)])


def compute(levels: str = "all", largest: int = 512, progress: Progress | None = None) -> xr.Dataset:
    """Stability matrix: the outcome of every level alone and of every two of different axes.

    Parameters
    ----------
    levels : "all" | "ends"
        All levels, or of each axis the default, the first and the last.
    largest : int
        Nodes on an edge of the largest grid; larger levels are left out.
    progress : callable, optional
        Called as progress(done, total).

    Returns
    -------
    Dataset
        ``outcome``, ``scaled_violation`` and ``scaled_pressure_error`` over (level, other_level), symmetric,
        a level alone on the diagonal; ``reason`` where there is no solution, or none but a certified one
        that was not checked; outcome and reason also over ``beyond``, of values out of range.
    """
    chosen = list(chosen_levels(levels, largest))
    cells = [(n, n) for n in range(len(chosen))]
    cells += [(i, j) for i, j in combinations(range(len(chosen)), 2) if chosen[i][0] != chosen[j][0]]
    beyond = [(name, value) for name, values in BEYOND.items() for value in values]
    scenes = [replace(Scene(), **dict([chosen[i], chosen[j]])) for i, j in cells]
    scenes += [replace(Scene(), **{name: value}) for name, value in beyond]
    results: list[Result] = []
    for scene in scenes:
        results.append(attempt(scene))
        if progress is not None:
            progress(len(results), len(scenes))
    matrix = np.full((len(chosen), len(chosen)), np.array(tuple(Result(NO_CELL)), _RECORD))
    for (i, j), result in zip(cells, results, strict=False):
        matrix[i, j] = matrix[j, i] = tuple(result)
    return _dataset(matrix, chosen, results[len(cells) :], beyond)


def _dataset(
    matrix: Array,
    chosen: list[tuple[str, Any]],
    outside: list[Result],
    beyond: list[tuple[str, Any]],
) -> xr.Dataset:
    both, out = ("level", "other_level"), "beyond"
    flags = {
        "flag_values": np.arange(len(OUTCOMES), dtype=np.int8),
        "flag_meanings": " ".join(name.replace(" ", "_") for name in OUTCOMES),
    }
    default = [getattr(Scene(), axis) == value for axis, value in chosen]
    return xr.Dataset(
        {
            "outcome": (both, matrix["outcome"], flags),
            "scaled_violation": (both, matrix["violation"]),
            "scaled_pressure_error": (both, matrix["error"]),
            "reason": (both, matrix["reason"]),
            "level_axis": ("level", [axis for axis, _ in chosen]),
            "level_value": ("level", [label(value) for _, value in chosen]),
            "level_default": ("level", np.array(default, np.int8)),
            "beyond_axis": (out, [axis for axis, _ in beyond]),
            "beyond_value": (out, [label(value) for _, value in beyond]),
            "beyond_outcome": (out, np.array([result.outcome for result in outside], np.int8), flags),
            "beyond_reason": (out, np.array([result.reason for result in outside], object)),
        },
        attrs={
            "allowed": ALLOWED,
            "tolerance_float64": TOLERANCES["float64"],
            "tolerance_float32": TOLERANCES["float32"],
            "direct_nodes": DIRECT_NODES,
        },
    )


def chosen_levels(levels: str, largest: int) -> Iterator[tuple[str, Any]]:
    """Axis and value of every level."""
    if levels not in ("all", "ends"):
        raise ValueError(f"levels = {levels!r}: all or ends is needed")
    for name, values in LEVELS.items():
        held = [v for v in values if name != "points" or v <= largest]
        ends = (held[0], held[-1], getattr(Scene(), name))
        for value in held:
            if levels == "all" or value in ends:
                yield name, value


def label(value: Any) -> str:
    """A level as text."""
    if isinstance(value, tuple):
        return " ".join(map(label, value))
    if value is None:
        return "none"
    return value if isinstance(value, str) else f"{value:.4g}"


@cache
def attempt(scene: Scene) -> Result:
    """Solve a scene with floating-point errors raised, and judge the solution."""
    with np.errstate(over="raise", divide="raise", invalid="raise"), warnings.catch_warnings():
        warnings.simplefilter("error")
        try:
            unit = surface(scene)
            layer = Layer(1.0, scene.poisson, _height(scene), scene.bottom)
            imposed = control(scene, unit, layer)
            rtol = TOLERANCES.get(scene.precision, TOLERANCES["float64"])
            height = scene.rms_gradient * unit
            contact = solve(height, layer, **imposed, method=scene.method, dtype=scene.precision, rtol=rtol)
        except ConvergenceError as error:
            return Result(NOT_CONVERGED, reason=str(error))
        except (ValueError, TypeError) as error:
            return Result(REFUSED, reason=str(error))
        except (Warning, FloatingPointError) as error:
            return Result(WARNED, reason=_named(error))
        except Exception as error:  # whatever else is a defect to be shown
            return Result(FAILED, reason=_named(error))
        return judge(scene, contact, imposed)


def judge(scene: Scene, contact: Contact, imposed: dict[str, Any]) -> Result:
    """Whether a solution is one: by its certificate, and by the direct solution or a bound."""
    tolerance = TOLERANCES[scene.precision]
    given = {kind: amount for kind, amount in imposed.items() if kind != "area_fraction"}
    certificate = verify_contact(
        contact.height, contact.pressure, contact.layer, **({"approach": contact.approach} | given)
    )
    violation = certificate.worst / tolerance / max(1.0, _reach(contact))
    if not violation <= ALLOWED:
        return Result(WRONG, violation, reason=str(certificate))
    outcome, error, reason = CERTIFIED, energy_error(contact, **given) / tolerance, ""
    touching = contact.pressure > 0
    if np.count_nonzero(touching) <= DIRECT_NODES:
        known = given or {"mean_pressure": contact.mean_pressure}
        try:
            true = pivot(contact.height, contact.layer, guess=touching, **known)
        except PivotingError as failure:
            reason = str(failure)
        else:
            scale = float(true.max()) or 1.0
            size, difference = (float(np.linalg.norm(p / scale)) for p in (true, contact.pressure - true))
            outcome, error = CHECKED, difference / (size or 1.0) / tolerance
    if not error <= ALLOWED:
        outcome, reason = WRONG, f"pressure off by {error:.3g} times the tolerance"
    return Result(outcome, violation, error, reason)


def energy_error(
    contact: Contact, *, approach: float | None = None, mean_pressure: float | None = None
) -> float:
    """Bound of the error of a pressure in the norm of the elastic energy, relative to its own.

    A uniform pressure without energy counts as much as what varies does for its size.
    """
    compliance = _compliance(contact.layer, contact.grid.shape)
    if mean_pressure is not None:
        # What is uniform shifts the approach alone.
        compliance[0, 0] = 0
    stiffness = np.divide(1, compliance, out=np.zeros_like(compliance), where=compliance > 0)
    spectrum = np.fft.fft2(contact.pressure.astype(float))
    gap = contact.height + np.fft.ifft2(compliance * spectrum).real
    touching = contact.pressure > 0
    gap -= np.mean(gap[touching]) if approach is None and touching.any() else (approach or gap.min())
    missed = np.fft.fft2(np.where(touching, gap, np.minimum(gap, 0)))
    power, energy = np.abs(spectrum) ** 2, float(np.sum(stiffness * np.abs(missed) ** 2))
    own = float(np.sum(compliance * power))
    counted = float(np.sum(power[compliance > 0]) / np.sum(power)) if own else 0.0
    return math.sqrt(energy / own * counted) if own else 0.0


def surface(scene: Scene) -> Array:
    """The indenter of a scene, with an rms gradient of one."""
    shape = (scene.points, scene.points)
    short = scene.nodes_short / max(scene.points, 1)
    height = self_affine(shape, scene.hurst, scene.wavelength_long, short, rms_height=1.0, seed=1)
    if scene.johnson is not None:
        height = johnson(height, *scene.johnson)
    return height / roughness_parameters(height).rms_gradient


def control(scene: Scene, height: Array, layer: Layer) -> dict[str, Any]:
    """What is imposed, as `solve` takes it."""
    kind, amount = scene.imposed
    if kind == "area":
        return {"area_fraction": amount}
    if kind == "approach":
        lowest = float(height.min())
        return {"approach": scene.rms_gradient * (lowest + amount * (float(height.mean()) - lowest))}
    return {"mean_pressure": scene.rms_gradient * amount * closing_pressure(height, layer)}


def closing_pressure(height: Array, layer: Layer) -> float:
    """Mean pressure at which the last gap closes: the tension that would hold the surface to the indenter."""
    compliance = _compliance(layer, height.shape)
    compliance[0, 0] = np.inf
    return float(np.fft.ifft2(np.fft.fft2(height) / compliance).real.max())


def _reach(contact: Contact) -> float:
    """How far the largest error that the tolerance allows the pressure may move the surface.

    In units of the tolerance and of the rms height; far beyond full contact that is much.
    """
    compliance = _compliance(contact.layer, contact.grid.shape)
    compliance[0, 0] = 0
    norm = float(np.sqrt(np.mean(np.square(contact.pressure, dtype=float))))
    return norm * float(compliance.max()) / float(np.std(contact.height, dtype=float))


def _compliance(layer: Layer, shape: tuple[int, ...]) -> Array:
    """Compliance of every mode of a square unit cell, (ny, nx)."""
    qy, qx = (2 * np.pi * np.fft.fftfreq(n, 1 / n) for n in shape)
    return layer.surface_compliance(np.hypot(qy[:, None], qx[None, :]))


def _height(scene: Scene) -> float | None:
    return None if math.isinf(scene.scaled_height) else scene.scaled_height / (2 * math.pi)


def _named(error: BaseException) -> str:
    return f"{type(error).__name__}: {' '.join(str(error).split())}"
