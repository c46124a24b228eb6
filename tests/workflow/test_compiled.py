"""Rule compiled: after it no job compiles anything, and it keeps nothing from running that should."""

import os

import pytest
from project import QUICK, run, snakemake

from asperity.runtime.compiling import PARTS

NAMES = "from asperity.runtime.compiling import compiled_functions as found; print(*found(), sep='\\n')"


def caches(folder):
    """What numba keeps beside the modules of the library."""
    return [*(folder / "src").rglob("*.nbi"), *(folder / "src").rglob("*.nbc")]


def test_no_job_compiles_anything_after_it(quick_study):
    compiled = list((quick_study.folder / "results/quick/compiled").iterdir())
    assert {path.stem for path in compiled} == PARTS.keys()
    names = run(quick_study.folder, "python", "-c", NAMES).stdout.split()
    assert len(names) > 30
    kept = {path.name.split("-")[0] for path in caches(quick_study.folder) if path.suffix == ".nbi"}
    assert kept == {".".join(name.split(".")[-2:]) for name in names}
    newest = max(path.stat().st_mtime_ns for path in caches(quick_study.folder))
    assert newest < max(path.stat().st_mtime_ns for path in compiled)
    for path in compiled:
        assert path.read_text().startswith(f"The functions of the {path.stem} are compiled")


def test_what_is_compiled_already_is_not_compiled_again(quick_study, second_study):
    first, second = (
        {path.relative_to(study.folder): path.stat().st_mtime_ns for path in caches(study.folder)}
        for study in (quick_study, second_study)
    )
    assert first == second


@pytest.mark.parametrize("name", ["contact/active_set.py", "contact/gfmd.py"])
def test_a_changed_solver_reruns_the_contacts(quick_study, name):
    """A rule that other rules wait for, but do not depend on, may hide their own reasons to run."""
    module = quick_study.folder / "src/asperity" / name
    text, before = module.read_text(), module.stat()
    module.write_text(text + "\n")
    plan = snakemake(quick_study.folder, *QUICK, "--dry-run")
    module.write_text(text)
    os.utime(module, ns=(before.st_atime_ns, before.st_mtime_ns))
    jobs = dict(line.split() for line in (plan.stdout + plan.stderr).splitlines() if len(line.split()) == 2)
    assert {jobs.get(rule) for rule in ("contact", "stress", "statistics")} == {"6"}
    assert "surface" not in jobs
