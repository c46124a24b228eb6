"""Folders of answers that were changed, copied or damaged, and names of files that would damage them.

Small maps, through the command line alone.
"""

import hashlib
import json
import os
import shutil
import signal

import numpy as np
import pytest
import yaml
from samples import leave_pictures_out, status, write_map

STEEL = ["--young", "210 GPa", "--poisson", "0.3", "--mean-pressure", "50 MPa"]
NAMES = ("a", "b")
pytestmark = pytest.mark.usefixtures("without_pictures")


def made_map(path, seed, pixel=(1.0, 1.0)):
    """A rough map of 16 x 16 points, with edges of the pixels in µm."""
    height = np.random.default_rng(seed).normal(scale=0.01, size=(16, 16))
    return write_map(path, height, (16 * pixel[0], 16 * pixel[1]))


@pytest.fixture(scope="module")
def kept(tmp_path_factory):
    """Two maps and the folder of their pooled answers."""
    folder = tmp_path_factory.mktemp("kept")
    with pytest.MonkeyPatch.context() as patch:
        leave_pictures_out(patch)
        maps = [made_map(folder / f"{name}.txt", seed) for seed, name in enumerate(NAMES)]
        assert status("run", *maps, *STEEL, "--pooled", "--out", folder / "pool") == 0
    return folder


@pytest.fixture
def pool(kept, tmp_path):
    """A copy of the maps and their pooled answers."""
    shutil.copytree(kept, tmp_path / "kept")
    return tmp_path / "kept/pool"


def copied_table(pool):
    shutil.copy(pool / "a/answer.csv", pool / "b/answer.csv")


def cut_table(pool):
    (pool / "b/answer.csv").write_bytes((pool / "b/answer.csv").read_bytes()[:700])


def deleted_result(pool):
    (pool / "b/contact.nc").unlink()


def other_version(pool):
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("asperity.results.dataset.__version__", "0.9.0")
        assert status("run", pool / "case.yaml", "--out", pool, "--only", "b") == 0


def untouched(_):
    pass


@pytest.mark.parametrize("damage", [untouched, copied_table, cut_table, deleted_result, other_version])
def test_resume_keeps_whole_answers_alone(pool, damage, capsys):
    """The others are computed again: the means follow from the maps."""
    before = (pool / "sample.csv").read_bytes()
    damage(pool)
    capsys.readouterr()
    assert status("run", pool / "case.yaml", "--out", pool, "--resume") == 0
    assert (capsys.readouterr().out.count(": kept\n") == 2) == (damage is untouched)
    assert (pool / "sample.csv").read_bytes() == before
    assert (pool / "b/contact.nc").exists()


def test_files_of_a_killed_process_are_removed(pool):
    """Of the sample and of the answers, also where it was killed while files were moved."""
    for place in (pool, pool / "a"):
        (place / ".unfinished-x").mkdir()
        (place / ".unfinished-x/half.nc").write_text("1")
    (pool / ".complete").mkdir()
    for name in ("sample.csv", ".asperity-run.json"):  # the manifest is moved last
        shutil.move(pool / name, pool / ".complete" / name)
    assert status("run", pool / "case.yaml", "--out", pool) == status("verify", pool) == 0
    assert not [*pool.rglob(".unfinished-*"), *pool.rglob(".complete")]
    (pool / "a/.unfinished-y").mkdir()
    assert status("run", pool / "case.yaml", "--out", pool, "--resume") == 0
    assert not [*pool.rglob(".unfinished-*")]


def lost_answer(pool):
    shutil.rmtree(pool / "b")


def lost_manifest(pool):
    (pool / "b/.asperity-run.json").unlink()


def edited_means(pool):
    (pool / "sample.csv").write_text((pool / "sample.csv").read_text().replace("1", "2"))


def edited_means_without_manifest(pool):
    (pool / ".asperity-run.json").unlink()
    edited_means(pool)


def edited_means_with_a_damaged_manifest(pool):
    (pool / ".asperity-run.json").write_text("{")
    edited_means(pool)


def exchanged_answers(pool):
    (pool / "a").rename(pool / "c")
    (pool / "b").rename(pool / "a")
    (pool / "c").rename(pool / "b")


def answer_of_a_changed_map(pool):
    made_map(pool.parent / "b.txt", 7)
    assert status("run", pool.parent / "b.txt", *STEEL, "--out", pool / "b") == 0


@pytest.mark.parametrize(
    "damage",
    [
        edited_means,
        lost_answer,
        lost_manifest,
        edited_means_without_manifest,
        edited_means_with_a_damaged_manifest,
        exchanged_answers,
        answer_of_a_changed_map,
    ],
)
def test_verify_finds_what_is_wrong_in_a_pool(pool, damage):
    assert status("verify", pool) == 0
    damage(pool)
    assert status("verify", pool) == 1


def test_changed_material_is_named(tmp_path, capsys):
    """The case keeps the constants with which it was computed."""
    (tmp_path / "materials.yaml").write_text("mine: {young: 70 GPa, poisson: 0.3}")
    case = {"map": made_map(tmp_path / "a.txt", 1), "body": {"material": "mine"}}
    (tmp_path / "own.yaml").write_text(yaml.safe_dump(case | {"load": {"mean_pressure": "50 MPa"}}))
    out = tmp_path / "out"
    assert status("run", tmp_path / "own.yaml", "--out", out) == status("verify", out) == 0
    (tmp_path / "materials.yaml").write_text("mine: {young: 210 GPa, poisson: 0.3}")
    capsys.readouterr()
    assert status("verify", out) == 1
    assert f"materials.yaml: changed since {out} was computed" in capsys.readouterr().err
    assert status("run", out / "case.yaml", "--out", tmp_path / "again") == 2
    assert "materials.mine.sha256: " in capsys.readouterr().err


