"""The trade between speed and accuracy: what every knob costs, and how wrong it makes the outputs people use.

Errors are separated by source. One knob at a time is turned off a reference whose other knobs are converged,
on one and the same surface (a seed is the same surface on every grid), and the outputs are compared. The
discretisation is compared with the finest grid; the other knobs, whose errors are far smaller, with a
converged run on the grid of the study, which makes them cheap to measure. Whole settings, the presets among
them, are compared with the finest grid. What surfaces of one kind differ by is its own source, the seeds.

Unlike other results these hold seconds: of processor time on one thread, which other work on the machine
disturbs least, with the time of a transform at that moment beside them.
"""

from __future__ import annotations

import json
import resource
import sys
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from asperity.config.presets import PRESETS, AccuracySettings
from asperity.contact import solve
from asperity.pipeline.contact import solve_contact
from asperity.pipeline.solid import solid
from asperity.pipeline.stress import compute_stress
from asperity.pipeline.summary import LEVELS, Summary, summarise
from asperity.pipeline.surface import make_surface
from asperity.spectral import Fourier, Grid
from asperity.types import Array, Progress

NUMBERS = {
    "proportionality": "contact.proportionality",
    "gradient_rms_contact": "contact.gradient_rms_contact",
    "pressure_p90": "pressure.p90@{}",
    "pressure_p99": "pressure.p99@{}",
    "von_mises_p90": "von_mises.p90@{}",
    "von_mises_p99": "von_mises.p99@{}",
    "largest_von_mises": "profile.largest@{}",
    "peak_depth": "von_mises.depth@{}",
    "decay_length_depth": "decay.depth@{}",
    "decay_length_plane": "decay.plane@{}",
}
"""Outputs that are numbers of a summary; their error is relative."""

DISTRIBUTIONS = {"pressure_distribution": "pressure@{}", "von_mises_distribution": "von_mises@{}"}
"""Outputs that are distributions of peaks; their error is how far equal percentiles lie apart on the mean,
over the mean peak."""

OUTPUTS = ("area_fraction", *NUMBERS, *DISTRIBUTIONS)
"""What errors are measured of. The area is that at the load of the reference."""

EXACT = AccuracySettings(8.0, 1e-9, "float64", 1e-7, 0.125, 0.05, 1)
"""The reference: knobs so fine that their errors do not show beside those measured."""

SETTINGS: dict[str, tuple[Any, ...]] = {
    "contact_tolerance": (1e-3, 1e-4, 1e-6),
    "precision": ("float32",),
    "depth_tolerance": (1e-1, 1e-2, 1e-3, 1e-4, 1e-6),
    "depth_spacing": (4.0, 2.0, 1.0, 0.5, 0.25),
}
"""Settings of each knob that is turned off the reference, coarsest first."""

SINGLE_TOLERANCE = 1e-6
"""Tolerance at which single precision is measured, the least that it accepts."""

HEIGHTS = (0.5, 0.75, 1.0)
"""Heights of layers for which a half-space is taken, in cell lengths."""

MIXTURES = {
    "coarse": replace(
        EXACT, contact_tolerance=1e-3, precision="float32", depth_tolerance=1e-2, depth_spacing=1.0
    ),
    "even": replace(EXACT, contact_tolerance=1e-4, depth_tolerance=1e-2, depth_spacing=0.5),
    "fine": replace(EXACT, contact_tolerance=1e-6, depth_tolerance=1e-4, depth_spacing=0.25),
}
"""Sensible combinations of the other knobs, each tried on every grid."""

MEMBERS = 8
"""Seeds over which surfaces of one kind are compared."""

RATIOS = (0.0, 0.25, 0.33, 0.5)
"""Poisson's ratios analysed together where the cost of several is measured."""

LOADS = (0.02, 0.04, 0.07)
"""Further loads on the way where the cost of several is measured."""

_POISSON = 0.33
_STAGES = ("surface_seconds", "contact_seconds", "stress_seconds")


@dataclass(frozen=True)
class Scene:
    """What is pressed: a kind of surface, one of its seeds, and how far.

    Parameters
    ----------
    hurst, wavelength_long, wavelength_short : float
        Spectrum; lengths in cell lengths.
    area_fraction : float
    seed : int
    rms_height : float
    layer_height : float
        Height of the elastic layer.
    loads : tuple of float
        Area fractions of the load-area curve that is followed besides.
    """

    hurst: float
    wavelength_long: float
    wavelength_short: float
    area_fraction: float
    seed: int = 1
    rms_height: float = 1e-3
    layer_height: float = 1.0
    loads: tuple[float, ...] = ()


