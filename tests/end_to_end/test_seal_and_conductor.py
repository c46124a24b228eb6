"""Leakage, the load that seals, resistance, progress; units as words, and arrays in place of files."""

import numpy as np
import pandas as pd
import pytest
from scipy import ndimage

import asperity as asp
from asperity.cli.main import main
from asperity.cli.parser import with_units
from asperity.contact.reynolds import film_flow
from asperity.core.packages import absent
from asperity.core.units import misread
from asperity.engineering.questions.leak import SEALING_ERROR, _sealing_load
from asperity.engineering.show.pictures import pictures
from asperity.study import progress_and_log

EDGES = (30e-6, 50e-6)
HEIGHT = asp.self_affine((24, 32), 0.8, 15e-6, 6e-6, rms_height=2e-7, seed=3, length=EDGES)
RUBBER = {"young": "10 MPa", "poisson": 0.49}
LEAK = {"viscosity": 0.03, "pressure_difference": "5 bar"}
flows = pytest.mark.skipif(bool(absent(["pyamg"])), reason='pip install "asperity[flow]"')


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """A working folder with the map of a shaft, 24 × 32 points that are not square."""
    monkeypatch.chdir(tmp_path)
    np.save("shaft.npy", 1e6 * HEIGHT)
    return tmp_path


def run(*words):
    """Run the command of a seal: the numbers of the answer by name."""
    seal = ["--unit", "um", "--physical-size", "30", "um", "50um", "--young", "10MPa", "--poisson", "0.49"]
    seal += ["--set", "leak.viscosity=0.03", "--set", "leak.pressure_difference=5 bar", "--despike", "8"]
    assert main(["run", "shaft.npy", *seal, "--out", "out", *words]) == 0
    return pd.read_csv("out/answer.csv").set_index("quantity")["value"]


@flows
def test_leakage_of_a_map_that_is_not_square(folder, capsys, without_pictures):
    """The command of the seal; a mirrored map leaks as half of the periodic cell of its four images."""
    found = run("--mean-pressure", "20", "kPa")
    assert found["leakage along x"] > 0
    assert "by discretisation" in capsys.readouterr().out
    answer = asp.run(HEIGHT, RUBBER, length=EDGES, mean_pressure=2e4, leak=LEAK)
    assert answer.contact.grid.mirrored
    unfolded = np.pad(answer.face.height, ((0, 24), (0, 32)), "symmetric")
    cell = asp.solve_contact(unfolded, answer.case.solid, [2 * edge for edge in EDGES], mean_pressure=2e4)
    mirrored = film_flow(cell, 0.03, 1e6).flow_rate
    assert mirrored == pytest.approx(2 * answer["leakage along x"].value, rel=1e-5)


@flows
def test_sealed_gap_is_an_answer_with_the_load_that_seals(folder, capsys, without_pictures):
    """A closed gap leaks nothing, ends no load curve, and the gap is open below the load that seals."""
    found = run(
        "--mean-pressure", "1 MPa", "--set", "load_curve.loads=[10 kPa]", "--set", "load_curve.steps=4"
    )
    assert found["leakage along x"] == 0
    assert "pressure flow factor" not in found
    assert "0, sealed" in capsys.readouterr().out
    curve = pd.read_csv("out/curve.csv")
    assert len(curve) == 4
    assert (curve["leakage_m3_s"].diff()[1:] <= 0).all()
    assert curve["leakage_m3_s"].iloc[0] > curve["leakage_m3_s"].iloc[-1] == 0
    seals = found["mean pressure that seals"]
    for factor, is_open in ((0.97, True), (1.03, False)):
        answer = asp.run(HEIGHT, RUBBER, length=EDGES, mean_pressure=factor * seals, leak={})
        assert answer["gap percolates along x"].value == is_open
    assert "constriction" in {each.name for each in pictures(asp.open_answer("out"))}


@pytest.mark.parametrize(
    ("load", "direction", "more"), [(2e3, "x", {}), (3e6, "y", {}), (2e4, "x", {"hardness": 1e6})]
)
def test_load_that_seals_is_that_of_a_scan(load, direction, more):
    """From loads far below and above it; the scan labels the open nodes of a mirrored map by itself."""
    asked = {"direction": direction, "seal": True}
    found = asp.run(HEIGHT, {**RUBBER, **more}, length=EDGES, mean_pressure=load, leak=asked)
    seals = found["mean pressure that seals"]
    grid, solid = found.contact.grid, found.case.solid
    loads = np.geomspace(0.8, 1.25, 60) * seals.value
    sealed = []
    for each in loads:
        contact = asp.solve_contact(found.face.height, solid, grid, mean_pressure=each, **more)
        pieces, _ = ndimage.label(contact.pressure == 0)
        ends = (pieces[:, 0], pieces[:, -1]) if direction == "x" else (pieces[0], pieces[-1])
        sealed.append(not (set(ends[0]) & set(ends[1])) - {0})
    assert sealed == sorted(sealed)
    assert seals.value == pytest.approx(loads[sealed.index(True)], rel=0.02)
    assert {"the search", "discretisation"} >= {*seals.errors}
    assert "a mean pressure of" in found.verdict[0]


