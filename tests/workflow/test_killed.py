"""A killed study loses no finished result, and continues with the same command."""

import os
import signal
import subprocess
import time

from project import TINY, copy_project, environment, numbers, snakemake

RESULTS = "results/tiny"
STAGES = ("surface/hurst_08/seed1.nc", "contact/hurst_08/seed1.nc", "stress/hurst_08/seed1.nc")


def killed(folder, path):
    """Run the study until a file is there, and kill it with all its jobs."""
    command = ["snakemake", "--cores", "2", *TINY]
    with subprocess.Popen(command, cwd=folder, env=environment(folder), start_new_session=True) as study:
        while not (folder / path).exists():
            assert study.poll() is None
            time.sleep(0.05)
        os.killpg(study.pid, signal.SIGKILL)


def test_killed_study_continues_without_loss(tiny_study, tmp_path):
    folder = copy_project(tmp_path / "project")
    killed(folder, f"{RESULTS}/log/stress/hurst_08/seed1.log")  # surface and contact are finished
    finished = [folder / RESULTS / name for name in STAGES[:2]]
    before = [path.stat().st_mtime_ns for path in finished]
    assert not (folder / RESULTS / STAGES[2]).exists()
    refused = snakemake(folder, *TINY)
    assert refused.returncode != 0
    assert "--unlock" in refused.stdout + refused.stderr
    assert snakemake(folder, *TINY, "--unlock").returncode == 0
    found = snakemake(folder, *TINY)
    assert found.returncode == 0, found.stdout + found.stderr
    assert [path.stat().st_mtime_ns for path in finished] == before
    for name in (*STAGES, "statistics/hurst_08.nc"):
        assert numbers(folder / RESULTS / name).identical(numbers(tiny_study.folder / RESULTS / name)), name


def test_half_written_file_is_made_again(tiny_study):
    """A job that is killed leaves Snakemake's mark of an incomplete output behind."""
    path = tiny_study.folder / RESULTS / STAGES[2]
    whole = path.read_bytes()
    path.write_bytes(whole[: len(whole) // 2])
    marks = tiny_study.folder / ".snakemake/incomplete"
    import base64

    mark = marks / base64.b64encode(f"{RESULTS}/{STAGES[2]}".encode()).decode()
    mark.parent.mkdir(exist_ok=True)
    mark.touch()
    found = snakemake(tiny_study.folder, *TINY, "--", f"{RESULTS}/{STAGES[2]}")
    assert found.returncode == 0, found.stdout + found.stderr
    assert path.stat().st_size == len(whole)
