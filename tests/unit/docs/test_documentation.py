"""Examples of docstrings, pages and the gallery run as they stand; the API page is complete."""

from __future__ import annotations

import doctest
import inspect
import re
import runpy
import shutil
from pkgutil import resolve_name

import matplotlib as mpl
import matplotlib.pyplot as plt
import numpy as np
import pytest
from project import ROOT

import asperity
from asperity.engineering.case import Case

PUBLIC = {name for name in asperity.__all__ if callable(getattr(asperity, name))}
LISTED = re.findall(
    r"^   ~(asperity(?:\.\w+)*)\.(\w+)$", (ROOT / "docs/api.rst").read_text("utf-8"), re.MULTILINE
)
DOCSTRINGS = [
    (resolve_name(module), name) for module, name in LISTED if name not in ("ConvergenceError", "MapError")
]
PAGES = (
    "README.md",
    "docs/index.md",
    "docs/contact.md",
    "docs/bodies.md",
    "docs/export.md",
    "docs/errors.md",
)
BLOCKS = {
    f"{page} {number}": block
    for page in PAGES
    for number, block in enumerate(
        re.findall(r"```python\n(.*?)```", (ROOT / page).read_text("utf-8"), re.DOTALL)
    )
}
GALLERY = sorted((ROOT / "examples").glob("*/plot_*.py"))

pytestmark = pytest.mark.xdist_group("documentation")  # functions are compiled and imported once


@pytest.fixture(autouse=True)
def _without_screen(monkeypatch):
    monkeypatch.setattr(plt, "show", lambda: None)
    with mpl.rc_context():
        yield
        plt.close("all")


@pytest.mark.parametrize(("module", "name"), DOCSTRINGS, ids=[name for _, name in DOCSTRINGS])
def test_docstring_example_runs(module, name):
    names = {"asp": asperity, "np": np}
    (found,) = doctest.DocTestFinder(recurse=False).find(getattr(module, name), name, globs=names)
    assert any(example.want for example in found.examples), f"{name}: an example with a result is needed"
    runner = doctest.DocTestRunner(optionflags=doctest.ELLIPSIS | doctest.NORMALIZE_WHITESPACE)
    messages: list[str] = []
    assert runner.run(found, out=messages.append).failed == 0, "".join(messages)


