"""Plans: bounds hold on surfaces that were not measured, and proposals reach their targets.

Times hold for the machine of the measurement (factor 1), so that no test depends on the clock.
"""

from dataclasses import replace

import pytest
import yaml
from project import ROOT

import asperity as asp
from asperity.cli.main import main
from asperity.core.errors import PlanError
from asperity.paper.figures import surfaces_with_load_area
from asperity.settings.accuracy import PRESETS
from asperity.settings.check import check
from asperity.study.cost.plan import (
    PlannedContact,
    Target,
    assess,
    error_bounds,
    planned_contacts,
    propose,
    read,
)

PAPER = yaml.safe_load((ROOT / "config/config.yaml").read_text())
UNSEEN = PlannedContact(hurst=0.5, wavelength_long=1 / 4, wavelength_short=1 / 16, contact_area_fraction=0.06)
SPECTRUM = "{hurst: 0.8, wavelength_long: 0.125, wavelength_short: 0.03125}"


def corrected(nodes, **load):
    """Corrected numbers of a surface that was not measured, and its load."""
    points = round(nodes / UNSEEN.wavelength_short)
    band = UNSEEN.hurst, UNSEEN.wavelength_long, UNSEEN.wavelength_short
    height = asp.self_affine((points, points), *band, rms_height=1e-3, seed=7)
    contact = asp.solve_contact(height, asp.Solid(1.0, 0.33), **load)
    stress = asp.analyse_stress(
        contact, quantities=("pressure", "von_mises"), tolerance=1e-4, covariances=True
    )
    found = asp.continuum_limit(contact, stress).sel(kind="estimate").squeeze("poisson")
    names = ("contact_area_fraction", "proportionality", "decay_length_plane")
    numbers = {name: float(found[name]) for name in names}
    for kind in ("pressure", "von_mises"):
        numbers |= {f"{kind}_{name}": float(found[name].sel(quantity=kind)) for name in ("p90", "p99")}
    return numbers, contact.mean_pressure


@pytest.mark.parametrize("name", ["draft", "paper"])
def test_errors_stay_within_bounds_elsewhere(name):
    truth, load = corrected(24, contact_area_fraction=0.06)
    found, _ = corrected(PRESETS[name].points_per_wavelength, mean_pressure=load)
    bounds = error_bounds(UNSEEN, PRESETS[name], one_surface=True).sum(axis=1)
    for output, value in truth.items():
        assert abs(found[output] / value - 1) <= bounds[output], output


def test_proposal_is_the_cheapest_within_the_error():
    target = Target(["von_mises_p90"], error=0.15, one_surface=True)
    found = propose([UNSEEN], target, factor=1.0)
    assert found.error(target.outputs) <= target.error
    for points in (4.0, 6.0, 8.0, 12.0, 16.0):
        other = assess([UNSEEN], replace(PRESETS["paper"], points_per_wavelength=points), True, 1.0)
        assert other.error(target.outputs) > target.error or other.seconds >= found.seconds


def test_seeds_proposed_reach_the_error():
    target = Target(["peak_depth"], error=0.15)
    found = propose([UNSEEN], target, factor=1.0)
    assert found.accuracy.seeds > 1
    assert found.error(target.outputs) <= target.error
    fewer = replace(found.accuracy, seeds=found.accuracy.seeds - 1)
    assert assess([UNSEEN], fewer, factor=1.0).error(target.outputs) > target.error


@pytest.mark.parametrize(
    ("contact", "accuracy"),
    [
        (UNSEEN, replace(PRESETS["paper"], points_per_wavelength=2.0)),
        (replace(UNSEEN, contact_area_fraction=0.001), PRESETS["paper"]),
        (UNSEEN, replace(PRESETS["paper"], contact_tolerance=0.1)),
    ],
)
def test_what_was_not_measured_has_no_bound(contact, accuracy):
    assert (error_bounds(contact, accuracy).sum(axis=1) == float("inf")).all()


def test_coarser_settings_have_larger_errors():
    chosen = (replace(PRESETS["paper"], depth_spacing=spacing) for spacing in (0.5, 2.0))
    tight, loose = (error_bounds(UNSEEN, accuracy, one_surface=True) for accuracy in chosen)
    assert (loose["settings"] >= tight["settings"]).all()
    assert loose["settings"]["peak_depth"] > 0.5


@pytest.mark.parametrize(
    ("target", "kind", "line"),
    [
        ({"error": 1e-9}, PlanError, "is the least that measured settings reach in pressure_p90"),
        ({"seconds": 1e-9}, PlanError, "not within 1e-09 s: the coarsest measured settings take"),
        ({"memory": 2.0**20}, PlanError, "not within 1 MiB: "),
        ({"error": 0.1, "outputs": ["peak"]}, ValueError, "output = 'peak': one of contact_area_fraction"),
    ],
)
def test_impossible_targets_are_named(target, kind, line):
    with pytest.raises(kind, match=line):
        propose([UNSEEN], Target(**target), factor=1.0)


def test_command_proposes_an_accepted_configuration(capsys):
    assert main(["plan", SPECTRUM, "--error", "0.1", "--output", "von_mises_p99", "--one-surface"]) == 0
    printed = capsys.readouterr().out
    assert "this very surface" in printed
    keys = yaml.safe_load(printed.split("configuration:\n")[1])
    paper = PAPER["surfaces"]["gaussian"] | {"wavelength_short": 0.03125}
    keys["surfaces"] = {"surface": paper | keys["surfaces"]["surface"]}
    assert keys.keys() <= {"seeds", "surfaces", "stress"}  # the other settings are those of the preset
    config = {**PAPER, "seeds": keys["seeds"], "surfaces": {**PAPER["surfaces"], **keys["surfaces"]}}
    check(config | {"stress": PAPER["stress"] | keys.get("stress", {})})


def test_loads_count_where_a_figure_shows_the_contact():
    band = "hurst: 0.8, wavelength_long: 0.125, wavelength_short: 0.03125, rms_height: 0.001"
    text = f"surfaces: {{ground: {{label: a, {band}}}, lapped: {{label: b, {band}}}}}"
    contact = "contact: {path_contact_area_fractions: [0.02, 0.05, 0.1]}"
    whole = read([text, contact])
    found, _ = planned_contacts(whole, surfaces_with_load_area(whole))
    assert {name: contact.loads for name, contact in found.items()} == {"ground": 3, "lapped": 3}


def test_surfaces_are_planned_on_their_own_grids(capsys):
    """The paper's surfaces have eight nodes on the shortest wavelength, one has four."""
    assert main(["plan", str(ROOT / "config/config.yaml")]) == 0
    keys = yaml.safe_load(capsys.readouterr().out.split("configuration:\n")[1])
    for name, planned in keys["surfaces"].items():
        surface = PAPER["surfaces"][name]
        assert planned["points"] == surface.get("points", 8 / surface["wavelength_short"])
