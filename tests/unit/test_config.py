"""The configuration: what is accepted, and the one line for what is not."""

import os
import subprocess
import sys
from pathlib import Path

import pytest
import yaml
from project import hide

from asperity.config.check import check, describe, load_schema
from asperity.config.reader import merged

ROOT = Path(__file__).parents[2]
SCHEMA = load_schema(ROOT / "src/asperity/config/schema.yaml")
PAPER = yaml.safe_load((ROOT / "config/config.yaml").read_text())


@pytest.mark.parametrize("overlay", sorted((ROOT / "config").glob("*.yaml")), ids=lambda path: path.name)
def test_the_committed_configurations_are_accepted(overlay):
    check(merged(PAPER, yaml.safe_load(overlay.read_text())), SCHEMA)


def test_the_readme_lists_the_keys_of_the_schema():
    table = (ROOT / "config/README.md").read_text().split("<!-- keys: ")[1].split("-->\n")[1]
    assert table.strip() == describe(SCHEMA)


@pytest.mark.parametrize(("name", "package"), [("jsonschema", "jsonschema"), ("yaml", "pyyaml")])
def test_a_missing_package_is_one_line(tmp_path, name, package):
    path = os.pathsep.join([str(hide(name, tmp_path / "dark")), str(ROOT / "src")])
    command = [sys.executable, "-m", "asperity.config.check", "src/asperity/config/schema.yaml"]
    environment = os.environ | {"PYTHONPATH": path}
    found = subprocess.run(command, cwd=ROOT, env=environment, capture_output=True, text=True)
    assert found.returncode == 1
    assert found.stderr.startswith(f"config: not installed: {package}; install everything with: pip install")
    assert found.stderr.count("\n") == 1
