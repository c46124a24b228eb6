"""Files that are made from pyproject.toml and the settings are current."""

import runpy
import shutil

import jsonschema
import pytest
import yaml
from project import ROOT, run

import asperity

MADE = runpy.run_path(str(ROOT / "workflow/metadata.py"))


def test_files_are_current():
    readme = (ROOT / "workflow/README.md").read_text(encoding="utf-8")
    assert (ROOT / "workflow/envs/asperity.yaml").read_text(encoding="utf-8") == MADE["environment"]()
    assert readme.endswith(f"{MADE['MARK']}\n{MADE['parameters']()}\n{MADE['diagram']()}")
    schema = (ROOT / "workflow/schemas/config.schema.yaml").read_text(encoding="utf-8")
    assert schema == MADE["config_schema"]()
    for name, made in (
        ("codemeta.json", "codemeta"),
        (".zenodo.json", "zenodo"),
        ("pyproject.toml", "pyproject"),
    ):
        assert (ROOT / name).read_text(encoding="utf-8") == MADE[made]()


def test_citation_repeats_version_and_project():
    citation, project = yaml.safe_load((ROOT / "CITATION.cff").read_text(encoding="utf-8")), MADE["project"]()
    assert citation["version"] == asperity.__version__
    assert citation["license"] == project["license"]


def test_schema_accepts_the_test_study_and_no_wrong_one():
    """As a program sees it that knows the standard alone."""
    validator = jsonschema.Draft202012Validator(yaml.safe_load(MADE["config_schema"]()))
    validator.check_schema(validator.schema)
    config = yaml.safe_load((ROOT / ".test/config/config.yaml").read_text(encoding="utf-8"))
    validator.validate(config)
    for wrong in ({"seeds": []}, {"layer": {"poisson": 0.6}}, {"unknown": 1}):
        with pytest.raises(jsonschema.ValidationError):
            validator.validate(config | wrong)


def keywords(schema):
    """Keywords in all places of a JSON Schema where the standard takes a schema."""
    yield from schema
    for key, below in schema.items():
        if key == "properties":
            below = list(below.values())
        elif key not in ("items", "anyOf", "additionalProperties", "propertyNames"):
            continue
        for each in below if isinstance(below, list) else [below]:
            if isinstance(each, dict):
                yield from keywords(each)


def test_schema_has_only_standard_keywords():
    """All of them stand in the metaschema of draft 7, but for the items of a pair."""
    standard = jsonschema.Draft7Validator.META_SCHEMA["properties"]
    assert {*keywords(yaml.safe_load(MADE["config_schema"]()))} <= standard.keys() | {"prefixItems"}


def test_table_gives_every_default():
    """The settings without one have to be given."""
    rows = [[cell.strip() for cell in row.split(" | ")] for row in MADE["parameters"]().splitlines()[2:]]
    without = {row[0].strip("| `").rpartition(".")[2] for row in rows if not row[2]}
    assert without == {"hurst", "rms_height", "wavelength_long", "wavelength_short", "file"}
    assert {"seeds", "studies"} < {row[0].strip("| `") for row in rows}


def test_address_is_one_field(tmp_path, monkeypatch):
    """In every file that names it, after another one is given."""
    shutil.copytree(ROOT / "workflow", tmp_path / "workflow")
    (tmp_path / "docs").mkdir()
    shutil.copy(ROOT / "docs/make_tables.py", tmp_path / "docs")
    old = MADE["project"]()["urls"]["Repository"]
    named = run(ROOT, "git", "grep", "-lF", old).stdout.split()  # empty where git has no checkout
    assert set(named) <= {*MADE["ADDRESSED"], "codemeta.json"}
    for name in MADE["ADDRESSED"]:
        assert old in (ROOT / name).read_text(encoding="utf-8"), name
        (tmp_path / name).parent.mkdir(exist_ok=True)
        shutil.copy(ROOT / name, tmp_path / name)
    copied = runpy.run_path(str(tmp_path / "workflow/metadata.py"))
    monkeypatch.setitem(copied["main"].__globals__, "diagram", str)  # takes seconds
    monkeypatch.setattr("sys.argv", ["metadata.py", "--address", "https://github.com/one/asperity/"])
    copied["main"]()
    for name in (*MADE["ADDRESSED"], "codemeta.json"):
        text = (tmp_path / name).read_text(encoding="utf-8")
        assert "https://github.com/one/asperity" in text
        assert old not in text
