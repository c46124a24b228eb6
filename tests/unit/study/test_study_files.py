"""Files of a study: the folder of `asperity study init`, results that lack something, the manifest."""

import errno
import os
import shutil
from hashlib import sha256

import pytest
from small_study import SETTINGS, results_of

from asperity.cli.main import main
from asperity.results import dataset
from asperity.study.preflight_and_manifest import MANIFEST, write_manifest


@pytest.fixture
def results(tmp_path):
    """A folder of results with its manifest."""
    for name in ("one.nc", "two.nc"):
        (tmp_path / name).write_text(name)
    write_manifest(tmp_path, [tmp_path / "one.nc", tmp_path / "two.nc"])
    return tmp_path


@pytest.mark.parametrize("is_new", [True, False])
def test_init_writes_the_study_or_nothing(tmp_path, monkeypatch, capsys, is_new):
    folder = tmp_path / "study"
    if not is_new:
        folder.mkdir()
    genuine = shutil.copyfile

    def full_disk(origin, target):
        if origin.name == "quick.yaml":
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
        genuine(origin, target)

    monkeypatch.setattr(shutil, "copyfile", full_disk)
    assert main(["study", "init", str(folder)]) == 1
    assert capsys.readouterr().err == "asperity: [Errno 28] No space left on device\n"
    assert folder.exists() == (not is_new)
    monkeypatch.setattr(shutil, "copyfile", genuine)
    assert main(["study", "init", str(folder)]) == 0
    assert {path.name for path in folder.iterdir()} == {"Snakefile", "config", "profiles", "workflow"}
    assert {"Snakefile", "rules", "scripts", "envs"} < {path.name for path in (folder / "workflow").iterdir()}
    assert main(["study", "init", str(folder)]) == 1
    assert "holds Snakefile; the name of an empty or new folder is needed" in capsys.readouterr().err
    assert main(["study", "init", str(tmp_path / "\x1b[31m")]) == 0
    assert "\x1b" not in capsys.readouterr().out


def damaged(folder):
    """Files that differ from their hash in the manifest."""
    lines = (line.split("  ") for line in (folder / MANIFEST).read_text().splitlines())
    return {name for hash_of, name in lines if sha256((folder / name).read_bytes()).hexdigest() != hash_of}


def test_a_later_run_keeps_damage_visible(results):
    assert damaged(results) == set()
    (results / "one.nc").write_text("other")
    os.utime(results / "one.nc", (0, 0))
    (results / "two.nc").write_text("written again")
    write_manifest(results, [])
    assert damaged(results) == {"one.nc"}
    (results / "one.nc").unlink()
    write_manifest(results, [])
    assert "one.nc" not in (results / MANIFEST).read_text()


def test_a_result_that_lacks_something_is_an_error(tmp_path, capsys):
    """Made by someone who can compute a fingerprint; a damaged file is refused before."""
    _, _, contact, stress = results_of(1)
    files = {"contact": contact.drop_vars("gap"), "stress": stress.drop_vars("peak_value")}
    for name, data in files.items():
        dataset.write(data, tmp_path / f"{name}.nc", name, SETTINGS)
    assert main(["verify", str(tmp_path / "contact.nc")]) == 1
    said = capsys.readouterr().err
    assert said.startswith("Traceback")
    assert "KeyError: " in said
    assert "asperity: an error of asperity itself, or a result file" in said.splitlines()[-1]
    assert main(["export", str(tmp_path / "stress.nc"), "--peaks", str(tmp_path / "p.csv")]) == 1
    assert capsys.readouterr().err.endswith(
        "a result of no stage, one of surface or contact or stress is needed\n"
    )
