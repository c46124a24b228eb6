"""Failures: damaged files, full disks, missing packages, too little memory, two studies at once.

Each ends in one line that names what is wrong and what helps, and leaves earlier results as they were.
"""

import contextlib
import os
import re
import shutil
import subprocess

import pytest
from faults import RESULTS, study
from project import environment, hide

from asperity.runtime.preflight import claim

CONTACT = f"{RESULTS}/contact/hurst_08/seed1.nc"
STATISTICS = f"{RESULTS}/statistics/hurst_08.nc"
OTHER_STATISTICS = f"{RESULTS}/readings/free/statistics/hurst_08.nc"
AGAIN = study("--forcerun", "statistics")


def only(target, *options):
    """Command that runs the small study as far as one file."""
    command = study(*options)
    return (*command[: command.index("--")], "--", target)


@pytest.fixture
def folder(tiny_study, tmp_path):
    """A copy of the finished study."""
    return shutil.copytree(tiny_study.folder, tmp_path / "project")


def contents(folder):
    return {
        path.relative_to(folder): (path.read_bytes(), path.stat().st_mtime_ns)
        for path in (folder / RESULTS).rglob("*")
        if path.is_file() and not path.name.startswith(".running") and "log" not in path.parts
    }


def refused(folder, *command, **variables):
    """Last line of a study that fails, after checking that earlier results are as they were."""
    before = contents(folder)
    found = subprocess.run(
        command or AGAIN, cwd=folder, env=environment(folder) | variables, capture_output=True, text=True
    )
    said = found.stdout + found.stderr
    assert found.returncode == 1, said
    assert "Traceback" not in said
    assert contents(folder) == before
    return said.splitlines()[-1]


@contextlib.contextmanager
def mounted(folder, *arguments):
    """A mount over a folder, for as long as the block lasts."""
    if not shutil.which("mount"):
        pytest.skip("there is no command mount here")
    done = subprocess.run(["mount", *arguments, str(folder)], capture_output=True, text=True)
    if done.returncode:
        pytest.skip(f"mounting is not permitted here: {done.stderr.strip()}")
    try:
        yield
    finally:
        subprocess.run(["umount", str(folder)], check=True)


