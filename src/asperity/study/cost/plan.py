"""Cost and errors of a calculation before it is made, and the cheapest settings that reach a target.

`errors.csv` holds the largest errors of every output that ``benchmarks/tradeoff.py`` found on random
surfaces, after the correction of the grid (`asperity.continuum_limit`). The bound of an output is a margin
times the sum of its errors on the next coarser grid and with the next coarser settings that were measured;
for the mean over surfaces of one kind, a 95 % confidence interval from the spread of the seeds is added.

A proposal chooses the nodes on the shortest wavelength and the number of seeds. The other settings are taken
from the preset of the paper, whose errors are far smaller.
"""

import math
import os
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache
from importlib.resources import files
from typing import Any

import numpy as np
import pandas as pd
import yaml

from asperity.core.arguments import choice
from asperity.core.errors import InputError, PlanError, shown
from asperity.settings.accuracy import PRESETS, AccuracySettings, accuracy_of
from asperity.settings.check import check
from asperity.settings.configuration import Configuration
from asperity.settings.model import described
from asperity.settings.reader import load, merged, parse
from asperity.settings.sections import contact_of, imposed_load
from asperity.settings.study import ALL_SURFACES, with_base, with_loads
from asperity.study.cost.model import job_cost, minutes, time_factor


@dataclass(frozen=True)
class PlannedContact:
    """A contact to be calculated.

    Parameters
    ----------
    hurst, wavelength_long, wavelength_short : float
        Power spectrum of the random surface; wavelengths in cell lengths.
    contact_area_fraction : float
        Contact area over the area of the cell at the load whose stress is analysed.
    loads, ratios : int
        Number of loads at which the contact is solved, and of Poisson's ratios of its stress.
    points_per_wavelength : float, optional
        For this surface, in place of the number that the settings of accuracy give for all surfaces.
    """

    hurst: float
    wavelength_long: float
    wavelength_short: float
    contact_area_fraction: float
    loads: int = 1
    ratios: int = 1
    points_per_wavelength: float | None = None

    def settings(self, accuracy: AccuracySettings) -> AccuracySettings:
        """Settings of accuracy of this surface."""
        points = self.points_per_wavelength or accuracy.points_per_wavelength
        return replace(accuracy, points_per_wavelength=points)


UNPLANNED = {"label": "surface", "rms_height": 1e-3}
"""Values of settings that a study needs and on which neither cost nor errors depend."""


def read(given: Sequence[str], contact_area_fraction: float | None = None) -> dict[str, Any]:
    """Complete configuration from files and YAML texts, each merged into those before.

    Parameters
    ----------
    given : sequence of str
        Names of YAML files, or YAML text: a configuration, an overlay, or the settings of one surface.
    contact_area_fraction : float, optional
        Replaces the area fraction of the configuration.

    Raises
    ------
    InputError
        If a file or text is not YAML, or a setting is not accepted.
    """
    config: dict[str, Any] = {}
    for text in given:
        try:
            found = load(text) if os.path.isfile(text) else parse(text, shown(text))
        except InputError as error:
            if os.path.isfile(text) or ":" in text:
                raise
            needed = "a file, or keys and values such as '{hurst: 0.8, ...}', is needed"
            raise InputError(shown(text), [needed]) from error
        config = merged(config, found)
    if not config.keys() & described(Configuration)["properties"]:
        config = {"surfaces": {"surface": config}}
    config = with_base(config)
    surfaces = config.get("surfaces")
    if isinstance(surfaces, dict):
        both = {name: UNPLANNED | given for name, given in surfaces.items() if isinstance(given, dict)}
        config["surfaces"] = surfaces | both
    config = with_loads(config)
    if contact_area_fraction is not None:
        config = merged(config, {"contact": {"contact_area_fraction": contact_area_fraction}})
    whole = check(config)
    if not whole["surfaces"]:
        raise InputError("surfaces", ["missing; a plan needs at least one random surface"])
    whole.setdefault("studies", {ALL_SURFACES: list(whole["surfaces"])})
    return whole


