"""One calculation from surface to statistics: its outputs, its cost, and its errors against a reference.

Cost is processor time on one thread, which other work on the machine disturbs least; the time of a Fourier
transform at that moment is stored with it.
"""

from __future__ import annotations

import time
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
import xarray as xr

from asperity.accuracy.outputs import DISTRIBUTIONS, NUMBERS
from asperity.accuracy.resources import CALCULATION_STAGES, transform_seconds
from asperity.config.loads import imposed_load
from asperity.config.presets import AccuracySettings
from asperity.contact import solve
from asperity.errors import ConfigError
from asperity.pipeline.contact import solve_contact
from asperity.pipeline.solid import solid
from asperity.pipeline.statistics import LEVELS, seed_statistics
from asperity.pipeline.stress import compute_stress
from asperity.pipeline.surface import make_surface
from asperity.system import peak_memory, reset_peak_memory
from asperity.types import Array

POISSON = 0.33
"""Poisson's ratio of the solid in contact, and of the stress whose errors are measured."""


@dataclass(frozen=True)
class Scene:
    """A contact to be calculated: random surface of the unit cell, solid, loads and Poisson's ratios.

    Parameters
    ----------
    hurst, wavelength_long, wavelength_short : float
        Power spectrum; wavelengths in cell lengths.
    area_fraction : float
        Contact area over the area of the cell at the load whose stress is analysed.
    seed : int
        Seed of the surface.
    rms_height : float
    layer_height : float
        Height of the elastic layer, which is bonded to a rigid base.
    loads : tuple of float
        Area fractions of further loads at which the contact is solved (load-area curve).
    poisson : tuple of float
        Poisson's ratios for which the stress is analysed; `evaluate` requires `POISSON` among them.
    """

    hurst: float
    wavelength_long: float
    wavelength_short: float
    area_fraction: float
    seed: int = 1
    rms_height: float = 1e-3
    layer_height: float = 1.0
    loads: tuple[float, ...] = ()
    poisson: tuple[float, ...] = (POISSON,)

    @property
    def number_of_loads(self) -> int:
        """Different area fractions at which the contact is solved."""
        return len({*self.loads, self.area_fraction})


def scene_of(config: Mapping[str, Any], name: str, load_area: bool) -> Scene:
    """The scene of an entry of ``surfaces`` in a complete configuration.

    With `load_area` its contact is solved at all loads of the load-area curve.
    """
    surface, contact = config["surfaces"][name], config["contact"]
    if "area_fraction" not in contact:
        load, value = imposed_load(contact)
        raise ConfigError(
            f"contact.{load} = {value!r}: area_fraction is needed in its place, for which costs and errors "
            "were measured"
        )
    return Scene(
        hurst=surface["hurst"],
        wavelength_long=surface["wavelength_long"],
        wavelength_short=surface["wavelength_short"],
        area_fraction=contact["area_fraction"],
        layer_height=config["layer"]["height"],
        loads=tuple(contact["path_area_fractions"] if load_area else ()),
        poisson=tuple(config["stress"]["poisson"]),
    )


@dataclass(frozen=True)
class Evaluation:
    """Outputs and cost of one calculation from the surface to its statistics.

    Parameters
    ----------
    scene : Scene
    accuracy : AccuracySettings
        Settings of accuracy it was made with.
    statistics : dataset
        Of `asperity.pipeline.statistics.seed_statistics`, at the Poisson's ratio `POISSON`.
    area_fraction : float
        Contact area fraction at the mean pressure of a reference, or that of the calculation itself.
    costs : mapping
        ``surface_seconds``, ``contact_seconds``, ``stress_seconds``, ``transform_seconds``,
        ``contact_pairs``, ``full_planes``, ``peak_memory``; described in `asperity.results.variables`.
    """

    scene: Scene
    accuracy: AccuracySettings
    statistics: xr.Dataset
    area_fraction: float
    costs: Mapping[str, float]

    @property
    def seconds(self) -> float:
        """Processor time of surface, contact and stress."""
        return sum(self.costs[f"{stage}_seconds"] for stage in CALCULATION_STAGES)

    @property
    def mean_pressure(self) -> float:
        """Load over nominal area."""
        return float(self.statistics["seed_mean_pressure"])

    def values(self) -> dict[str, float]:
        """Value of every output; NaN for distributions."""
        numbers = {
            name: float(self.statistics[variable].sel(where)) for name, (variable, where) in NUMBERS.items()
        }
        return {"area_fraction": self.area_fraction, **numbers, **dict.fromkeys(DISTRIBUTIONS, np.nan)}

    def quantiles(self) -> dict[str, Array]:
        """Quantiles of every output that is a distribution, at `asperity.pipeline.statistics.LEVELS`."""
        peaks = self.statistics["seed_peak_quantile"]
        return {name: peaks.sel(quantity=quantity).values for name, quantity in DISTRIBUTIONS.items()}


