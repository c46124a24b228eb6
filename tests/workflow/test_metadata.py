"""Files that are made from pyproject.toml and the schema of the settings are current."""

import runpy
import shutil

import jsonschema
import pytest
import yaml
from project import ROOT, run

MADE = runpy.run_path(str(ROOT / "workflow/metadata.py"))


def test_files_are_current():
    readme = (ROOT / "workflow/README.md").read_text(encoding="utf-8")
    assert (ROOT / "workflow/envs/asperity.yaml").read_text(encoding="utf-8") == MADE["environment"]()
    assert readme.endswith(f"{MADE['MARK']}\n{MADE['parameters']()}\n{MADE['diagram']()}")
    schema = (ROOT / "workflow/schemas/config.schema.yaml").read_text(encoding="utf-8")
    assert schema == MADE["config_schema"]()


def test_schema_accepts_the_test_study_and_no_wrong_one():
    """As a program sees it that knows the standard alone."""
    validator = jsonschema.Draft202012Validator(yaml.safe_load(MADE["config_schema"]()))
    validator.check_schema(validator.schema)
    config = yaml.safe_load((ROOT / ".test/config/config.yaml").read_text(encoding="utf-8"))
    validator.validate(config)
    for wrong in ({"seeds": []}, {"layer": {"poisson": 0.6}}, {"unknown": 1}):
        with pytest.raises(jsonschema.ValidationError):
            validator.validate(config | wrong)


def test_address_is_one_field(tmp_path):
    """In every file that names it, after another one is given."""
    for name in ("workflow", "config", "profiles", "src"):
        (tmp_path / name).symlink_to(ROOT / name)
    (tmp_path / "workflow").unlink()
    shutil.copytree(ROOT / "workflow", tmp_path / "workflow")
    (tmp_path / "Snakefile").symlink_to(ROOT / "Snakefile")
    old = MADE["project"]()["urls"]["Repository"]
    named = run(ROOT, "git", "grep", "-lF", old).stdout.split()  # empty where git has no checkout
    assert set(named) <= set(MADE["ADDRESSED"])
    for name in MADE["ADDRESSED"]:
        assert old in (ROOT / name).read_text(encoding="utf-8"), name
        (tmp_path / name).parent.mkdir(exist_ok=True)
        shutil.copy(ROOT / name, tmp_path / name)
    found = run(tmp_path, "python", "workflow/metadata.py", "--address", "https://github.com/one/asperity/")
    assert found.returncode == 0, found.stderr
    for name in MADE["ADDRESSED"]:
        text = (tmp_path / name).read_text(encoding="utf-8")
        assert "https://github.com/one/asperity" in text
        assert old not in text