def planned_contacts(
    config: Mapping[str, Any], load_area: Collection[str]
) -> tuple[dict[str, PlannedContact], AccuracySettings]:
    """Planned contacts of a complete configuration, and settings of accuracy.

    They belong to the random surfaces of all studies, or to all surfaces if no study names any. A
    figure shows the load-area curves of the surfaces in `load_area`.

    Raises
    ------
    InputError
        If another load than the area is imposed.
    """
    in_studies = {name for names in config["studies"].values() for name in names}
    names = [name for name in config["surfaces"] if name in in_studies] or list(config["surfaces"])
    found = {}
    for name in names:
        surface, contact = config["surfaces"][name], contact_of(config, name)
        kind, area = imposed_load(contact)
        if kind != "contact_area_fraction":
            needed = "contact_area_fraction is needed in its place, for which costs and errors were measured"
            raise InputError(f"contact.{kind} = {area!r}", [needed])
        found[name] = PlannedContact(
            hurst=surface["hurst"],
            wavelength_long=surface["wavelength_long"],
            wavelength_short=surface["wavelength_short"],
            contact_area_fraction=area,
            loads=len({*contact["path_contact_area_fractions"], area}) if name in load_area else 1,
            ratios=len(config["stress"]["poisson"]),
            points_per_wavelength=accuracy_of(config, name).points_per_wavelength,
        )
    return found, accuracy_of(config, names[0])


PEAK_OUTPUTS = ("pressure_p90", "pressure_p99", "von_mises_p90", "von_mises_p99")
"""Outputs whose errors a plan limits if none is named."""

MAX_SEEDS = 1000
"""Largest number of seeds that is proposed."""

ERROR_MARGIN = 1.5
"""Bound over the largest error that was measured."""

STUDENT_95 = 2.36
"""Half-width of a 95 % confidence interval over the standard deviation: Student's t for the 8 seeds that were
measured."""

MEASURED_WAVELENGTH = 0.125
"""Longest wavelength over the cell of the surfaces that were measured; the spread of seeds grows with it."""

MEASURED_RANGES = {"hurst": (0.2, 0.8), "contact_area_fraction": (0.02, 0.1)}
"""Ranges of the properties of the surfaces on which the errors were measured."""

VARIED = ("contact_tolerance", "depth_tolerance", "depth_spacing", "half_space_tolerance")
"""Settings whose error grows with their value."""


@cache
def measured() -> pd.DataFrame:
    """Measured errors: area, parameter, setting, output, on_grid, and error after correction."""
    table = pd.read_csv(files("asperity.study.cost").joinpath("errors.csv"), dtype={"setting": str})
    return table[table["output"] != "seconds"]  # the tables of the pages show the seconds


def outputs() -> list[str]:
    """Names of the outputs whose errors were measured."""
    return measured()["output"].unique().tolist()


def spacing_of(points: float) -> float:
    """Distance of the planes, in grid spacings, with a number of nodes on the shortest wavelength.

    It is the distance of the paper, or on coarser grids less, at most a sixteenth of the wavelength.
    """
    paper = PRESETS["paper"]
    return paper.depth_spacing * min(1.0, points / paper.points_per_wavelength)


@dataclass(frozen=True)
class Target:
    """Limits that a plan has to keep; at least one of error, time and memory.

    Parameters
    ----------
    outputs : names
        All of them are to be within the error.
    error : float, optional
        Largest relative error; the settings that take least time are proposed.
    seconds : float, optional
        Processor time for all contacts and seeds on one thread. Without an error, the settings with the
        smallest error are proposed.
    memory : float, optional
        Bytes of one process.
    one_surface : bool
        Errors of the surface of one seed; otherwise of the mean over all surfaces of its kind.

    """

    outputs: Sequence[str] = PEAK_OUTPUTS
    error: float | None = None
    seconds: float | None = None
    memory: float | None = None
    one_surface: bool = False


@dataclass(frozen=True)
class Proposal:
    """Settings of accuracy with their cost and error bounds.

    Parameters
    ----------
    accuracy : AccuracySettings
    seconds : float
        Processor time on one thread for all contacts and seeds.
    memory : float
        Peak memory of one process in bytes.
    errors : data frame
        Bounds of the relative errors: a row for each output, columns ``grid``, ``settings`` and ``seeds``.
    """

    accuracy: AccuracySettings
    seconds: float
    memory: float
    errors: pd.DataFrame

    def of(self, names: Sequence[str]) -> pd.DataFrame:
        """Error bounds of some outputs; `ValueError` for the first name that is not an output."""
        for name in names:
            choice("output", name, outputs())
        return self.errors.loc[[*names]]

    def error(self, names: Sequence[str]) -> float:
        """Largest total error bound of some outputs."""
        return float(self.of(names).sum(axis=1).max())