def evaluate(scene: Scene, accuracy: AccuracySettings, mean_pressure: float | None = None) -> Evaluation:
    """Calculate surface, contact, stress and statistics of a scene.

    Parameters
    ----------
    scene : Scene
    accuracy : AccuracySettings
    mean_pressure : float, optional
        Load at which the contact area is calculated too; its time is not counted in the cost.

    Raises
    ------
    ConvergenceError
        If the contact does not reach its tolerance.
    """
    settings = stage_settings(scene, accuracy)
    reset_peak_memory()
    clock = [time.process_time()]
    surface = make_surface(settings["surface"], scene.seed)
    clock.append(time.process_time())
    contact = solve_contact(surface, settings["layer"], settings["contact"])
    clock.append(time.process_time())
    stress = compute_stress(contact, settings["layer"], settings["stress"])
    clock.append(time.process_time())
    points = contact.sizes["x"]
    names = [f"{stage}_seconds" for stage in CALCULATION_STAGES]
    costs: dict[str, float] = dict(zip(names, np.diff(clock).tolist(), strict=True))
    costs["contact_pairs"] = contact.attrs["certificate_pairs"]
    costs["full_planes"] = float(np.sum((stress["plane_points"] / points) ** 2))
    costs["peak_memory"] = 1e6 * peak_memory()
    costs["transform_seconds"] = transform_seconds(points)
    area = float(contact["area_fraction"])
    if mean_pressure is not None:
        area = _area_at(mean_pressure, surface, contact, settings)
    statistics = seed_statistics(surface, contact, stress).sel(poisson=POISSON)
    return Evaluation(scene, accuracy, statistics, area, costs)


def stage_settings(scene: Scene, accuracy: AccuracySettings) -> dict[str, Any]:
    """The sections of a configuration from which the stages calculate a scene."""
    return {
        "name": "tradeoff",
        "seed": scene.seed,
        "surface": {
            "hurst": scene.hurst,
            "wavelength_long": scene.wavelength_long,
            "wavelength_short": scene.wavelength_short,
            "rms_height": scene.rms_height,
            "points": accuracy.points(scene.wavelength_short),
        },
        "layer": {
            "height": scene.layer_height,
            "bottom": "bonded",
            "poisson": POISSON,
            "lateral": "confined",
            "half_space_tolerance": accuracy.half_space_tolerance,
        },
        "contact": {
            "method": "active_set",
            "area_fraction": scene.area_fraction,
            "path_area_fractions": list(scene.loads),
            "tolerance": accuracy.contact_tolerance,
            "precision": accuracy.precision,
        },
        "stress": {
            "poisson": list(scene.poisson),
            "tolerance": accuracy.depth_tolerance,
            "depth_spacing": accuracy.depth_spacing,
        },
    }


def solid_record(scene: Scene, accuracy: AccuracySettings) -> dict[str, Any]:
    """Record of the solid used for a scene, layer or half-space, as in the attributes of its contact file."""
    return solid(stage_settings(scene, accuracy)["layer"])[1]


def output_errors(evaluation: Evaluation, reference: Evaluation) -> dict[str, float]:
    """Errors of all outputs: signed relative differences from a reference, or distances of distributions."""
    found, expected = evaluation.values(), reference.values()
    errors = {name: found[name] / expected[name] - 1 for name in ("area_fraction", *NUMBERS)}
    expected_quantiles = reference.quantiles()
    for name, quantiles in evaluation.quantiles().items():
        errors[name] = distance(quantiles, expected_quantiles[name])
    return errors


def distance(quantiles: Array, reference: Array) -> float:
    """Mean distance between equal quantiles of two distributions, divided by the mean of the second."""
    return float(np.trapezoid(np.abs(quantiles - reference), LEVELS) / np.trapezoid(reference, LEVELS))


def _area_at(
    mean_pressure: float, surface: xr.Dataset, contact: xr.Dataset, settings: Mapping[str, Any]
) -> float:
    """Contact area fraction at a mean pressure, with a solved contact as the initial guess."""
    layer, _ = solid(settings["layer"])
    return solve(
        surface["height"].values,
        layer,
        mean_pressure=mean_pressure,
        rtol=settings["contact"]["tolerance"],
        dtype=settings["contact"]["precision"],
        initial=contact["pressure"].values,
    ).area_fraction
