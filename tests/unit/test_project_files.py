"""Files by which the project is found and cited agree with each other and with the code."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
import yaml

import asperity

ROOT = Path(__file__).parents[2]


def text(name):
    return (ROOT / name).read_text(encoding="utf-8")


def test_the_citation_is_of_this_version_and_complete():
    citation = yaml.safe_load(text("CITATION.cff"))
    assert citation["version"] == asperity.__version__
    assert {
        "title",
        "abstract",
        "authors",
        "license",
        "keywords",
        "date-released",
        "message",
    } <= citation.keys()
    assert f"\n## {asperity.__version__}" in text("CHANGELOG.md")


def test_every_reference_of_the_paper_is_in_its_bibliography_and_the_other_way():
    cited = set(re.findall(r"@(\w+)", text("paper/paper.md").split("---", 2)[2]))
    known = set(re.findall(r"^@\w+\{(\w+),", text("paper/paper.bib"), re.MULTILINE))
    assert cited == known
    for picture in re.findall(r"\]\((\w+\.png)\)", text("paper/paper.md")):
        assert (ROOT / "paper" / picture).exists()


def test_the_ci_runs_targets_of_the_makefile():
    ci = yaml.safe_load(text(".github/workflows/ci.yml"))
    runs = [step["run"] for job in ci["jobs"].values() for step in job["steps"] if "run" in step]
    assert runs[0] == text(".ci/run").splitlines()[-1].removeprefix("exec ")
    for run in runs:
        assert f"\n{run.removeprefix('make ')}:" in text("Makefile")


@pytest.mark.parametrize("name", ["README.md", "CONTRIBUTING.md", "CODE_OF_CONDUCT.md"])
def test_links_to_files_of_the_project_lead_somewhere(name):
    links = re.findall(r"\]\((?!https?:)([^)#]+)\)", text(name))
    assert [link for link in links if not (ROOT / link).exists()] == []


def test_files_and_targets_that_the_contributing_page_names_exist():
    page = text("CONTRIBUTING.md")
    targets = re.findall(r"(?:`|^    )make ([a-z-]+)", page, re.MULTILINE)
    assert len(targets) > 5
    assert [target for target in targets if f"\n{target}:" not in text("Makefile")] == []
    files = re.findall(r"`((?:tests|docs|workflow)/[\w/.]+)`", page)
    assert len(files) > 3
    assert [path for path in files if not (ROOT / path).exists()] == []
    modules = re.findall(r"`((?:config|accuracy|results|paper|contact|surface)/[\w/]+\.\w+)`", page)
    assert len(modules) > 5
    library = ROOT / "src/asperity"
    assert [path for path in modules if not (library / path).exists() and "NAME" not in path] == []


def test_the_readme_can_be_read_at_once():
    assert len(text("README.md").splitlines()) <= 130


def test_issue_templates_are_forms():
    forms = {path.stem: path for path in (ROOT / ".github/ISSUE_TEMPLATE").glob("*.yml")}
    del forms["config"]
    assert "wrong_number" in forms
    for name, path in forms.items():
        form = yaml.safe_load(path.read_text(encoding="utf-8"))
        assert {"name", "description", "body"} <= form.keys(), name