def contact_cost(contact: PlannedContact, accuracy: AccuracySettings) -> tuple[float, float]:
    """Processor time (s) and peak memory (bytes) of one surface and one seed, from the spectrum to the peaks.

    The stages run one after the other, each in a process of its own, whose start is counted.
    """
    nodes = contact.settings(accuracy).points(contact.wavelength_short) ** 2
    job = "contact" if contact.loads == 1 else "load-area curve"
    stress = job_cost("stress", nodes, contact.ratios, accuracy.depth_spacing)
    costs = [job_cost(job, nodes, contact.loads), stress]
    return sum(cost.seconds for cost in costs), max(cost.memory for cost in costs)


def assess(
    contacts: Sequence[PlannedContact],
    accuracy: AccuracySettings,
    one_surface: bool = False,
    factor: float | None = None,
) -> Proposal:
    """Cost of all contacts and seeds, one after the other, and the largest error bounds of any of them.

    Parameters
    ----------
    contacts : sequence of PlannedContact
    accuracy : AccuracySettings
    one_surface : bool
        As in `Target`.
    factor : float, optional
        Time on this machine over the time on the machine of the measurement; by default
        `asperity.study.cost.model.time_factor`.
    """
    factor = time_factor() if factor is None else factor
    costs = [contact_cost(contact, accuracy) for contact in contacts]
    bounds = [error_bounds(contact, accuracy, one_surface) for contact in contacts]
    errors = pd.concat(bounds).groupby(level=0, sort=False).max()
    seconds = factor * accuracy.seeds * sum(seconds for seconds, _ in costs)
    return Proposal(accuracy, seconds, max(memory for _, memory in costs), errors)


def error_bounds(
    contact: PlannedContact, accuracy: AccuracySettings, one_surface: bool = False
) -> pd.DataFrame:
    """Bounds of the relative errors as in `Proposal`, infinite where nothing was measured.

    Errors grow as the area falls. The errors are therefore taken at the largest measured area that is not
    above the area of the contact.
    """
    accuracy = contact.settings(accuracy)
    table = measured()
    areas = table["contact_area_fraction"][
        table["contact_area_fraction"] <= contact.contact_area_fraction * (1 + 1e-9)
    ]
    if areas.empty:
        return pd.DataFrame(math.inf, outputs(), ["grid", "settings", "seeds"])
    table = table[table["contact_area_fraction"] == areas.max()].set_index("output")

    def largest(parameter: str, limit: float) -> pd.Series:
        """Errors at the next coarser setting that was measured; infinite if there is none."""
        rows = table[table["parameter"] == parameter]
        sign = -1 if parameter == "points_per_wavelength" else 1
        values = sign * rows["setting"].astype(float)
        coarser = values[values >= sign * limit * (1 - sign * 1e-9)]
        if coarser.empty:
            return pd.Series(math.inf, outputs())
        return rows["error"][values == coarser.min()]

    paper = PRESETS["paper"]
    limits = {name: getattr(accuracy, name) for name in VARIED}
    # The spacing of the planes was varied on the grid of the paper, and the errors of the grids include the
    # error of this spacing.
    limits["depth_spacing"] *= paper.points_per_wavelength / accuracy.points_per_wavelength
    if limits["depth_spacing"] <= paper.depth_spacing:
        limits["depth_spacing"] = 0
    found = (largest(name, limit) for name, limit in limits.items() if limit > 0)
    settings = sum(found, pd.Series(0.0, outputs()))
    if accuracy.precision == "float32":
        settings += table["error"][table["parameter"] == "precision"]
    spread = table["error"][table["parameter"] == "seeds"]
    interval = STUDENT_95 * contact.wavelength_long / MEASURED_WAVELENGTH / math.sqrt(accuracy.seeds)
    grid = largest("points_per_wavelength", accuracy.points_per_wavelength)
    of_seeds = (0.0 if one_surface else interval) * spread
    bounds = {"grid": ERROR_MARGIN * grid, "settings": ERROR_MARGIN * settings, "seeds": of_seeds}
    return pd.DataFrame(bounds, index=outputs())


