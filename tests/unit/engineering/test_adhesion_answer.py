"""Answers with adhesion: records, the path, files, the certificate computed anew, and what is refused."""

from dataclasses import replace

import numpy as np
import pytest
from samples import leave_pictures_out, refuses
from test_engineering import a_rough_map

import asperity as asp
from asperity import Case, run
from asperity.cli.main import main
from asperity.engineering.drawing import framed_part
from asperity.engineering.show.pictures import pictures

RUBBER = {"young": "5 MPa", "poisson": 0.49}


@pytest.fixture(scope="module")
def sticking(tmp_path_factory):
    folder = tmp_path_factory.mktemp("adhesion") / "answer"
    answer = run(a_rough_map(), RUBBER, mean_pressure=5e4, adhesion={"work": "50 mJ/m^2", "steps": 8})
    with pytest.MonkeyPatch.context() as patch:
        leave_pictures_out(patch)
        return answer, folder, {path.name for path in answer.write(folder)}


def test_path_gives_pull_off_and_lost_energy(sticking):
    answer, path = sticking[0], sticking[0].tables["adhesion"]
    forces, approaches = path["force_N"].to_numpy(), path["normal_approach_m"].to_numpy()
    assert answer["pull-off force"].value >= -forces[8:].min() > 0
    assert "at twice the range" in answer["pull-off force"].note
    lost = np.trapezoid(forces, approaches)
    assert answer["dissipated energy"].value == pytest.approx(max(lost, 0), rel=1e-9)
    assert answer["maximum attraction"].value * answer["range of the attraction"].value == pytest.approx(0.05)
    assert answer["cohesive zone"].value == pytest.approx(4 * max(answer.face.grid.spacing))
    assert path["contact_area_fraction"].iloc[-1] == 0
    assert answer["stability"].value > 0
    assert ("sticks" in answer.verdict[0]) == (answer["criterion of stickiness"].value < 1)


def test_unstable_contacts_of_the_path_are_warned_of(sticking, monkeypatch):
    assert "unstable contact" not in [each.subject for each in sticking[0].warnings]

    def solve(*given, **more):  # contacts that pull are unstable
        contact = asp.solve_contact(*given, **more)
        stability = -0.06 if contact.force < 0 else contact.certificate.stability
        return replace(contact, certificate=replace(contact.certificate, stability=stability))

    monkeypatch.setattr("asperity.engineering.questions.adhesion_path.solve_contact", solve)
    answer = run(a_rough_map(), RUBBER, mean_pressure=5e4, adhesion={"work": "50 mJ/m^2", "steps": 8})
    text = next(each.text for each in answer.warnings if each.subject == "unstable contact")
    assert "stability down to -0.06): of the path, " in text


def test_opened_answer_with_adhesion_is_the_same(sticking, capsys):
    answer, folder, names = sticking
    assert "adhesion.csv" in names
    assert "adhesion" in {each.name for each in pictures(answer)}
    again = asp.open_answer(folder).contact
    np.testing.assert_array_equal(again.touching, answer.contact.touching)
    np.testing.assert_array_equal(again.attraction, answer.contact.attraction)
    assert main(["verify", str(folder)]) == 0
    assert "it is stationary, its conditions" in capsys.readouterr().out


def test_approach_may_pull():
    answer = run(a_rough_map(), RUBBER, normal_approach=5e-9, adhesion={"work": 0.05, "steps": 4})
    assert answer["force"].value < 0
    assert answer["mean pressure"].value < 0


def test_part_of_the_map_is_framed_where_all_spots_are_pulled():
    height = asp.self_affine((24, 24), 0.8, 5e-5, 2e-5, rms_height=1e-7, seed=1, length=1e-4)
    options = {"length": 1e-4, "normal_approach": 1e-8}
    answer = run(height, {"young": 2e6, "poisson": 0.49}, adhesion={"work": 0.1, "steps": 4}, **options)
    assert (answer.tables["contact_spots"]["load_N"] < 0).all()
    assert framed_part(answer, "von_mises") is not None


def test_a_load_just_below_the_hardness_is_refused_with_a_remedy():
    surface = asp.HeightMap(
        asp.self_affine((16, 16), 0.8, 4e-5, 1e-5, 3e-7, seed=1, length=8e-5), (8e-5, 8e-5)
    )
    soft = {"young": 3e6, "poisson": 0.49, "hardness": 5.05e4}
    with pytest.raises(
        asp.SettingsError, match=r"adhesion: .* beyond full contact, .*a higher hardness is needed"
    ):
        asp.run(surface, soft, load={"mean_pressure": 5e4}, adhesion={"work": 0.05, "steps": 4})


def case_of(body=RUBBER, load=None, work="50 mJ/m^2", **groups):
    known = {"map": "a.x3p", "load": load or {"force": "2 N"}, "adhesion": {"work": work}, "body": body}
    return lambda: Case.read(known | groups)


FAR, HERTZ = {"work": "1 J/m^2", "range": "far"}, {"hertz_pressure": "1 MPa", "radius_x": "9 mm"}
HARD = RUBBER | {"hardness": "5 MPa"}


test_bad_cases = refuses(
    (case_of(work="50 mPa"), "adhesion.work = '50 mPa': a work of adhesion > 0 with its unit"),
    (case_of(adhesion=FAR), "adhesion.range = 'far': a length > 0 .* or fit is"),
    (case_of(load={"contact_area_fraction": 0.1}), "load.contact_area_fraction: a pressure, a force or an a"),
    (case_of(load=HERTZ), "load.radius_x: not accepted with adhesion"),
    (case_of(sliding={"friction": 0.3}), "sliding: not accepted with adhesion"),
    (case_of(film={"load_fraction": 0.3}), "film: not accepted with adhesion"),
    (case_of(load_curve={"loads": ["1 N"]}), "load_curve: not accepted with adhesion"),
    (case_of(leak={"seal": True}), "leak.seal: not accepted with adhesion"),
    (case_of(HARD, running_in={"loads": 1}), "running_in: not accepted with adhesion"),
    (case_of(RUBBER | {"fatigue_torsion": "3 MPa", "fatigue_bending": "4 MPa"}), "cycles: not accepted with"),
    (
        lambda: run(a_rough_map(), RUBBER, force=1e-3, adhesion={"work": 0.05, "range": "1 nm"}),
        "adhesion.range = .*: nodes at most d/2 apart are needed in the cohesive zone",
    ),
)


def test_partial_slip_is_refused_with_adhesion(sticking):
    with pytest.raises(ValueError, match="adhesion: a contact without adhesion is needed"):
        asp.contact.partial_slip(sticking[0].contact, 0.3, tangential_force=1e-6)
