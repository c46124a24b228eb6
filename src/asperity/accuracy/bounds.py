"""Error bounds of the outputs by source, from the stored measurement.

For each parameter of accuracy the bound is the largest error measured in any scene, at the next coarser
setting measured, times a margin, and raised by the error of the reference itself. The bounds of the
parameters are added. For the mean over surfaces of one kind, a 95 % confidence interval from the spread of
the seeds is added.
"""

from __future__ import annotations

import math
from collections.abc import Mapping

from asperity.accuracy.evaluation import Scene, solid_record
from asperity.accuracy.measured import ErrorsBySetting, MeasuredTradeoff, at_area, load
from asperity.accuracy.measurement import CONVERGED
from asperity.accuracy.outputs import OUTPUTS
from asperity.config.presets import AccuracySettings

SOURCES = ("discretisation", "depths", "contact", "half_space", "seeds")
"""Sources of error: grid, planes in depth, contact solve, half-space for the layer, sample of surfaces."""

SAFETY_FACTOR = 1.5
"""Bound over the largest error that was measured."""

GRID_ORDER = 0.8
"""Order of convergence with the grid (0.6 to 0.9 in docs/stress.md), from which the error of the finest grid
follows."""

STUDENT_95 = 2.36
"""Half-width of a 95 % confidence interval over the standard deviation: Student's t for the 8 seeds that were
measured."""


def error_bounds(
    scene: Scene,
    accuracy: AccuracySettings,
    one_surface: bool = False,
    measured: MeasuredTradeoff | None = None,
) -> dict[str, dict[str, float]]:
    """Bounds of the relative errors: output → source → bound, infinite where nothing was measured.

    Parameters
    ----------
    scene : Scene
    accuracy : AccuracySettings
    one_surface : bool
        Errors of the surface of this seed; otherwise of the mean over all surfaces of its kind.
    measured : MeasuredTradeoff, optional
        By default that of the package.
    """
    measured = measured or load()
    errors = at_area(measured.errors, scene.area_fraction)
    deviation = at_area(measured.deviation, scene.area_fraction)
    if errors is None or deviation is None:
        return {name: dict.fromkeys(SOURCES, math.inf) for name in OUTPUTS}
    largest_wavelength = measured.ranges["wavelength_long"][1]
    interval = STUDENT_95 * scene.wavelength_long / largest_wavelength / math.sqrt(accuracy.seeds)
    finest = measured.ranges["points_per_wavelength"][1]
    parts = {
        "discretisation": [_discretisation(accuracy.points_per_wavelength, finest, errors)],
        "depths": [
            _depth_spacing(accuracy, errors),
            _next_coarser("depth_tolerance", accuracy.depth_tolerance, errors),
        ],
        "contact": [_next_coarser("contact_tolerance", accuracy.contact_tolerance, errors)],
        "half_space": [_half_space(scene, accuracy, errors)],
    }
    if accuracy.precision == "float32":
        parts["contact"].append(errors["precision"]["float32"])
    bounds = {}
    for name in OUTPUTS:
        bounds[name] = {
            source: SAFETY_FACTOR * sum(part[name] for part in several) for source, several in parts.items()
        }
        bounds[name]["seeds"] = 0.0 if one_surface else interval * deviation[name]
    return bounds


def measured_errors(
    accuracy: AccuracySettings, area_fraction: float, measured: MeasuredTradeoff
) -> dict[str, dict[str, float]]:
    """Largest errors measured at settings that were measured, without factors: output → source → error.

    The error of the source ``seeds`` is the standard deviation of one surface from the mean of its kind.

    Raises
    ------
    ValueError
        If nothing was measured at this or a smaller area fraction.
    """
    errors, deviation = at_area(measured.errors, area_fraction), at_area(measured.deviation, area_fraction)
    if errors is None or deviation is None:
        raise ValueError(f"area_fraction = {area_fraction:g}: not measured")
    half_space = errors["half_space_tolerance"]
    highest_layer = half_space[min(half_space, key=float)]

    def at(parameter: str, output: str) -> float:
        value = getattr(accuracy, parameter)
        return next(found[output] for setting, found in errors[parameter].items() if float(setting) == value)

    return {
        name: {
            "discretisation": at("points_per_wavelength", name),
            "depths": at("depth_spacing", name) + at("depth_tolerance", name),
            "contact": at("contact_tolerance", name),
            "half_space": highest_layer[name],
            "seeds": deviation[name],
        }
        for name in OUTPUTS
    }


def _scaled(errors: Mapping[str, float], factor: float) -> dict[str, float]:
    return {name: factor * value for name, value in errors.items()}


def _next_coarser(parameter: str, value: float, errors: ErrorsBySetting) -> Mapping[str, float]:
    """Errors at the next coarser setting that was measured; infinite if there is none."""
    if value == 0:
        return dict.fromkeys(OUTPUTS, 0.0)
    coarser = [setting for setting in errors[parameter] if float(setting) >= value * (1 - 1e-9)]
    return errors[parameter][min(coarser, key=float)] if coarser else dict.fromkeys(OUTPUTS, math.inf)


def _discretisation(points: float, finest: float, errors: ErrorsBySetting) -> Mapping[str, float]:
    """Errors on the next coarser grid that was measured, raised by the error of the finest grid."""
    grids = errors["points_per_wavelength"]
    coarser = [setting for setting in grids if float(setting) <= points * (1 + 1e-9)]
    if not coarser:
        return dict.fromkeys(OUTPUTS, math.inf)
    chosen = max(coarser, key=float)
    return _scaled(grids[chosen], 1 / (1 - (float(chosen) / finest) ** GRID_ORDER))


def _depth_spacing(accuracy: AccuracySettings, errors: ErrorsBySetting) -> Mapping[str, float]:
    """Errors of the distance between planes over the shortest wavelength, raised by that of the reference."""
    spacing = accuracy.depth_spacing * CONVERGED.points_per_wavelength / accuracy.points_per_wavelength
    finest = min(errors["depth_spacing"], key=float)
    within = max(spacing, float(finest))
    return _scaled(
        _next_coarser("depth_spacing", within, errors),
        spacing / within / (1 - CONVERGED.depth_spacing / within),
    )


def _half_space(scene: Scene, accuracy: AccuracySettings, errors: ErrorsBySetting) -> Mapping[str, float]:
    """Errors of the half-space where it replaces the layer; zero where the layer is kept."""
    record = solid_record(scene, accuracy)
    if record["solid"] != "half-space":
        return dict.fromkeys(OUTPUTS, 0.0)
    return _next_coarser("half_space_tolerance", float(record["solid_bound"]), errors)
