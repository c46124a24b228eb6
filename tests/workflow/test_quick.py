"""The quick study, run as a user would run it: its terminal output, its files and their content.

The laws that results must obey are checked by rule statistics, in the study itself, and their numbers by the
drift check.
"""

import re
import runpy
import sys
from pathlib import Path
from types import SimpleNamespace

import pytest
from project import QUICK, ROOT, copy_project, run, snakemake


def test_manifest_holds_every_result(quick_study):
    results = quick_study.results
    assert not list(results.rglob("*.unfinished*"))
    listed = {line[66:] for line in (results / "SHA256SUMS").read_text().splitlines()}
    made = {path.relative_to(results).as_posix() for path in results.rglob("*") if path.is_file()}
    assert listed == {name for name in made if not name.startswith(("log", "benchmark", "SHA256SUMS"))}


def test_own_figure_is_drawn_from_results(quick_study, tmp_path, monkeypatch):
    (tmp_path / "results").symlink_to(quick_study.folder / "results", target_is_directory=True)
    monkeypatch.chdir(tmp_path)
    for block in re.findall(
        r"```python\n(.*?)```", (ROOT / "docs/own_figure.md").read_text("utf-8"), re.DOTALL
    ):
        exec(block, {})
    assert {path.name for path in tmp_path.glob("*.png")} == {"von_mises_peaks.png", "pressure.png"}


STUDIES = ("validation", "hurst", "measured", "compressibility", "skewness_kurtosis", "kurtosis")
ALL_FIGURES = {f"figures_{studies}" for studies in STUDIES}


@pytest.mark.parametrize(
    ("file", "rerun"),
    [
        ("cli/commands.yaml", set()),
        ("engineering/report.html.j2", set()),
        ("paper/figures/hertz.py", {"figures_validation"}),
        ("views/style.mplstyle", {"claims"} | ALL_FIGURES),
        ("results/variables.yaml", {"contact", "stress", "statistics", "validation", "claims"} | ALL_FIGURES),
    ],
)
def test_changed_file_reruns_the_jobs_that_use_it(quick_study, file, rerun):
    path = quick_study.folder / "src/asperity" / file
    text = path.read_bytes()
    path.write_bytes(text + b"\n")
    plan = snakemake(quick_study.folder, *QUICK, "--dry-run")
    path.write_bytes(text)
    said = plan.stdout + plan.stderr
    jobs = {line.split()[0] for line in said.splitlines() if re.fullmatch(r"\w+ +\d+", line)}
    assert jobs - {"total", "study"} == rerun
    assert ("Nothing to be done" in said) == (not rerun)


IMPORTED = """
import ast, pathlib, sys
for node in ast.parse(pathlib.Path(sys.argv[1]).read_text()).body:
    if isinstance(node, (ast.Import, ast.ImportFrom)):
        exec(ast.unparse(node))
names = {name for name in sys.modules if name.startswith("asperity.")}
print(*(sys.modules[name].__file__ for name in names))
"""


@pytest.mark.parametrize("name", ["contact.py", "claims.py"])
def test_all_that_a_script_imports_is_hashed(name):
    """Python itself says which modules those are."""
    folder = SimpleNamespace(get_path_or_uri=lambda **_: str(ROOT / "workflow/rules"))
    given = {"config": {"fft_engine": "ducc0"}, "workflow": SimpleNamespace(current_basedir=folder)}
    rules = runpy.run_path(str(ROOT / "workflow/rules/code.smk"), given)
    path = ROOT / "workflow/scripts" / name
    imported = {Path(file) for file in run(ROOT, sys.executable, "-c", IMPORTED, str(path)).stdout.split()}
    hashed = {file for file in rules["files_of"](name) if isinstance(file, Path)}
    assert imported
    assert imported <= hashed
    assert not {"engineering", "cli"} & {part for file in hashed for part in file.parts}


def test_wrong_configuration_ends_before_any_job(tmp_path):
    folder = copy_project(tmp_path)
    (folder / "bad.yaml").write_text("contact: {tolerance: yes}")
    run = snakemake(folder, "--configfile", "bad.yaml")
    assert run.returncode == 1
    assert run.stderr.splitlines()[-1].startswith("config: contact.tolerance = 'yes': a number")
    assert "Traceback" not in run.stderr
    assert not (folder / "results").exists()
