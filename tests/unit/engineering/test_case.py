"""Cases as groups of settings: templates, materials by name, and everything wrong at once."""

import subprocess
import sys
from importlib.resources import files
from pathlib import Path

import jsonschema
import numpy as np
import pytest
import yaml

import asperity as asp
from asperity.cli.main import main
from asperity.cli.parser import COMMANDS, arguments
from asperity.engineering.case import Case
from asperity.engineering.case_file import case_text, load_case, read_case
from asperity.engineering.show.report import report
from asperity.engineering.templates import explanation, template, templates
from asperity.settings.model import SettingsError, described, entries

STEEL = {"young": "210 GPa", "poisson": 0.3}
PLAIN = {"map": "a.x3p", "body": STEEL, "load": {"mean_pressure": "50 MPa"}}


def test_counter_body_of_which_only_the_map_is_given_is_rigid():
    case = Case.read(PLAIN | {"counter_body": {"map": {"file": "b.x3p"}}})
    assert list(case.bodies) == ["lower"]
    assert isinstance(case.solid, asp.Solid)
    with pytest.raises(SettingsError, match=r"counter_body\.young: missing"):
        Case.read(PLAIN | {"counter_body": {"map": {"file": "b.x3p"}, "hardness": "7 GPa"}})


def test_numbers_of_python_are_written_with_units(tmp_path):
    body = asp.Body(young=np.float32(2**37), poisson=0.3)
    case = Case(map="a.x3p", body=body, load={"force": 3}, load_curve={"loads": [1, np.float64(2.5)]})
    written = yaml.safe_load(case_text(case, tmp_path))
    assert written["body"]["young"] == "137.438953472 GPa"
    assert written["load_curve"]["loads"] == ["1 N", "2.5 N"]
    assert Case.read(case.written()).load_curve.path(case) == [1.0, 2.5, 3.0]


def keys_of(content, prefix=""):
    """Dotted keys of a case file."""
    for key, value in content.items():
        yield f"{prefix}{key}"
        if isinstance(value, dict):
            yield from keys_of(value, f"{prefix}{key}.")


@pytest.mark.parametrize("name", templates())
def test_template_is_a_case_whose_keys_are_explained(name):
    content = yaml.safe_load(template(name))
    listed = content["map"]["file"]
    paths = listed if isinstance(listed, list) else [listed]
    assert all(
        files("asperity.engineering").joinpath("maps", path.rpartition("/")[2]).is_file() for path in paths
    )
    Case.read(content | {"map": content["map"] | {"file": paths[0]}})
    for key in keys_of(content):
        assert explanation(key).startswith(f"{key}: ")
    comments = [line for line in template(name).splitlines() if line.lstrip().startswith("#")]
    assert len(comments) > 10
    assert max(map(len, comments)) <= 110


@pytest.mark.parametrize("name", templates())
def test_template_fulfils_the_json_schema(name):
    jsonschema.Draft202012Validator(described(Case)).validate(yaml.safe_load(template(name)))


def test_every_setting_is_explained():
    for key, entry in entries(described(Case)):
        assert entry["description"].split()[0] in explanation(key)
    with pytest.raises(ValueError, match=r"leak\.viscosty: unknown key; did you mean viscosity\?"):
        explanation("leak.viscosty")


@pytest.mark.parametrize("name", templates())
def test_template_is_accepted_as_it_is(name, tmp_path, monkeypatch, capsys):
    """`test_answer_folder` answers it, or the case of the documentation of the same name."""
    monkeypatch.chdir(tmp_path)
    assert main(["case", name]) == 0
    Path("case.yaml").write_text(capsys.readouterr().out, encoding="utf-8")
    assert main(["run", "case.yaml", "--check"]) == 0


def refusal(**groups):
    """Problems of a case by key."""
    with pytest.raises(SettingsError) as caught:
        Case.read(PLAIN | groups)
    return dict(caught.value.found)


def test_all_problems_are_found_at_once():
    found = refusal(
        body={"young": "210", "poisson": 0.7, "yeild_stress": "1 GPa"},
        load={"mean_pressure": "50 MPa", "force": "1 N"},
        lek={},
        leak={"direction": "z"},
        fields=["von_mises", "von_mises"],
    )
    assert found["body.young"].startswith(" = '210': a pressure > 0 with its unit")
    assert found["body.poisson"] == " = 0.7: a number > -1 and ≤ 0.5 is needed"
    assert found["body.yeild_stress"] == ": unknown key; did you mean yield_stress?"
    assert found[
        "load.mean_pressure, hertz_pressure, force, normal_approach, contact_area_fraction"
    ].endswith("exactly one of them is needed, mean_pressure and force given")
    assert found["lek"] == ": unknown key; did you mean leak?"
    assert found["leak.direction"] == " = 'z': x or y is needed"
    assert "distinct items" in found["fields"]
    assert len(found) == 7


STEEL_MAP = {"map": "a.x3p", "body": STEEL}
FILM, LOAD = {"film": {"lambda_ration": 1}}, {"load": {"mean_pressure": "50 MPa"}}


