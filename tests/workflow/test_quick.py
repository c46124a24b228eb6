"""The quick study, run as a user would run it: its terminal output, its files and their content.

The laws that results must obey are checked by rule statistics, in the study itself, and their numbers by the
drift check.
"""

import re
import runpy

import pytest
from project import QUICK, ROOT, copy_project, snakemake

import asperity


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


@pytest.mark.parametrize(
    ("file", "rerun"),
    [
        ("cli/commands.yaml", set()),
        ("views/style.mplstyle", {"figure", "claims"}),
        ("results/variables.yaml", {"contact", "stress", "statistics", "validation", "figure", "claims"}),
    ],
)
def test_changed_file_reruns_what_computes_or_draws(quick_study, file, rerun):
    path = quick_study.folder / "src/asperity" / file
    text = path.read_bytes()
    path.write_bytes(text + b"\n")
    plan = snakemake(quick_study.folder, *QUICK, "--dry-run")
    path.write_bytes(text)
    said = plan.stdout + plan.stderr
    jobs = {line.split()[0] for line in said.splitlines() if re.fullmatch(r"\w+ +\d+", line)}
    assert jobs - {"total", "study"} == rerun
    assert ("Nothing to be done" in said) == (not rerun)


def test_every_file_counts_where_it_is_used(tmp_path, monkeypatch):
    """A new file in a folder changes the hash of what computes, or of what draws."""
    monkeypatch.setattr(asperity, "__file__", str(tmp_path / "__init__.py"))

    def hashes():
        found = runpy.run_path(str(ROOT / "workflow/rules/code.smk"), {"config": {"fft_engine": "numpy"}})
        return found["COMPUTING"], found["DRAWING"]

    before = hashes()
    rooms = {path.name for path in (ROOT / "src/asperity").iterdir() if path.is_dir()} - {"__pycache__"}
    drawing, neither = {"views", "paper"}, {"cli"}
    for room in rooms:
        (tmp_path / room / "inner").mkdir(parents=True)
        (tmp_path / room / "inner/new.py").write_text(room)
        changed = [now != then for now, then in zip(hashes(), before, strict=True)]
        assert changed == [room not in drawing | neither, room in drawing], room
        before = hashes()


def test_wrong_configuration_ends_before_any_job(tmp_path):
    folder = copy_project(tmp_path)
    (folder / "bad.yaml").write_text("contact: {tolerance: yes}")
    run = snakemake(folder, "--configfile", "bad.yaml")
    assert run.returncode == 1
    assert run.stderr.splitlines()[-1].startswith("config: contact.tolerance = 'yes': a number")
    assert "Traceback" not in run.stderr
    assert not (folder / "results").exists()