@dataclass(frozen=True)
class Outcome:
    """Outputs and cost of one run of the chain from surface to summary.

    Parameters
    ----------
    scene : Scene
    knobs : AccuracySettings
    ratios : tuple of float
        Poisson's ratios analysed.
    summary : Summary
    area_fraction : float
        At the load asked for, or that of the run.
    costs : mapping
        ``surface_seconds``, ``contact_seconds``, ``stress_seconds``, ``transform_seconds``, ``contact_pairs``,
        ``full_planes``, ``peak_memory``.
    """

    scene: Scene
    knobs: AccuracySettings
    ratios: tuple[float, ...]
    summary: Summary
    area_fraction: float
    costs: Mapping[str, float]

    def values(self) -> dict[str, float]:
        """The outputs that are numbers, NaN for distributions."""
        numbers = {name: self.summary[key.format(_POISSON)] for name, key in NUMBERS.items()}
        return {"area_fraction": self.area_fraction, **numbers, **dict.fromkeys(DISTRIBUTIONS, np.nan)}


@dataclass(frozen=True)
class Run:
    """An outcome, what was tried with it, and how far it is from its reference.

    Parameters
    ----------
    knob, setting : str
        Which source of error is seen; of a reference empty.
    outcome : Outcome
    errors : mapping
        Output → error; empty without a reference.
    """

    knob: str
    setting: str
    outcome: Outcome
    errors: Mapping[str, float] = field(default_factory=dict)


def evaluate(
    scene: Scene,
    knobs: AccuracySettings,
    ratios: Sequence[float] = (_POISSON,),
    mean_pressure: float | None = None,
) -> Outcome:
    """Run the chain from surface to summary once.

    Parameters
    ----------
    scene : Scene
    knobs : AccuracySettings
    ratios : sequence of float
        Poisson's ratios, 0.33 among them.
    mean_pressure : float, optional
        Load at which the area is wanted as well; not counted in the cost.

    Raises
    ------
    ConvergenceError
        If the contact does not reach its tolerance.
    """
    settings = _settings(scene, knobs, ratios)
    _forget_peak_memory()
    spent = [time.process_time()]
    surface = make_surface(settings["surface"], scene.seed)
    spent.append(time.process_time())
    contact = solve_contact(surface, settings["layer"], settings["contact"])
    spent.append(time.process_time())
    stress = compute_stress(contact, settings["layer"], settings["stress"])
    spent.append(time.process_time())
    points = contact.sizes["x"]
    costs: dict[str, float] = dict(zip(_STAGES, np.diff(spent).tolist(), strict=True))
    costs["contact_pairs"] = contact.attrs["certificate_pairs"]
    costs["full_planes"] = float(np.sum((stress["plane_points"] / points) ** 2))
    costs["peak_memory"] = _peak_memory()
    costs["transform_seconds"] = transform_seconds(points)
    area = float(contact["area_fraction"])
    if mean_pressure is not None:
        area = _area_at(mean_pressure, surface, contact, settings)
    stress.attrs["settings"] = json.dumps(settings)
    summary = summarise(surface, contact, stress)
    return Outcome(scene, knobs, tuple(ratios), summary, area, costs)


def transform_seconds(points: int, repetitions: int = 3) -> float:
    """Processor time of a pair of transforms of a square grid now, the least of some repetitions."""
    fourier = Fourier(Grid((points, points)))
    values, coefficients = np.ones((points, points)), np.empty(fourier.grid.half_shape, complex)
    spent = []
    for _ in range(repetitions):
        start = time.process_time()
        fourier.inverse(fourier.forward(values, coefficients), values, overwrite=True)
        spent.append(time.process_time() - start)
    return min(spent)


def errors(outcome: Outcome, reference: Outcome) -> dict[str, float]:
    """How far the outputs are from those of a reference, relative and signed, of distributions positive."""
    own, right = outcome.values(), reference.values()
    found = {name: own[name] / right[name] - 1 for name in ("area_fraction", *NUMBERS)}
    for name, key in DISTRIBUTIONS.items():
        quantiles = (run.summary.quantiles[key.format(_POISSON)] for run in (outcome, reference))
        found[name] = distance(*quantiles)
    return found


def distance(quantiles: Array, reference: Array) -> float:
    """Mean distance of equal percentiles of two distributions, over the mean of the second."""
    return float(np.trapezoid(np.abs(quantiles - reference), LEVELS) / np.trapezoid(reference, LEVELS))


