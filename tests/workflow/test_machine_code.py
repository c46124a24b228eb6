"""Rule machine_code: no later job compiles anything, and all jobs still run when they have to."""

import os

import pytest
from project import QUICK, run, snakemake

from asperity.runtime.compiling import PARTS

NAMES = "from asperity.runtime.compiling import compiled_functions as found; print(*found(), sep='\\n')"


def test_no_job_compiles_anything_after_it(quick_study):
    texts = list((quick_study.folder / "results/quick/machine_code").iterdir())
    assert {path.stem for path in texts} == PARTS.keys()
    names = run(quick_study.folder, "python", "-c", NAMES).stdout.split()
    caches = list((quick_study.folder / "src").rglob("*.nb[ic]"))
    kept = {path.name.split("-")[0] for path in caches if path.suffix == ".nbi"}
    found = {".".join(name.split(".")[-2:]) for name in names}
    assert kept == found
    newest = max(path.stat().st_mtime_ns for path in caches)
    assert newest < max(path.stat().st_mtime_ns for path in texts)
    for path in texts:
        assert path.read_text().startswith(f"The functions of the {path.stem} are compiled")


def test_compilation_is_announced(quick_study):
    assert "study: compiling the library first, once for all jobs: about " in quick_study.output


@pytest.mark.parametrize(
    ("module", "rerun", "kept"),
    [
        ("contact/active_set.py", {"contact": "6", "stress": "6", "statistics": "6"}, {"surface"}),
        # Of the paper's study and of the measured surface.
        ("paper/figures/fig10.py", {"figure": "2"}, {"surface", "contact", "stress", "statistics"}),
    ],
)
def test_a_changed_module_reruns_the_jobs_that_use_it_and_no_other(quick_study, module, rerun, kept):
    path = quick_study.folder / "src/asperity" / module
    text, before = path.read_text(), path.stat()
    path.write_text(text + "\n")
    plan = snakemake(quick_study.folder, *QUICK, "--dry-run")
    path.write_text(text)
    os.utime(path, ns=(before.st_atime_ns, before.st_mtime_ns))
    jobs = dict(line.split() for line in (plan.stdout + plan.stderr).splitlines() if len(line.split()) == 2)
    assert {name: jobs.get(name) for name in rerun} == rerun
    assert not kept & jobs.keys()