@pytest.mark.parametrize("file", ["mine.yaml", "pool/a/case.yaml"])
def test_save_replaces_no_file_of_others(pool, file):
    """Neither a file that a user has written, nor one that belongs to another answer."""
    path = pool.parent / file
    if not path.exists():
        path.write_text("map: {file: a.txt}  # my own\nbody: {young: 1 GPa}\n", encoding="utf-8")
    before = path.read_bytes()
    assert status("run", pool.parent / "b.txt", *STEEL, "--out", pool.parent / "out", "--save", path) == 2
    assert path.read_bytes() == before


def test_damaged_case_of_an_answer_is_one_line(pool, capsys):
    """It is computed again, or refused with one line; the parser's own error is neither."""
    (pool / "a/case.yaml").write_text("{{{", encoding="utf-8")
    capsys.readouterr()
    assert status("run", pool / "case.yaml", "--out", pool, "--resume") in (0, 1, 2)
    assert "Error" not in capsys.readouterr().err


def test_case_of_an_answer_without_its_map(pool, capsys):
    case = pool / "a/case.yaml"
    content = yaml.safe_load(case.read_text(encoding="utf-8"))
    case.write_text(yaml.safe_dump({key: value for key, value in content.items() if key != "map"}))
    capsys.readouterr()
    assert status("verify", pool) == 1
    assert "Error" not in capsys.readouterr().err


class Waits(BaseException):
    """Raised where a command would wait for ever."""


@pytest.mark.parametrize("text", ["", "{}", "[]", '{"maps": 5}', '{"maps": {"../a": "1"}}'])
def test_damaged_list_of_a_sample_is_one_line(pool, text, capsys):
    (pool / "sample.json").write_text(text)
    checksums = json.loads((pool / ".asperity-run.json").read_text())
    checksums["sample.json"] = hashlib.sha256(text.encode()).hexdigest()
    (pool / ".asperity-run.json").write_text(json.dumps(checksums))
    for command in (["verify", pool], ["run", pool, pool]):
        assert status(*command) == 1
        (line,) = capsys.readouterr().err.splitlines()
        assert "sample.json: damaged; run" in line


@pytest.mark.parametrize("setting", ["out=5", "out.a=5", "map.points=65536", "checksums=5", "map=5"])
def test_setting_of_another_type_is_one_line(tmp_path, setting, capsys):
    command = ["run", made_map(tmp_path / "a.txt", 1), *STEEL, "--check", "--set", setting]
    refused = setting != "checksums=5"  # a map that is named has no checksum
    assert status(*command) == 2 * refused
    assert len(capsys.readouterr().err.splitlines()) == refused


def test_setting_of_counter_maps_is_that_of_the_flag(tmp_path, capsys):
    maps = [made_map(tmp_path / f"{name}.txt", seed) for seed, name in enumerate("abcd")]
    command = ["run", *maps[:2], *STEEL, "--pooled", "--check"]
    assert status(*command, "--counter-map", *maps[2:]) == 0
    for given, expected in (("[{2}, {3}]", 0), ("{2}", 0), ("[{1}, {2}, {3}]", 2), ("5", 2)):
        setting = f"counter_body.map.file={given.format(*maps)}"
        assert status(*command, "--set", "checksums=5", "--set", setting) == expected
        assert len(capsys.readouterr().err.splitlines()) == bool(expected)


def test_manifest_that_is_no_file_is_not_read(pool):
    (pool / "a/.asperity-run.json").unlink()
    os.mkfifo(pool / "a/.asperity-run.json")

    def stop(*_):
        raise Waits

    earlier = signal.signal(signal.SIGALRM, stop)
    signal.alarm(5)
    try:
        assert status("verify", pool) == 1
    finally:
        signal.alarm(0)
        signal.signal(signal.SIGALRM, earlier)


@pytest.mark.parametrize("name", ["..", "sample.csv", "case.yaml", ".complete"])
def test_maps_named_like_files_of_answers_are_refused(tmp_path, name):
    """Before anything is computed: the answer would be outside the folder, or in the way of another file."""
    maps = [made_map(tmp_path / f"{stem}.txt", seed) for seed, stem in enumerate(("a", name))]
    out = tmp_path / "answers/pool"
    assert status("run", *maps, *STEEL, "--pooled", "--out", out, "--check") == 2


def test_folder_in_a_loop_of_links_is_one_line(tmp_path, capsys):
    made_map(tmp_path / "map.txt", 0)
    (tmp_path / "loop").symlink_to(tmp_path / "loop")
    assert status("run", tmp_path / "map.txt", *STEEL, "--out", tmp_path / "loop") == 1
    assert "loop: cannot be written" in capsys.readouterr().err


def test_folder_that_is_not_utf_8_is_refused(tmp_path, monkeypatch, capsys):
    """Before anything is computed, also where the working folder has such a name."""
    file, folder = made_map(tmp_path / "a.txt", 1), tmp_path / os.fsdecode(b"d\xe4")
    try:
        folder.mkdir()
    except OSError:
        pytest.skip("this file system has names in UTF-8 only")
    monkeypatch.chdir(folder)
    for out in (folder / "out", "out"):
        assert status("run", file, *STEEL, "--out", out, "--check") == 2
        assert "its path is not UTF-8" in capsys.readouterr().err