def measure(
    hurst: Sequence[float],
    area_fractions: Sequence[float],
    seeds: Sequence[int],
    wavelength_long: float,
    wavelength_short: float,
    points_per_wavelength: Sequence[float],
    sizes: Sequence[int],
    progress: Progress | None = None,
) -> xr.Dataset:
    """Errors and costs of every knob, of combinations of them, and of growing grids.

    Parameters
    ----------
    hurst, area_fractions, seeds : sequences
        Scenes: every combination of them.
    wavelength_long, wavelength_short : float
        Of the scenes.
    points_per_wavelength : sequence of float
        Discretisations, rising; the last is the reference.
    sizes : sequence of int
        Grids of growing cells, in nodes on an edge, whose cost is measured at the settings of the paper.
    progress : callable, optional

    Returns
    -------
    dataset
        Along `run`, what was tried, its settings and its cost; along `output`, values and errors.
    """
    kinds = [Scene(h, wavelength_long, wavelength_short, area) for h in hurst for area in area_fractions]
    paper = PRESETS["paper"]
    for knobs in (paper, replace(paper, precision="float32"), replace(paper, depth_tolerance=1e-8)):
        evaluate(Scene(hurst[0], 1 / 4, 1 / 8, 0.1), knobs)  # compiles
    sources = [
        *(_every_knob(replace(kind, seed=seed), points_per_wavelength) for kind in kinds for seed in seeds),
        *(_seeds(kind) for kind in kinds),
        _growth(hurst, sizes, wavelength_long),
    ]
    runs: list[Run] = []
    for number, source in enumerate(sources):
        runs += source
        if progress is not None:
            progress(number + 1, len(sources))
    return _dataset(runs)


def _every_knob(scene: Scene, grids: Sequence[float]) -> Iterator[Run]:
    """Each knob off the reference, then whole settings."""
    finest = evaluate(scene, replace(EXACT, points_per_wavelength=grids[-1]))
    yield Run("", "", finest)

    def against(reference: Outcome, knob: str, setting: object, knobs: AccuracySettings) -> Run:
        outcome = evaluate(scene, knobs, mean_pressure=reference.summary["contact.mean_pressure"])
        return Run(knob, str(setting), outcome, errors(outcome, reference))

    for points in grids[:-1]:
        exact = replace(EXACT, points_per_wavelength=points)
        yield against(finest, "points_per_wavelength", points, exact)
    base = evaluate(scene, EXACT)
    yield Run("", "", base)
    for knob, choices in SETTINGS.items():
        for choice in choices:
            knobs = replace(EXACT, **{knob: choice})
            if choice == "float32":
                knobs = replace(knobs, contact_tolerance=SINGLE_TOLERANCE)
            yield against(base, knob, choice, knobs)
    for height in HEIGHTS:
        yield _half_space(replace(scene, layer_height=height))
    for name, knobs in PRESETS.items():
        if knobs.points_per_wavelength < grids[-1]:
            yield against(finest, "accuracy", name, knobs)
    for points in grids[:-1]:
        for name, mixture in MIXTURES.items():
            knobs = replace(mixture, points_per_wavelength=points)
            yield against(finest, "mixture", f"{name} {points:g}", knobs)


def _half_space(scene: Scene) -> Run:
    """The half-space in place of a layer; the setting is the least tolerance at which it is taken."""
    layer = evaluate(scene, replace(EXACT, half_space_tolerance=0.0))
    bound = float(solid(_settings(scene, EXACT, (_POISSON,))["layer"])[1]["solid_bound"])
    taken = replace(EXACT, half_space_tolerance=bound)
    outcome = evaluate(scene, taken, mean_pressure=layer.summary["contact.mean_pressure"])
    return Run("half_space_tolerance", f"{bound:.3g}", outcome, errors(outcome, layer))


def _seeds(scene: Scene) -> Iterator[Run]:
    """Surfaces of one kind, each against their mean."""
    knobs = PRESETS["paper"]
    members = [evaluate(replace(scene, seed=seed), knobs) for seed in range(1, MEMBERS + 1)]
    values = [member.values() for member in members]
    mean = {name: float(np.mean([value[name] for value in values])) for name in OUTPUTS}
    # At a given area it is the load that differs: nearly the same part as the area would at a given load.
    load = [member.summary["contact.mean_pressure"] for member in members]
    quantiles = {
        key: np.mean([member.summary.quantiles[key.format(_POISSON)] for member in members], axis=0)
        for key in DISTRIBUTIONS.values()
    }
    for member, value, own_load in zip(members, values, load, strict=True):
        apart = {name: value[name] / mean[name] - 1 for name in NUMBERS}
        apart["area_fraction"] = float(np.mean(load)) / own_load - 1
        for name, key in DISTRIBUTIONS.items():
            apart[name] = distance(member.summary.quantiles[key.format(_POISSON)], quantiles[key])
        yield Run("seeds", "1", member, apart)