@pytest.mark.parametrize("block", BLOCKS.values(), ids=BLOCKS)
def test_page_example_runs(block, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    shutil.copy(ROOT / "tests/data/steel.x3p", tmp_path)
    names: dict = {}
    exec(block, names)
    names["contact"].certificate.check(1e-4)


@pytest.mark.parametrize("path", GALLERY, ids=lambda path: path.stem)
def test_gallery_example_runs(path, monkeypatch):
    """Each ends with checks of its physics."""
    if "film_flow" in path.read_text("utf-8"):
        pytest.importorskip("pyamg")
    monkeypatch.chdir(path.parent)
    runpy.run_path(str(path), run_name="__main__")
    for number in plt.get_fignums():
        plt.figure(number).canvas.draw()


def test_api_page_lists_every_public_name():
    assert sorted(name for module, name in LISTED if module == "asperity") == sorted(PUBLIC)
    assert [each for each in LISTED if not hasattr(resolve_name(each[0]), each[1])] == []


def test_functions_say_what_they_return():
    functions = [each for module, name in DOCSTRINGS if inspect.isfunction(each := getattr(module, name))]
    assert len(functions) > 35
    without = [
        each.__name__
        for each in functions
        if inspect.signature(each).return_annotation not in ("None", None)
        and not re.search(r"^(Returns|Yields)$", inspect.getdoc(each) or "", re.MULTILINE)
    ]
    assert without == []


def test_help_names_every_setting():
    for cls in (asperity.Case, asperity.Body, asperity.MapOptions):
        assert {*inspect.signature(cls).parameters} == {*cls.model_fields}
        listed = inspect.getdoc(cls).split("Raises\n")[0]
        assert [name for name in cls.model_fields if f"\n{name} : " not in listed] == []
    text = asperity.run.__doc__
    assert [name for name in Case.model_fields if not re.search(rf"\b{name}\b", text)] == []


def test_made_tables_are_current():
    made = runpy.run_path(str(ROOT / "docs/make_tables.py"))
    stale = [
        name for name in made["PAGES"] if made["page"](name) != (ROOT / "docs" / name).read_text("utf-8")
    ]
    assert stale == []


def test_case_page_names_every_question():
    page = (ROOT / "docs/cases.md").read_text("utf-8")
    assert len(Case.kinds()) >= 10
    assert Case.kinds().keys() == {
        *re.findall(r"^\| `(\w+)` \|.*\|.*\|", page.split("<!--")[0], re.MULTILINE)
    }


def test_materials_of_the_page_are_known(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (own,) = re.findall(r"```yaml\n(.*?)```", (ROOT / "docs/materials.md").read_text("utf-8"), re.DOTALL)
    (tmp_path / "materials.yaml").write_text(own, encoding="utf-8")
    case = Case(map="a.x3p", body={"material": "my steel"}, load={"force": 1.0}, materials="materials.yaml")
    assert (case.body.young, case.body.poisson, case.body.hardness) == (205e9, 0.29, 3.2e9)


def anchors_of(page):
    """Anchors of the headings of a page."""
    headings = re.findall(r"^#+ (.+)$", page.read_text("utf-8"), re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", heading.lower()).strip().replace(" ", "-") for heading in headings}


@pytest.mark.parametrize(
    "page",
    [
        *(ROOT / name for name in ("README.md", "CONTRIBUTING.md", "config/README.md")),
        *ROOT.glob("docs/*.md"),
        *ROOT.glob("paper/supplement/*.md"),
        *ROOT.glob("studies/*/README.md"),
    ],
    ids=lambda path: str(path.relative_to(ROOT)),
)
def test_links_to_files_and_headings_exist(page):
    lost = []
    for link in re.findall(r"\]\((?!https?:)([^)\s]+)\)", page.read_text("utf-8")):
        path, _, anchor = link.partition("#")
        target = page.parent / path if path else page
        if path.startswith(("gallery/", "api")):  # made by `make docs`
            continue
        if not target.exists() or (anchor and anchor not in anchors_of(target)):
            lost.append(link)
    assert lost == []


FOLDERS = (
    "src",
    "docs",
    "studies",
    "benchmarks",
    "workflow",
    "config",
    "examples",
    "profiles",
    "paper",
    "tests",
)
"""Folders whose texts and comments name modules and pages."""
MADE = {"results/claims.md", "results/validation/table.md", "validation/table.md", "study/workflow/maps.smk"}
"""Files of a study that asperity writes."""


def test_modules_and_pages_that_texts_name_exist():
    inside = [path for folder in FOLDERS for path in (ROOT / folder).rglob("*.*")]
    made = {"_build", "gallery", "api"}  # by `make docs`
    known = [path for path in (*inside, *ROOT.glob("*")) if not made & {*path.parts}]
    ends = {"/".join(path.parts[-depth:]) for path in known for depth in range(1, 6)}
    texts = [path for path in known if "tests" not in path.parts]
    missing = {
        f"{path.relative_to(ROOT)}: {name}"
        for path in texts
        if path.suffix in (".py", ".yaml", ".smk", ".j2", ".md", ".rst")
        for name in re.findall(
            r"(?<![\w{}*/.-])[\w/]*\w\.(?:py|smk|md)\b(?![\w(]|\.\w)", path.read_text("utf-8")
        )
        if name not in ends | MADE
    }
    assert missing == set()


def test_programs_have_a_source_and_a_date():
    """A cell without a link has the link of its program."""
    table = (ROOT / "docs/limits.md").read_text("utf-8").split("## Beside other programs")[1]
    rows = [row.split(" | ") for row in re.findall(r"^\| (.*) \|$", table, re.MULTILINE)]
    assert len(rows) == 10
    assert {len(row) for row in rows} == {7}
    assert [row[0] for row in rows[2:] if not re.match(r"\[.*\]\(https?://", row[0])] == []
    assert re.search(r"Read on \d+ \w+ 20\d\d", table)


def test_picture_of_the_rooms_is_that_of_the_imports():
    pytest.importorskip("grimp")
    made = runpy.run_path(str(ROOT / "docs/draw_rooms.py"))
    assert made["picture"]() == (ROOT / "docs/rooms.svg").read_text("utf-8")
    page = (ROOT / "docs/architecture.md").read_text("utf-8").split("## The way")[0]
    rooms = [
        name
        for row in re.findall(r"^\| (`.*?) \|", page, re.MULTILINE)
        for name in re.findall(r"`(\w+)`", row)
    ]
    assert sorted(rooms) == sorted(made["rooms"]())


def test_names_of_the_architecture_exist():
    """Files below `src/asperity` or the folder, and identifiers of the code."""
    page = (ROOT / "docs/architecture.md").read_text("utf-8")
    code = "".join(
        path.read_text("utf-8") for path in (ROOT / "src").rglob("*") if path.suffix in (".py", ".yaml")
    )
    names = {name for name in re.findall(r"`([\w./]+)`", page) if not name.startswith("draw_")}
    places = [ROOT, *(ROOT / "src/asperity").rglob("*/"), ROOT / "src/asperity"]
    lost = [
        name
        for name in sorted(names)
        if not any((place / name).exists() for place in places)
        and not re.search(rf"\b{re.escape(name)}\b", code)
    ]
    assert lost == []
