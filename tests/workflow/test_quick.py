"""The quick study, run as a user would run it: its terminal output, its files and their content.

The laws that results must obey are checked by rule statistics, in the study itself, and their numbers by the
drift check.
"""

import os
import re
import runpy
import shutil
import sys
from pathlib import Path
from types import SimpleNamespace

import pytest
from project import QUICK, ROOT, STUDY, copy_project, run, snakemake, snakemake_here

import asperity


def test_manifest_holds_every_result(quick_study):
    results = quick_study.results
    assert not list(results.rglob("*.unfinished*"))
    listed = {line[66:] for line in (results / "SHA256SUMS").read_text().splitlines()}
    made = {path.relative_to(results).as_posix() for path in results.rglob("*") if path.is_file()}
    assert listed == {name for name in made if not name.startswith(("log", "benchmark", "SHA256SUMS"))}


def test_the_study_is_made_where_the_user_says(quick_study):
    assert "study: done; figures in ../own results/figures" in quick_study.output
    assert not (quick_study.folder / "results").exists()


def test_the_study_has_a_report(quick_study, tmp_path):
    path = tmp_path / "report.html"
    said = snakemake_here(quick_study.folder, *STUDY, "--report", str(path))
    assert path.exists(), said
    text = path.read_text(encoding="utf-8")
    assert all(words in text for words in ("fig09.png", "Figures of the paper", "claims.png"))


def test_own_figure_is_drawn_from_results(quick_study, tmp_path, monkeypatch):
    (tmp_path / "results").mkdir()
    (tmp_path / "results/quick").symlink_to(quick_study.results, target_is_directory=True)
    monkeypatch.chdir(tmp_path)
    for block in re.findall(
        r"```python\n(.*?)```", (ROOT / "docs/own_study.md").read_text("utf-8"), re.DOTALL
    ):
        exec(block, {})
    assert {path.name for path in tmp_path.glob("*.png")} == {"von_mises_peaks.png"}


def rules_in(folder):
    """Functions of the workflow in a folder that find the code of a job."""
    place = SimpleNamespace(get_path_or_uri=lambda **_: str(folder / "workflow/rules"))
    given = {"config": {"fft_engine": "ducc0"}, "workflow": SimpleNamespace(current_basedir=place)}
    return runpy.run_path(str(ROOT / "workflow/rules/code.smk"), given)


@pytest.fixture(scope="module")
def rules():
    """Functions of the workflow of the project."""
    return rules_in(ROOT)


STAGES = {"contact", "stress", "statistics", "validation", "claims", "figures"}


@pytest.mark.parametrize(("library", "project"), [("a library", "b"), ("b", "a project")])
def test_the_hash_of_code_does_not_depend_on_its_folders(rules, tmp_path, monkeypatch, library, project):
    """Library and scripts are copied, in both orders, files of a folder in another order."""
    made = shutil.copytree(rules["LIBRARY"], tmp_path / library, ignore=shutil.ignore_patterns("__pycache__"))
    shutil.copytree(rules["SCRIPTS"], tmp_path / project / "workflow/scripts")
    monkeypatch.setattr(asperity, "__file__", str(made / "__init__.py"))
    found = Path.rglob
    monkeypatch.setattr(Path, "rglob", lambda *given: sorted(found(*given), reverse=True))
    copied = rules_in(tmp_path / project)
    assert copied["LIBRARY"] == made
    for name in (*STAGES, "report_page"):
        assert copied["code_of"](f"{name}.py") == rules["code_of"](f"{name}.py"), name
    with open(made / "results/variables.yaml", "a", encoding="utf-8") as file:
        file.write("\n")
    changed = rules_in(tmp_path / project)
    assert all(changed["code_of"](f"{name}.py") != rules["code_of"](f"{name}.py") for name in STAGES)


@pytest.mark.parametrize(
    ("file", "scripts"),
    [
        ("cli/commands.yaml", set()),
        ("engineering/show/report.html.j2", set()),
        ("paper/figures/hertz.py", set()),  # of one figure, not of all
        ("views/style.mplstyle", {"claims", "figures"}),
        ("results/variables.yaml", STAGES),
    ],
)
def test_a_file_belongs_to_the_scripts_that_use_it(rules, file, scripts):
    path = rules["LIBRARY"] / file
    assert path.exists()
    assert {name for name in STAGES if path in rules["files_of"](f"{name}.py")} == scripts