def _growth(hurst: Sequence[float], sizes: Sequence[int], wavelength_long: float) -> Iterator[Run]:
    """Growing cells at the settings of the paper, and with several Poisson's ratios and loads."""
    paper = PRESETS["paper"]
    for points in sizes:
        # The largest surface is analysed once.
        for h in hurst if points < max(sizes) else hurst[-1:]:
            scene = Scene(h, wavelength_long, paper.points_per_wavelength / points, 0.1)
            yield Run("size", str(points), evaluate(scene, paper))
            yield Run("size", str(points), evaluate(replace(scene, loads=LOADS), paper, RATIOS))


def _settings(scene: Scene, knobs: AccuracySettings, ratios: Sequence[float]) -> dict[str, Any]:
    """The sections of a configuration for one scene."""
    return {
        "name": "tradeoff",
        "seed": scene.seed,
        "surface": {
            "hurst": scene.hurst,
            "wavelength_long": scene.wavelength_long,
            "wavelength_short": scene.wavelength_short,
            "rms_height": scene.rms_height,
            "points": knobs.points(scene.wavelength_short),
        },
        "layer": {
            "height": scene.layer_height,
            "bottom": "bonded",
            "poisson": _POISSON,
            "lateral": "confined",
            "half_space_tolerance": knobs.half_space_tolerance,
        },
        "contact": {
            "method": "active_set",
            "area_fraction": scene.area_fraction,
            "path_area_fractions": list(scene.loads),
            "tolerance": knobs.contact_tolerance,
            "precision": knobs.precision,
        },
        "stress": {
            "poisson": list(ratios),
            "tolerance": knobs.depth_tolerance,
            "depth_spacing": knobs.depth_spacing,
        },
    }


def _area_at(
    mean_pressure: float, surface: xr.Dataset, contact: xr.Dataset, settings: Mapping[str, Any]
) -> float:
    """Area fraction at a load near that of a contact."""
    layer, _ = solid(settings["layer"])
    return solve(
        surface["height"].values,
        layer,
        mean_pressure=mean_pressure,
        rtol=settings["contact"]["tolerance"],
        dtype=settings["contact"]["precision"],
        initial=contact["pressure"].values,
    ).area_fraction


def _forget_peak_memory() -> None:
    """Start counting the peak anew, where the system can."""
    counter = Path("/proc/self/clear_refs")
    if counter.exists():
        counter.write_text("5", encoding="ascii")


def _peak_memory() -> float:
    """Largest resident memory of this process in bytes, since it was last forgotten."""
    status = Path("/proc/self/status")
    if status.exists():
        lines = dict(line.split(":", 1) for line in status.read_text(encoding="ascii").splitlines())
        return 1024.0 * float(lines["VmHWM"].split()[0])
    unit = 1 if sys.platform == "darwin" else 1024
    return float(unit * resource.getrusage(resource.RUSAGE_SELF).ru_maxrss)


_COLUMNS: dict[str, Callable[[Run], Any]] = {
    "run_knob": lambda run: run.knob,
    "run_setting": lambda run: run.setting,
    "run_seed": lambda run: run.outcome.scene.seed,
    "run_hurst": lambda run: run.outcome.scene.hurst,
    "run_wavelength_long": lambda run: run.outcome.scene.wavelength_long,
    "run_wavelength_short": lambda run: run.outcome.scene.wavelength_short,
    "run_area_fraction": lambda run: run.outcome.scene.area_fraction,
    "run_points": lambda run: run.outcome.knobs.points(run.outcome.scene.wavelength_short),
    "run_ratios": lambda run: len(run.outcome.ratios),
    "run_loads": lambda run: len({*run.outcome.scene.loads, run.outcome.scene.area_fraction}),
}


def _dataset(runs: Sequence[Run]) -> xr.Dataset:
    columns = {name: [of(run) for run in runs] for name, of in _COLUMNS.items()}
    for name in asdict(EXACT):
        if name != "seeds":
            columns[name] = [getattr(run.outcome.knobs, name) for run in runs]
    for name in runs[0].outcome.costs:
        columns[name] = [run.outcome.costs[name] for run in runs]
    values = [list(run.outcome.values().values()) for run in runs]
    wrong = [[run.errors.get(name, np.nan) for name in OUTPUTS] for run in runs]
    return xr.Dataset(
        {
            **{name: ("run", column) for name, column in columns.items()},
            "output_value": (("run", "output"), values),
            "output_error": (("run", "output"), wrong),
        },
        coords={"output": list(OUTPUTS)},
    )