def propose(contacts: Sequence[PlannedContact], target: Target, factor: float | None = None) -> Proposal:
    """The cheapest settings within an error, or the most accurate within a time and a memory.

    Parameters
    ----------
    contacts : sequence of PlannedContact
        One or more; the settings are the same for all of them.
    target : Target
    factor : float, optional
        As in `assess`.

    Raises
    ------
    PlanError
        If no measured settings reach the target.
    """
    factor = time_factor() if factor is None else factor
    grids = measured().query("parameter == 'points_per_wavelength'")["setting"].unique()
    found = []
    for points in map(float, grids):
        accuracy = replace(PRESETS["paper"], points_per_wavelength=points, depth_spacing=spacing_of(points))
        single = assess(contacts, accuracy, target.one_surface, factor)
        seeds = 1 if target.one_surface else _seeds_needed(single, target)
        found.append(assess(contacts, replace(accuracy, seeds=seeds), target.one_surface, factor))
    seconds, memory = target.seconds or math.inf, target.memory or math.inf
    affordable = [each for each in found if each.seconds <= seconds and each.memory <= memory]
    if not affordable:
        least = min(found, key=lambda each: each.seconds)
        within = [f"{target.seconds:g} s"] if target.seconds else []
        within += [f"{target.memory / 2**20:.3g} MiB"] if target.memory else []
        raise PlanError(
            f"not within {' and '.join(within)}: the coarsest measured settings take {least.seconds:.2g} s "
            f"and {least.memory / 2**20:.2g} MiB; give more, or a larger wavelength_short"
        )
    best = min(affordable, key=lambda proposal: proposal.error(target.outputs))
    if target.error is None:
        return best
    accurate = [proposal for proposal in affordable if proposal.error(target.outputs) <= target.error]
    if not accurate:
        raise PlanError(
            f"error = {target.error:g}: {best.error(target.outputs):.2g} is the least that measured settings "
            f"reach in {', '.join(target.outputs)}"
        )
    return min(accurate, key=lambda proposal: proposal.seconds)


def _seeds_needed(single: Proposal, target: Target) -> int:
    """Number of seeds that the error requires, or that the time allows."""
    if target.error is None:
        return 1 if target.seconds is None else max(1, min(MAX_SEEDS, int(target.seconds / single.seconds)))
    errors = single.of(target.outputs)
    left = target.error - errors["grid"] - errors["settings"]
    if (left <= 0).any():
        return MAX_SEEDS
    return int(np.clip(np.ceil((errors["seeds"] / left).max() ** 2), 1, MAX_SEEDS))


def report(
    proposal: Proposal,
    contacts: Mapping[str, PlannedContact],
    outputs: Sequence[str],
    one_surface: bool = False,
) -> str:
    """Text of a proposal: its cost, its error bounds by source, and the keys that set its grids and seeds.

    Parameters
    ----------
    proposal : Proposal
    contacts : mapping
        Name of each surface → its contact.
    outputs : names
    one_surface : bool
        As in `Target`.

    Raises
    ------
    ValueError
        If an output is unknown.
    """
    accuracy = proposal.accuracy
    points = {name: each.settings(accuracy).points(each.wavelength_short) for name, each in contacts.items()}
    largest = max(points.values())
    subject = "this very surface" if one_surface else "the mean of its kind, to 95 %"
    bounds = proposal.of(outputs)
    bounds = bounds.drop(columns="seeds") if one_surface else bounds
    bounds["together"] = bounds.sum(axis=1)
    keys: dict[str, Any] = {
        "seeds": list(range(1, accuracy.seeds + 1)),
        "surfaces": {name: {"points": number} for name, number in points.items()},
    }
    if accuracy.depth_spacing != PRESETS["paper"].depth_spacing:
        keys["stress"] = {"depth_spacing": accuracy.depth_spacing}
    warnings = {
        name: f"# {name} = {getattr(contact, name):g} is outside what was measured, {low:g} to {high:g}"
        for contact in contacts.values()
        for name, (low, high) in MEASURED_RANGES.items()
        if not low <= getattr(contact, name) <= high
    }
    lines = [
        f"{len(contacts)} {'surface' if len(contacts) == 1 else 'surfaces'}, {accuracy.seeds} "
        f"{'seed' if accuracy.seeds == 1 else 'seeds'}, at most {largest} x {largest} nodes",
        f"about {minutes(proposal.seconds)} on one thread, {proposal.memory / 2**30:.2f} GiB; errors of "
        f"{subject}, corrected for the grid",
        "",
        bounds.map(percent).rename_axis(columns="error at most").to_string(),
        "",
        "settings, to lay over a configuration:",
        *warnings.values(),
        yaml.safe_dump(keys, default_flow_style=None, sort_keys=False).rstrip(),
    ]
    return "\n".join(lines)


def percent(value: float) -> str:
    """A relative error as a percentage with two digits; ``not measured`` if it is not finite."""
    if not math.isfinite(value):
        return "not measured"
    return "0" if value == 0 else f"{float(f'{100 * value:.2g}'):g} %"