@pytest.mark.parametrize(
    ("groups", "keys"),
    [
        (  # of questions, while whole groups are missing
            {"cycles": {}, "leak": {"viscosity": "1 mPa s"}} | FILM,
            {"map", "body", "load", "film.lambda_ration", "leak.viscosity", "cycles"},
        ),
        (
            STEEL_MAP | LOAD | FILM | {"load_curve": {"loads": ["1 MPa"]}},
            {"film.lambda_ration", "load_curve"},
        ),
        (  # below a material that is not known, and in the group of a wrong key
            {"map": {"file": "a", "form": "cylinder"}, "body": {"material": "x", "poisson": 9}} | LOAD,
            {"body.material", "body.poisson", "map.form"},
        ),
        (  # not what the values in place of the others cause
            {"map": "a", "body": {"young": "1"}, "load_curve": {"loads": ["1 N"]}, "yielding": {}},
            {"body.young", "body.poisson", "load", "yielding"},
        ),
        (  # not that the bending limit needs the other one, which is given
            STEEL_MAP | {"body": STEEL | {"fatigue_torsion": "500 MPa", "fatigue_bending": "2 GPa"}} | LOAD,
            {"body.fatigue_torsion"},
        ),
        (
            STEEL_MAP | LOAD | {"sliding": {"direction": "x"}, "cycles": {"shifts": 8, "slide_to_roll": 0.2}},
            {"cycles.shifts"},
        ),
    ],
)
def test_problems_behind_others_are_found_with_them(groups, keys):
    with pytest.raises(SettingsError) as caught:
        read_case(groups)
    assert {each.key for each in caught.value.found} == keys


@pytest.mark.parametrize(
    ("groups", "key", "text"),
    [
        ({"sliding": {"direction": "nan"}}, "sliding.direction", "x, y or an angle in degrees"),
        ({"yielding": {}}, "yielding", "needs the yield stress of a body"),
        ({"cycles": {}}, "cycles", "needs shifts, or fatigue limits"),
        ({"conduction": {}}, "conduction", "a counter_body is needed"),
        ({"load": {"hertz_pressure": "1 GPa"}}, "load.hertz_pressure", "needs radius_x"),
        ({"load": {"mean_pressure": "1e70 GPa"}}, "load.mean_pressure", "a pressure > 0"),
        ({"body": STEEL | {"map": "b.x3p"}}, "body.map", "the map of the body is the group `map`"),
        ({"body": STEEL | {"residual_stress": "1 MPa"}}, "body.residual_stress", "needs fatigue_torsion"),
        ({"body": {"material": "100Cr7"}}, "body.material", "did you mean 100Cr6?"),
        ({"map": {"file": "a.x3p", "form": "sphere"}}, "map.form", "needs map.radius"),
        (
            {
                "map": {"file": "a", "periodic": "none"},
                "body": STEEL | {"layers": [STEEL | {"thickness": "1 um"}]},
            },
            "body.layers",
            "not accepted with map.periodic = none",
        ),
    ],
)
def test_setting_without_what_it_needs_is_refused(groups, key, text):
    assert text in refusal(**groups)[key]


def test_material_by_name_with_other_constants():
    body = asp.Body(material="52100", poisson=0.28)
    known = asp.material("100Cr6").constants
    assert (body.young, body.poisson) == (210e9, 0.28)
    assert set(body.from_material) == known.keys() - {"poisson", "fatigue_torsion", "fatigue_bending"}
    coated = asp.Body(material="100Cr6", layers=[{"thickness": 1e-6, **STEEL}])
    assert coated.hardness is None  # the hardness of the material does not hold for the coated body
    surface = asp.HeightMap(1e-9 * np.random.default_rng(1).normal(size=(16, 16)), (16e-6, 16e-6), name="a")
    answer = asp.run(surface, asp.Body(material="100Cr6", hardness="inf"), mean_pressure=20e6)
    page = report(answer, drawn=[])
    assert f"young {known['young'].value} ({known['young'].source[:20]}" in page
    assert "hardness 7" not in page
    assert answer.case.written()["body"] == {"material": "100Cr6", "hardness": "inf"}


def test_own_materials_beside_the_case_are_known(tmp_path):
    (tmp_path / "materials.yaml").write_text(
        "my steel: {young: 205 GPa, poisson: 0.29}\n100Cr6: {young: 208 GPa, poisson: 0.3}\n"
    )
    for name, young in (("my steel", 205e9), ("100Cr6", 208e9), ("M50", asp.Body(material="M50").young)):
        (tmp_path / "case.yaml").write_text(
            f"map: a.x3p\nbody: {{material: {name}}}\nload: {{mean_pressure: 1 MPa}}\n"
        )
        assert Case.read(load_case(tmp_path / "case.yaml")).body.young == young
    (tmp_path / "materials.yaml").write_text("my steel: {young: 205 GPa, poison: 0.29}\n")
    with pytest.raises(ValueError, match=r"my steel\.poison: unknown key; did you mean poisson\?"):
        Case.read(load_case(tmp_path / "case.yaml"))


def test_flags_of_a_run_are_few():
    """A new flag takes the place of another one; every key has `--set`."""
    entry = COMMANDS["run"]
    flags = {name for each in (entry, *entry["groups"]) for name in arguments(each) if name.startswith("--")}
    assert 15 <= len(flags) <= 33


def test_unknown_flag_is_refused_before_libraries():
    code = (
        "import sys; from asperity.cli.main import main\n"
        "try: main(['run', 'a.x3p', '--pressure', '1 MPa'])\n"
        "except SystemExit as ended: sys.exit(ended.code if 'numpy' not in sys.modules else 9)"
    )
    found = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert found.returncode == 2
    assert (
        found.stderr
        == "asperity: --pressure: not accepted; did you mean --mean-pressure? (see asperity run --help)\n"
    )