@pytest.mark.parametrize(("start", "seals"), [(1.0, 3.0), (1e-5, 3.0), (1e4, 3.0), (7.0, 7.0), (1.0, 1e3)])
def test_search_takes_few_contacts_from_any_load(start, seals):
    """Rising factors, then halves; no load seals a gap that is open just below the hardness."""
    asked = []
    load, low = _sealing_load(lambda load: asked.append(load) or load < seals, start, 2.0, 100.0)
    assert len(asked) <= 20
    if seals > 100:
        assert (load, low) == (np.inf, 100.0)
    else:
        assert load == pytest.approx(seals, rel=SEALING_ERROR)
        assert low < seals


def test_ridge_across_the_leak_seals_under_any_load():
    """Its nodes touch together: no load leaves the gap open."""
    height = np.zeros((16, 16))
    height[:, 6:10] = -1e-6  # the lower face of the indenter
    found = asp.run(
        height, {"young": 210e9, "poisson": 0.3}, length=1e-4, mean_pressure=1e8, leak={"seal": True}
    )
    assert "any: the first contact" in found["mean pressure that seals"].words
    assert "sealed along x" in found.verdict[0].lower()


@flows
def test_leakage_leads_and_is_per_width():
    answer = asp.run(HEIGHT, RUBBER, length=EDGES, mean_pressure=2e4, leak=LEAK)
    leakage, per_width = answer["leakage along x"], answer["leakage along x per width"]
    assert per_width.value == pytest.approx(leakage.value / EDGES[0])
    assert per_width.number().endswith("l/min per mm")
    factor, _ = per_width.scale()
    prefix = {"pl": 1e-12, "µl": 1e-6, "ml": 1e-3}[per_width.number().split()[1].split("/")[0]]
    assert factor == pytest.approx(prefix / 60)  # m²/s is l/s per mm
    assert "30 µm wide and 50 µm long" in leakage.text()
    assert answer.tiles[0] is leakage
    assert "pressure of the fluid" in [each.subject for each in answer.warnings if each.warns]
    again = film_flow(answer.contact, 0.03, 5e5)
    assert leakage.value == pytest.approx(again.flow_rate, rel=1e-8)  # from another start
    assert answer["pressure flow factor"].value == pytest.approx(again.flow_factor, rel=1e-8)
    pressure = answer.datasets["leak"]["film_pressure"].values
    np.testing.assert_allclose(pressure, again.pressure, atol=1e-3 * 5e5)


@flows
def test_film_and_constriction_are_fields_of_the_answer():
    """The film has the mean flux 1, and closes where the gap does; the close-up holds the constriction."""
    answer = asp.run(HEIGHT, RUBBER, length=EDGES, mean_pressure=2e4, leak=LEAK)
    film = answer.datasets["leak"]
    assert float(film["film_flux_x"].mean()) == pytest.approx(1, rel=1e-3)
    assert bool(np.isnan(film["film_pressure"].values[answer.contact.pressure > 0]).all())
    narrowest, close = answer["narrowest constriction along x"], answer.datasets["constriction"]
    at = {"close_up_y": narrowest.position.y, "close_up_x": narrowest.position.x}
    assert float(close["gap"].sel(at, method="nearest")) == narrowest.value
    pictures = {each.name: each for each in answer.case.leak.pictures(answer)}
    assert {*pictures} == {"constriction", "flow"}
    assert "along x, under the load (mean pressure 20 kPa)" in pictures["constriction"].caption


def test_resistance_of_an_electrical_contact():
    """The resistance is one over conductance and area, and Holm's of a circle of the nominal area."""
    gold = {"young": "78 GPa", "poisson": 0.42, "resistivity": 2.4e-8}
    answer = asp.run(HEIGHT, gold, gold, length=EDGES, force="20 mN", load_curve={"loads": ["5 mN"]})
    area = EDGES[0] * EDGES[1]
    expected = 1 / (answer.contact.conductance(4.8e-8) * area)
    resistance = answer["electrical contact resistance"]
    assert resistance.value == pytest.approx(expected)
    assert "Ω, on the nominal area of 1500 µm², without films" in resistance.text()
    around = answer["constriction of the nominal area"]
    assert around.value == pytest.approx(4.8e-8 / 4 / np.sqrt(area / np.pi))
    curve = answer.tables["curve"]
    np.testing.assert_allclose(curve["force_N"], [5e-3, 20e-3])
    assert curve["electrical_resistance_ohm"].iloc[-1] == pytest.approx(expected)
    assert curve["electrical_resistance_ohm"].is_monotonic_decreasing


