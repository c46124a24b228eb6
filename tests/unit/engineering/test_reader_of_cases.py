"""One reader of cases: files, the form and Python give the same case, and what is written is what is read."""

import copy
from pathlib import Path

import pytest
import yaml

import asperity as asp
from asperity.app import form
from asperity.core.errors import InputError
from asperity.engineering.case import Case
from asperity.engineering.case_file import (
    CHECKSUMS,
    OUT,
    at,
    case_of_map,
    case_text,
    changed_files,
    leaves,
    load_case,
    names_of_maps,
    put,
)
from asperity.engineering.templates import hint, template, templates
from asperity.settings.model import SettingsError

STEEL = {"young": "210 GPa", "poisson": 0.3}
PLAIN = {"map": "a.x3p", "body": STEEL, "load": {"mean_pressure": "50 MPa"}}
FILES = sorted((Path(__file__).parents[3] / "docs" / "cases").glob("*.yaml"))
SOURCES = [*FILES, *templates()]


def content_of(source, folder):
    """The content of a case file of the documentation, or of a template."""
    if not isinstance(source, Path):
        source, name = folder / "case.yaml", source
        source.write_text(template(name), encoding="utf-8")
    return load_case(source)


def groups_of(content):
    """The groups of the case of the first map."""
    first = case_of_map(content, 0)
    return {key: group for key, group in first.items() if key not in (OUT, CHECKSUMS)}


@pytest.mark.parametrize("source", SOURCES, ids=lambda each: getattr(each, "stem", each))
def test_form_loses_nothing(source, tmp_path):
    content = content_of(source, tmp_path)
    values = form.values_of(content)
    again = form.content_of(values)
    assert Case.read(groups_of(again)) == Case.read(groups_of(content))
    for keys in (("map", "file"), ("counter_body", "map", "file")):
        assert at(again, keys) == at(content, keys)
    assert form.content_of(form.values_of(again)) == again


FATIGUE = STEEL | {"fatigue_torsion": "300 MPa", "fatigue_bending": "480 MPa"}
OTHERS = {
    "text": {"map": {"file": "a.txt", "physical_size": ["96 um", 80], "unit": "um", "missing": -9999.0}},
    "bodies": {
        "body": {"material": "100Cr6", "hardness": "inf", "layers": [{"thickness": "2 um", **STEEL}]},
        "counter_body": {
            "layers": [{"thickness": "5 um", **STEEL}],
            "base": "bonded",
            "map": {"file": "b.x3p", "turned_about": "x", "shift": ["10 um", "-4 um"], "detrend": "none"},
        },
    },
    "rigid": {"counter_body": {"map": {"file": "b.x3p"}}},
    "sticking": {"adhesion": {"work": "0.05 J/m^2", "range": "fit", "law": "maugis-dugdale"}},
    "residual stress": {
        "body": FATIGUE | {"residual_stress": "-400 MPa"},
        "cycles": {"fatigue_scatter": 0.1, "fatigue_volume": "100 mm3"},
    },
    "table of residual stress": {
        "body": FATIGUE | {"residual_stress": {"depth": ["5 um", "50 um"], "stress": ["-600 MPa", "0 MPa"]}},
    },
    "asked without settings": {"sensitivity": {}, "film": {"load_fraction": 0.5}},
    "tolerances": {"sensitivity": {"tolerances": {"body.young": 0.05}}},
    "layer": {"body": {"layers": [STEEL | {"thickness": "3 um"}], "base": "frictionless"}},
    "materials": {"body": {"material": "mine"}, "materials": {"mine": dict(STEEL)}},
    "fields": {"fields": ["von_mises", "xz"], "sliding": {"friction": 0.1, "direction": 30}},
}
"""Groups that no file of the documentation has."""