def test_changed_code_and_labels_rerun_what_uses_them(quick_study):
    """Two groups of figures show the new label, another one is drawn by the changed module."""
    folder, library = quick_study.folder, quick_study.folder / "src"
    original = library.readlink()
    library.unlink()
    shutil.copytree(original, library, ignore=shutil.ignore_patterns("__pycache__"))
    with open(library / "asperity/paper/figures/hertz.py", "a", encoding="utf-8") as file:
        file.write("\n")
    (folder / "label.yaml").write_text("surfaces: {cutoff_64: {label: ground}}", encoding="utf-8")
    planned = snakemake(folder, "--dry-run", *QUICK, "label.yaml", *STUDY[len(QUICK) :])
    shutil.rmtree(library)
    library.symlink_to(original, target_is_directory=True)
    text = planned.stdout + planned.stderr
    found = {line.split()[0] for line in text.splitlines() if re.fullmatch(r"\w+ +\d+", line)}
    figures = {"figures_validation", "figures_kurtosis", "figures_skewness_kurtosis"}
    assert found - {"total"} == figures | {"study"}, text


IMPORTED = """
import ast, pathlib, sys
for node in ast.parse(pathlib.Path(sys.argv[1]).read_text()).body:
    if isinstance(node, (ast.Import, ast.ImportFrom)):
        exec(ast.unparse(node))
names = {name for name in sys.modules if name.startswith("asperity.")}
print(*(sys.modules[name].__file__ for name in names), sep="\\n")
"""


@pytest.mark.parametrize("name", ["contact.py", "claims.py"])
def test_all_that_a_script_imports_is_hashed(rules, name):
    """Python itself says which modules those are."""
    path = ROOT / "workflow/scripts" / name
    said = run(ROOT, sys.executable, "-c", IMPORTED, str(path)).stdout
    imported = {Path(file).resolve() for file in said.splitlines()}
    hashed = {file.resolve() for file in rules["files_of"](name) if isinstance(file, Path)}
    assert imported
    assert imported <= hashed
    assert not {"engineering", "cli"} & {part for file in hashed for part in file.parts}


def test_wrong_configuration_ends_before_any_job(tmp_path):
    folder = copy_project(tmp_path)
    (folder / "bad.yaml").write_text("contact: {tolerance: yes}")
    said = snakemake_here(folder, "--configfile", "bad.yaml")
    assert "config: contact.tolerance = 'yes': a number" in said
    assert "Traceback" not in said
    assert not (folder / "results").exists()


@pytest.mark.parametrize("newest", [2e9, 1e9])
def test_a_copied_study_is_complete_and_an_edited_file_is_noticed(quick_study, tmp_path, newest):
    """Copied without the times of its files and without empty folders; every result is as new as an
    adversary would have it, and all are newer or older than the scripts that made them.
    """
    shutil.copytree(
        quick_study.folder.parent, tmp_path, symlinks=True, copy_function=shutil.copyfile, dirs_exist_ok=True
    )
    folder, copied = (tmp_path / path.name for path in (quick_study.folder, quick_study.results))
    (folder / ".snakemake/incomplete").rmdir()  # Snakemake then converts its folder
    results = sorted(path for path in copied.rglob("*") if path.is_file())
    stages = ("surface", "contact", "stress", "statistics")
    for path in results:  # the earlier the stage, the newer the file
        stage = path.relative_to(copied).parts[0]
        time = newest - 1e6 * (stages.index(stage) if stage in stages else len(stages))
        os.utime(path, (time, time))
    assert "Nothing to be done" in snakemake_here(folder, *STUDY, "--dry-run")
    edited = next(path for path in results if path.match("contact/*/*.nc"))
    with open(edited, "ab") as file:
        file.write(b"\0")
    os.utime(edited, (newest, newest))
    assert re.search(r"^stress +1$", snakemake_here(folder, *STUDY, "--dry-run"), re.MULTILINE)