def test_check_says_time_and_memory(folder, capsys):
    given = "--unit um --physical-size 30um 50um --young 10MPa --poisson 0.49 --mean-pressure 20kPa --check"
    assert main(["run", "shaft.npy", *given.split()]) == 0
    said = capsys.readouterr().out
    assert "1 map, 24 × 32 nodes, about " in said
    assert "s of one processor and 0.4 GB" in said
    assert not (folder / "shaft_run").exists()


def test_progress_has_the_remaining_time(monkeypatch, capsys):
    """Without a terminal a line tells what is done and left, and the stages never step back."""
    monkeypatch.setattr(progress_and_log, "SECONDS_BETWEEN_LINES", 0.0)
    parts = []
    with progress_and_log.ProgressBar("run map") as bar:

        def report(done, total):
            parts.append(done / total)
            bar(done, total)

        asp.run(HEIGHT, RUBBER, length=EDGES, mean_pressure=2e4, progress=report)
    assert parts == sorted(parts)
    assert parts[-1] == 1
    assert " s left" in capsys.readouterr().err


def test_a_number_and_its_unit_are_two_words():
    given = ["run", "m", "--physical-size", "30", "um", "50", "um", "--set", "body.young=7", "GPa"]
    joined = ["run", "m", "--physical-size", "30 um", "50 um", "--set", "body.young=7 GPa"]
    assert with_units([*given, "--points", "5"]) == [*joined, "--points", "5"]
    assert with_units(["run", "7", "m"]) == ["run", "7", "m"]  # names of maps


@pytest.mark.parametrize(
    ("text", "words"),
    [("0,3", "not a comma: 0.3"), ("60HRC", "about 697 HV on steel, 6.8 GPa"), ("80 HRC", "outside of the")],
)
def test_misread_pressures_get_a_sentence(text, words):
    assert words in misread(text, "pressure")
    with pytest.raises(asp.SettingsError, match=words):
        asp.Case(map="a.x3p", body={**RUBBER, "hardness": text}, load={"force": 1.0})


def test_info_names_options_that_run_takes(folder, capsys):
    height = 1e6 * HEIGHT
    height[3:9, 3:9] = -9999
    np.savetxt("map.txt", height)
    assert main(["info", "map.txt"]) == 0
    advised = capsys.readouterr().out.partition("look at")[2].partition("need")[0]
    assert "--set map.missing=" in advised
    assert "--missing:" not in advised


def test_section_through_the_largest_stress():
    contact = asp.solve_contact(HEIGHT, asp.Solid(1e7, 0.49), EDGES, mean_pressure=2e4)
    figure = asp.views.plot_section(contact, y="max")
    stress = asp.analyse_stress(contact.in_body("lower"), quantities=("von_mises",))
    of_stress = stress.isel(peak=stress["peak_quantity"].values == "von_mises")
    peak = of_stress.isel(peak=int(of_stress["peak_value"].values.argmax()))
    place = float(figure.axes[0].get_title(loc="left").split("=")[-1].split()[0])
    assert place == pytest.approx(float(peak["peak_y"]), abs=1.5 * EDGES[0] / 24)


@flows
def test_questions_are_answered_in_a_sentence():
    """Sealed, with the load that seals; the resistance with what it leaves out; sliding and slip."""
    given = {"length": EDGES, "leak": LEAK, "load_curve": {"loads": ["10 kPa"]}}
    answer = asp.run(HEIGHT, RUBBER, mean_pressure="1 MPa", **given)
    first, growth, *_ = answer.verdict
    assert first.startswith("Sealed along x: the contact closes the gap; a mean pressure of ")
    assert first.endswith(" closes the gap, and more than that of the fluid, 500 kPa, keeps it closed.")
    assert growth.startswith("From 10 kPa to 1 MPa the contact area fraction grows from ")
    assert [each.quantity for each in answer.tiles[:2]] == ["leakage along x", "mean pressure that seals"]
    metal = {"young": "100 GPa", "poisson": 0.3, "resistivity": 2e-8}
    whole = asp.run(HEIGHT, metal, metal, length=EDGES, force="1 mN", sliding={"friction": 0.2})
    resisted, *_, slid = whole.verdict
    assert "against a friction force of 200 µN on the map" in slid
    assert resisted.startswith("The contact spots resist the current with ")
    assert resisted.endswith("(Holm); films, oxides and the gap are left out.")
    partial = {"sliding": {"friction": 0.2}, "length": EDGES, "force": "1 mN"}
    for force, words in (("0.1 mN", "Under a tangential force of 100 µN"), ("1 mN", "The bodies slide")):
        slip = asp.run(HEIGHT, RUBBER, partial_slip={"tangential_force": force}, **partial)
        assert slip.verdict[0].startswith(words)