@pytest.mark.parametrize("source", [*SOURCES, *OTHERS], ids=lambda each: getattr(each, "stem", each))
def test_written_file_is_read_as_the_same_case(source, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    content = PLAIN | OTHERS[source] if source in OTHERS else groups_of(content_of(source, tmp_path))
    case = Case.read(content)
    path = Path("inside/again.yaml")
    path.parent.mkdir()
    path.write_text(case_text(case, path.parent), encoding="utf-8")
    again = Case.read(groups_of(load_case(path)))
    assert case_text(again, path.parent) == path.read_text(encoding="utf-8")
    names = [each.file for each in (again.map, again.counter_map) if each is not None]
    assert [Path(name).resolve() for name in names] == [
        Path(each.file).resolve() for each in (case.map, case.counter_map) if each is not None
    ]
    assert again.with_maps(case.map, case.counter_map) == Case.read(case.written()) == case
    assert again.questions.keys() == case.questions.keys()


@pytest.mark.parametrize("name", OTHERS)
def test_form_keeps_what_no_example_has(name):
    content = {**PLAIN, "map": {"file": "a.x3p"}, **OTHERS[name]}
    again = form.content_of(form.values_of(content))
    assert Case.read(again) == Case.read(content)
    assert dict(leaves(again)).keys() == dict(leaves(content)).keys()


def test_form_keeps_lists_of_two_maps():
    maps, counters = ["a.x3p", "b.x3p"], ["c, d.x3p", "e.x3p"]
    content = {**PLAIN, "map": {"file": maps}, "counter_body": {"map": {"file": counters}}, "sample": {}}
    again = form.content_of(form.values_of(content))
    assert again == content
    assert case_of_map(again, 1)["counter_body"]["map"]["file"] == "e.x3p"


def test_page_refuses_what_run_refuses(tmp_path):
    (tmp_path / "a.x3p").write_bytes(b"heights")
    wrong = {
        "sliding.frction: unknown key; did you mean friction": {"sliding": {"frction": 0.3}},
        "exactly one of them is needed, mean_pressure and force": {
            "load": {"mean_pressure": "1 MPa", "force": "1 N"}
        },
        "body.poisson = '0.3': a number": {"body": {"young": "1 GPa", "poisson": "0.3"}},
        "checksums.map: .*a.x3p has changed since": {"checksums": {"map": 64 * "0"}},
    }
    for message, groups in wrong.items():
        (tmp_path / "case.yaml").write_text(yaml.safe_dump(PLAIN | groups), encoding="utf-8")
        with pytest.raises(SettingsError, match=message):
            form.values_of(load_case(tmp_path / "case.yaml"))
    form.values_of({"map": {"file": "a.x3p"}})  # what is missing is asked for


def test_names_are_relative_to_the_case_file(tmp_path, monkeypatch):
    """The folder has the name of a pattern; another map of the same name lies in the working folder."""
    folder = tmp_path / "run[1]"
    folder.mkdir()
    for path in (folder / "s_1.txt", folder / "s_2.txt", tmp_path / "lapped.txt", folder / "lapped.txt"):
        path.write_text("1 2\n")
    monkeypatch.chdir(tmp_path)
    text = "map: s_*.txt\ncounter_body: {map: lapped.txt}\nmaterials: own.yaml\nout: there\n"
    (folder / "case.yaml").write_text(text)
    content = load_case("run[1]/case.yaml")
    assert content["map"]["file"] == ["run[1]/s_1.txt", "run[1]/s_2.txt"]
    assert content["counter_body"]["map"]["file"] == "run[1]/lapped.txt"
    assert (content["materials"], content["out"]) == ("run[1]/own.yaml", "run[1]/there")


STRANGE = 5, True, None, " ", "a\0b", "\ud800", [], [[1]], {"a": 1}, {1: 2}, 10**400


def keys_of_a_case():
    """Every key of a case and of its groups, once for each group, as far as form and file have it."""
    keys = {key.rpartition(".")[0] for key in form.settings()} | form.settings().keys()
    return sorted({*keys, "body.layers", "body.layers.0", "out", "checksums", "checksums.map"} - {""})


@pytest.mark.parametrize("key", keys_of_a_case())
def test_value_of_any_type_is_refused_in_one_line(key, tmp_path):
    """A case file with a strange value is read, or refused with the key; nothing else is raised."""
    for value in STRANGE:
        content = copy.deepcopy({**PLAIN, "map": {"file": "a.x3p"}})
        put(content, key.split("."), value)
        path = tmp_path / "case.yaml"
        try:
            path.write_text(yaml.safe_dump(content, allow_unicode=False), encoding="utf-8")
        except ValueError:
            continue
        try:
            read = load_case(path)
            Case.read(groups_of(read))
            form.values_of(read)
        except InputError as error:
            lines = error.lines
            assert all(line and line.isprintable() for line in lines), (value, lines)
            known = (key.split(".")[0], "YAML", "a tolerance is accepted for")
            assert any(word in line for line in lines for word in known), (value, lines)


def residual(stress):
    return {"body": STEEL | {"residual_stress": stress}}


@pytest.mark.parametrize(
    ("groups", "message"),
    [
        (
            residual({"depth": ["0 um"], "stress": ["1 Pa"], "deep": 1}),
            "^body.residual_stress.deep: unknown key",
        ),
        (residual([1]), r"body.residual_stress = \[1\]: a pressure with its unit"),
        ({"map": 5}, "map.file = 5: the name of a file is needed"),
        ({"map": "a\0b"}, r"map.file = 'a\\x00b': the name of a file is needed"),
        ({"counter_body": {"map": 5}}, "counter_body.map.file = 5: the name of a file is needed"),
        ({"out": {"a": 1}}, "out = {'a': 1}: the name of a folder is needed"),
        ({"checksums": 5}, "checksums = 5: a group of keys is needed"),
        ({"sensitivity": 5, "body": {"young": "1 GPa ± 5 %", "poisson": 0.3}}, "sensitivity = 5: a group"),
        ({"materials": "none.yaml"}, "materials = '.*: no such file"),
        ({"materials": {"mine": {"yong": 1}}}, "materials.mine.yong: unknown key; did you mean young"),
        ({"lambda": 1}, "lambda: unknown key; did you mean film.lambda_ratio"),
        ({"load": {"mean_pressure": "50 mPa"}}, "load.mean_pressure = '50 mPa': .*did you mean 50 MPa"),
        ({"map": {"file": "a", "crop": "5 Mm"}}, "map.crop = '5 Mm': .*"),
    ],
)
def test_refusal_names_key_and_accepted_form(groups, message, tmp_path):
    (tmp_path / "case.yaml").write_text(yaml.safe_dump(PLAIN | groups), encoding="utf-8")
    with pytest.raises(InputError, match=message) as caught:
        Case.read(groups_of(load_case(tmp_path / "case.yaml")))
    assert len(caught.value.lines) == 1


def test_empty_keys_of_the_file_are_not_given(tmp_path):
    (tmp_path / "case.yaml").write_text("map: a.x3p\nchecksums:\nout:\n")
    assert load_case(tmp_path / "case.yaml").keys() == {"map"}


def test_keys_reach_into_lists():
    content = {}
    put(content, ["body", "layers", "0", "thickness"], "2 um")
    put(content, ["body", "layers", "0", "young"], "1 GPa")
    assert content == {"body": {"layers": [{"thickness": "2 um", "young": "1 GPa"}]}}
    assert at(content, ["body", "layers", "0", "young"]) == "1 GPa"
    assert at(content, ["body", "layers", "1", "young"]) is None
    put(content, ["body", "layers", "4", "young"], "1 GPa")
    with pytest.raises(SettingsError, match=r"body\.layers\.1 = None"):
        Case.read(
            PLAIN | {"body": STEEL | {"layers": [content["body"]["layers"][0] | {"poisson": 0.3}, None]}}
        )


def own(folder, young):
    """A case file beside a table with a material of the user, and one that it overrides."""
    (folder / "materials.yaml").write_text(
        f"mine: {{young: {young} GPa, poisson: 0.3, yield_stress: 1 GPa}}\n"
        "M50: {young: 205 GPa, poisson: 0.29}\n"
    )
    text = (
        "map: a.x3p\nbody: {material: mine}\ncounter_body: {material: M50}\nload: {mean_pressure: 50 MPa}\n"
    )
    (folder / "case.yaml").write_text(text)
    return Case.read(load_case(folder / "case.yaml"))


def test_own_materials_are_part_of_the_case(tmp_path):
    case = own(tmp_path, 70)
    assert case.body.from_material["young"] == ("70 GPa", None, "materials.yaml")
    (tmp_path / "answer").mkdir()
    written = tmp_path / "answer" / "case.yaml"
    written.write_text(case_text(case, written.parent), encoding="utf-8")
    assert own(tmp_path, 210) != case
    content = load_case(written)  # with its constants, though the table has others now
    assert Case.read(content).body.young == 70e9
    assert Case.read(content).counter_body.young == 205e9
    changed = [problem.key for problem in changed_files(content)]
    assert changed == ["materials.mine.sha256", "materials.M50.sha256"]
    (tmp_path / "materials.yaml").unlink()
    again = Case.read(load_case(written))
    assert {name: each.constants for name, each in again.materials.items()} == {
        name: each.constants for name, each in case.materials.items()
    }


def test_own_material_is_known_later(tmp_path):
    """The constants with which a body was made stay when other settings of it are replaced."""
    case = own(tmp_path, 70)
    (tmp_path / "materials.yaml").unlink()
    for body in (case.body, case.body.replaced(hardness=1e9), case.replaced(body=case.body.replaced()).body):
        assert (body.young, body.yield_stress) == (70e9, 1e9)
        assert body.from_material["young"].source == "materials.yaml"
    assert case.counter_body.replaced(hardness=1e9).young == 205e9  # not that of the table, 214 GPa
    assert case.under(mean_pressure=1e6).body.young == 70e9
    layered = Case.read(
        PLAIN
        | {
            "materials": {"mine": STEEL | {"hardness": "3 GPa"}},
            "body": {"layers": [{"material": "mine", "thickness": "3 um"}], "base": "bonded"},
        }
    )
    again = layered.body.replaced(conductivity=5.0)
    assert (again.material, again.young, again.hardness) == ("mine", 210e9, 3e9)
    assert (layered.under(mean_pressure=1e6).body.young, again.written().keys()) == (
        210e9,
        {"layers", "base", "conductivity"},
    )


def test_folders_of_maps_have_different_names():
    names = names_of_maps(["a/steel.npy", "a/steel.txt", "b/steel.x3p", "b/rough.x3p"])
    assert names == ["steel.npy", "steel.txt", "b_steel", "rough"]


def test_solid_of_the_library_is_a_body():
    coated = asp.Solid(4e11, 0.25, 2e-6, base=asp.Solid(2.1e11, 0.3))
    for solid in (asp.Solid(1e9, 0.3), asp.Solid(1e9, 0.3, 1e-6, "frictionless"), coated):
        case = Case(map="a.x3p", body=solid, load={"mean_pressure": 1e6})
        assert case.solid == solid
        assert case.with_maps(case.map, None).replaced(body=case.body.replaced()).solid == solid


@pytest.mark.parametrize(
    ("word", "key"),
    [
        ("--film", "film.lambda_ratio"),
        ("--lambda", "film.lambda_ratio"),
        ("--run-in", "running_in.loads"),
        ("--fatigue", "body.fatigue_torsion"),
        ("--coating", "body.layers.0.thickness"),
        ("leak", "leak.pressure_difference"),
        ("--hertz-pressure", "load.hertz_pressure"),
    ],
)
def test_hint_names_key_and_template(word, key):
    found, how = hint(word)
    assert found == key
    assert how.startswith(", given by --set or in a case file (asperity case ")
    name = how.removesuffix(")").rpartition(" ")[2]
    assert key in dict(leaves(templates()[name]["case"]))


def test_hint_names_a_key_before_keys_that_begin_with_the_word():
    assert hint("--seal") == ("leak.seal", ", given by --set or in a case file (asperity case seal)")
    assert [hint(word)[0] for word in ("--form", "--roller")] == ["map.form"] * 2


def test_hint_on_other_words_is_empty():
    assert hint("--compare") == hint("-x") == hint("--nonsense") == ("", "")