def flip_a_bit(path):
    content = bytearray(path.read_bytes())
    content[len(content) // 2] ^= 1
    path.write_bytes(content)


def empty(path):
    path.write_bytes(b"")


def test_a_damaged_result_is_named_before_a_job_reads_it(folder):
    flip_a_bit(folder / CONTACT)
    line = refused(folder)
    assert line.startswith(f"study: {CONTACT}: ")
    assert line.endswith("; delete it and run again")


def test_every_damaged_file_is_named(folder):
    verify = ("python", "workflow/verify.py", RESULTS)
    kinds = {
        path.relative_to(folder / RESULTS).parts[0] + path.suffix: path
        for path in (folder / RESULTS).rglob("*.*")
        if path.is_file() and not {"log", ".running", ".running.lock"} & set(path.parts)
    }
    assert {"statistics.nc", "surface.nc", "verification.csv", "figures.png", "figures.pdf"} <= kinds.keys()
    assert subprocess.run(verify, cwd=folder, env=environment(folder)).returncode == 0
    for change in (flip_a_bit, empty):
        kept = {path: path.read_bytes() for path in kinds.values()}
        for path in kinds.values():
            change(path)
        found = subprocess.run(verify, cwd=folder, env=environment(folder), capture_output=True, text=True)
        assert found.returncode == 1
        named = {line.split(": ")[1] for line in found.stderr.splitlines()}
        assert named == {str(path.relative_to(folder)) for path in kinds.values()}
        for path, content in kept.items():
            path.write_bytes(content)


def test_a_damaged_record_of_a_job_is_named(folder):
    for record in (folder / ".snakemake/metadata").iterdir():
        empty(record)
    verify = ("python", "workflow/verify.py", RESULTS)
    found = subprocess.run(verify, cwd=folder, env=environment(folder), capture_output=True, text=True)
    assert found.returncode == 1
    assert f"damaged record of {CONTACT}; delete {CONTACT} and run again" in found.stderr


@pytest.mark.parametrize("damage", ["flip_a_bit", "empty"])
def test_no_job_is_forced_to_read_a_damaged_file(folder, damage):
    globals()[damage](folder / STATISTICS)
    line = refused(folder, *study("--forcerun", "figure"))
    assert line.startswith(f"study: {STATISTICS}: ")
    assert line.endswith("; delete it and run again")


def test_a_deleted_result_is_made_again_with_the_same_numbers(folder, tiny_study):
    (folder / CONTACT).unlink()
    done = subprocess.run(AGAIN, cwd=folder, env=environment(folder), capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    for path in (CONTACT, STATISTICS):
        assert (folder / path).read_bytes() == (tiny_study.folder / path).read_bytes()


@contextlib.contextmanager
def full_disk(folder):
    """The results without those of one job, on a disk with hardly any space left."""
    results = folder / "results"
    for path in (STATISTICS, OTHER_STATISTICS):
        (folder / path).unlink()
    kept = shutil.copytree(results, folder / "kept")
    with mounted(results, "-t", "tmpfs", "-o", "size=8m", "tmpfs"):
        shutil.copytree(kept, results, dirs_exist_ok=True)
        space = shutil.disk_usage(results).free
        (results / "ballast").write_bytes(bytes(space - 2**15))
        yield


def test_too_little_disk_is_noticed_before_the_run(folder):
    line = refused(
        folder, *study("--forcerun", "statistics", "--set-resources", "statistics:disk_mb=1000000000000000")
    )
    assert re.match(
        rf"study: {RESULTS}: about 1e\+15 MB will be written, \S+ MB are free; free some space", line
    )


def test_a_disk_that_fills_up_is_named_and_costs_no_earlier_result(folder):
    with full_disk(folder):
        line = refused(folder, *only(STATISTICS, "--set-resources", "statistics:disk_mb=0"))
    assert line.startswith(f"study: {STATISTICS}: cannot be written (the disk is full); free some space")


NEEDS_MEMORY = r"study: {results}/\S+ needs about (\S+) GB of memory, {source} (\S+) GB; choose fewer points"


def test_too_little_memory_is_noticed_before_the_run(folder):
    (folder / "large.yaml").write_text("surfaces: {hurst_08: {points: 32768}}")
    line = refused(folder, *study("large.yaml", "--config", f"results={RESULTS}"))
    found = re.match(NEEDS_MEMORY.format(results=RESULTS, source="this machine has"), line)
    assert float(found[1]) > float(found[2])


def test_a_job_larger_than_the_memory_allowed_is_refused(folder):
    line = refused(folder, *study("--forceall", "--resources", "mem_mb=100"))
    found = re.match(NEEDS_MEMORY.format(results=RESULTS, source="mem_mb allows"), line)
    assert float(found[1]) > float(found[2]) == 0.1


def test_a_failed_job_is_named_with_its_error_and_its_log(folder):
    for path in (STATISTICS, OTHER_STATISTICS):
        (folder / path).unlink()
    module = folder / "src/asperity/pipeline/statistics.py"
    failing = "\n\ndef surface_statistics(*_, **settings):\n    raise ValueError('no peaks')\n"
    module.write_text(module.read_text() + failing)
    line = refused(folder)
    log = f"{RESULTS}/log/statistics/hurst_08.log"
    assert line == f"study: {STATISTICS}: no peaks (ValueError) [{log}]"
    assert "Traceback" in (folder / log).read_text()


def test_a_read_only_folder_is_named(folder):
    results = folder / "results"
    with mounted(results, "-t", "tmpfs", "-o", "ro", "tmpfs"):
        line = refused(folder)
    assert line.startswith(f"study: {RESULTS}: cannot be written (Read-only file system); make it writable")


@pytest.mark.parametrize("name", ["tqdm", "jsonschema"])
def test_a_missing_package_is_named_before_the_run(folder, name):
    line = refused(folder, PYTHONPATH=f"{hide(name, folder / 'hidden')}{os.pathsep}{folder / 'src'}")
    assert line.startswith(f"study: not installed: {name}; install with: pip install asperity")


def test_a_second_study_in_the_same_folder_is_refused(folder):
    lock = claim(folder / RESULTS)
    line = refused(folder)
    lock.release()
    assert line.startswith(f"study: {RESULTS}: another study is running here (process {os.getpid()} on ")
