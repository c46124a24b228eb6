"""Broken ground: damaged files, full and read-only disks, missing packages, too little memory, two at once.

Each ends in one line that names what is wrong and the remedy, and leaves earlier results as they were.
"""

import contextlib
import os
import re
import shutil
import signal
import subprocess

import netCDF4
import pytest
from faults import RESULTS, STUDY
from project import environment, hide

CONTACT = f"{RESULTS}/contact/hurst_08/seed1.nc"
STATISTICS = f"{RESULTS}/statistics/hurst_08.nc"
AGAIN = (*STUDY[: STUDY.index("--")], "--forcerun", "statistics", *STUDY[STUDY.index("--") :])


@pytest.fixture
def folder(tiny_study, tmp_path):
    """A copy of the finished study."""
    return shutil.copytree(tiny_study.folder, tmp_path / "project")


def contents(folder):
    return {
        path.relative_to(folder): (path.read_bytes(), path.stat().st_mtime_ns)
        for path in (folder / RESULTS).rglob("*")
        if path.is_file() and path.name != ".running" and not {"log", "benchmark"} & set(path.parts)
    }


def refused(folder, *command, **variables):
    """The one line with which a study ends that is refused; earlier results are as they were."""
    before = contents(folder)
    found = subprocess.run(
        command or AGAIN, cwd=folder, env=environment(folder) | variables, capture_output=True, text=True
    )
    said = found.stdout + found.stderr
    assert found.returncode == 1, said
    assert "Traceback" not in said
    assert contents(folder) == before
    (line,) = (line for line in said.splitlines() if line.startswith("study: "))
    assert said.rstrip().endswith(line)
    return line


@contextlib.contextmanager
def mounted(folder, *arguments):
    """A mount over a folder, for as long as the block lasts."""
    done = subprocess.run(["mount", *arguments, str(folder)], capture_output=True, text=True)
    if done.returncode:
        pytest.skip(f"mounting is not permitted here: {done.stderr.strip()}")
    try:
        yield
    finally:
        subprocess.run(["umount", str(folder)], check=True)


def truncate(path):
    path.write_bytes(path.read_bytes()[:-500])


def flip(path):
    content = bytearray(path.read_bytes())
    content[len(content) // 2] ^= 1
    path.write_bytes(content)


def relabel(path):
    with netCDF4.Dataset(path, "a") as file:
        file["pressure"].units = "Pa"


def empty(path):
    path.write_bytes(b"")


@pytest.mark.parametrize("damage", [truncate, empty, flip, relabel])
def test_a_damaged_result_is_named_before_anything_is_made_of_it(folder, damage):
    damage(folder / CONTACT)
    line = refused(folder)
    assert line.startswith(f"study: {CONTACT}: ")
    assert line.endswith("; delete it and run again")


def test_a_deleted_result_is_made_again_with_the_same_numbers(folder, tiny_study):
    (folder / CONTACT).unlink()
    done = subprocess.run(AGAIN, cwd=folder, env=environment(folder), capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    for path in (CONTACT, STATISTICS):
        assert (folder / path).read_bytes() == (tiny_study.folder / path).read_bytes()


@contextlib.contextmanager
def full_disk(folder):
    """The results without one, on a disk with hardly any space left."""
    results = folder / "results"
    kept = shutil.copytree(results, folder / "kept")
    (kept / "tiny/statistics/hurst_08.nc").unlink()
    with mounted(results, "-t", "tmpfs", "-o", "size=8m", "tmpfs"):
        shutil.copytree(kept, results, dirs_exist_ok=True)
        space = shutil.disk_usage(results).free
        (results / "ballast").write_bytes(bytes(space - 2**15))
        yield


def test_a_disk_that_will_be_full_is_named_before_the_run(folder):
    with full_disk(folder):
        line = refused(folder, *STUDY[: STUDY.index("--")], "--", STATISTICS)
    assert re.match(
        rf"study: {RESULTS}: about \d+ MB will be written, [.\d]+ MB are free; free some space", line
    )


def test_a_disk_that_fills_up_is_named_and_costs_no_earlier_result(folder):
    with full_disk(folder):
        line = refused(
            folder,
            *STUDY[: STUDY.index("--")],
            *("--set-resources", "statistics:disk_mb=0", "--", STATISTICS),
        )
    assert line.startswith(f"study: {STATISTICS}: cannot be written (the disk is full); free some space")


def test_too_little_memory_is_foretold_with_the_number(folder):
    (folder / "large.yaml").write_text("surfaces: {hurst_08: {points: 32768}}")
    overlay = STUDY.index("--")
    line = refused(folder, *STUDY[:overlay], "large.yaml", *STUDY[overlay:])
    found = re.fullmatch(
        rf"study: {RESULTS}/\S+ needs about (\S+) GB of memory, this machine has (\S+) GB; "
        r"choose fewer points, or a machine with more",
        line,
    )
    assert float(found[1]) > float(found[2])


def test_a_read_only_folder_is_named(folder):
    results = folder / "results"
    with mounted(results, "-t", "tmpfs", "-o", "ro", "tmpfs"):
        line = refused(folder)
    assert line.startswith(f"study: {RESULTS}: cannot be written (Read-only file system); make it writable")


@pytest.mark.parametrize("name", ["mpmath", "jsonschema"])
def test_a_missing_package_is_named_before_the_run(folder, name):
    line = refused(folder, PYTHONPATH=f"{hide(name, folder / 'dark')}{os.pathsep}{folder / 'src'}")
    assert line.startswith(f"study: not installed: {name}; all that is needed: pip install")


def test_a_second_study_in_the_same_folder_is_refused(folder):
    shutil.rmtree(folder / RESULTS)
    first = subprocess.Popen(
        STUDY,
        cwd=folder,
        env=environment(folder),
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
    )
    try:
        while not (folder / RESULTS / ".running").exists() and first.poll() is None:
            pass
        found = subprocess.run(STUDY, cwd=folder, env=environment(folder), capture_output=True, text=True)
    finally:
        os.killpg(first.pid, signal.SIGKILL)
        first.communicate()
    assert found.returncode == 1
    (line,) = (line for line in found.stderr.splitlines() if line.startswith("study: "))
    assert line.startswith(f"study: {RESULTS}: another study is at work here (process {first.pid} on ")
