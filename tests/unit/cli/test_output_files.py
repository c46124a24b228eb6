"""Files that commands write: none that is read or foreign is replaced, and two processes share no folder."""

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import yaml
from samples import status, write_map

import asperity as asp
from asperity import Body
from asperity.contact import METHODS
from asperity.core import system
from asperity.core.errors import DatasetError
from asperity.engineering.folder import LOCK, UNFINISHED, locked, stems_of
from asperity.surface.reading.height_map import HeightMap

BODY = ["--young", "210 GPa", "--poisson", "0.3"]
STEEL = [*BODY, "--mean-pressure", "50 MPa"]


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """Working directory with two small maps."""
    monkeypatch.chdir(tmp_path)
    height = asp.self_affine((32, 32), 0.8, 16.0, 4.0, rms_height=0.1, seed=1, length=32.0)
    for name, values in (("mine.txt", height), ("other.txt", 2 * height)):
        write_map(name, values, (32, 32))
    return tmp_path


@pytest.fixture
def never(monkeypatch):
    """Nothing is computed."""

    def fail(*_, **__):
        raise AssertionError("computed before the file was refused")

    monkeypatch.setitem(METHODS, "active_set", fail)
    monkeypatch.setattr("asperity.surface.treatment.treatment.available_memory", lambda: 25e3)


RUN = ["run", "mine.txt", *STEEL, "--out", "out"]
COUNTER = ["--counter-map", "other.txt", "--counter-material", "100Cr6"]


COATING = "--set body.layers.0.thickness=1um --set body.layers.0.young=1GPa --set body.layers.0.poisson=0.3"


@pytest.mark.usefixtures("never")
@pytest.mark.parametrize(
    ("words", "line"),
    [
        ([*RUN, "--save", "mine.txt"], "--save mine.txt: a name that ends in .yaml or .yml is needed"),
        ([*RUN, "--case", "conf.yaml", "--save", "conf.yaml"], "--save conf.yaml: is read too"),
        ([*RUN, "--save", "study.yaml"], "--save study.yaml: asperity has not written this file, another"),
        ([*RUN, "--save", "mine.txt/a.yaml"], "mine.txt is a file, the name of a folder is needed there"),
        ([*RUN, "--save", ""], "--save = '': a name is needed"),
        (["run", "mine.txt", *STEEL, "--out", "mine.txt/b"], "mine.txt is a file"),
        (["run", "mine.txt", *STEEL, "--out", "used"], "holds section.png, which asperity run has"),
    ],
)
def test_lost_file_is_refused_before_computing(folder, capsys, words, line):
    Path("conf.yaml").write_text("sliding: {friction: 0.1}\n")
    Path("study.yaml").write_text("contact: {contact_area_fraction: 0.1}\n")
    Path("used").mkdir()
    Path("used/section.png").write_text("precious")
    before = {path: path.read_bytes() for path in folder.rglob("*") if path.is_file()}
    assert status(*words) in (1, 2)
    assert line in capsys.readouterr().err
    assert {path: path.read_bytes() for path in folder.rglob("*") if path.is_file()} == before
    assert not Path("out").exists()


@pytest.mark.usefixtures("never")
@pytest.mark.parametrize(
    ("words", "line"),
    [
        ("--mean-pressure 1e60MPa", "--mean-pressure = 1e+54 TPa: a mean pressure of less than 230800 TPa"),
        ("--mean-pressure 1e80MPa", "--mean-pressure = '1e80MPa': a pressure > 0 with its unit"),
        ("--force 1N --hardness 1kPa", "--force = 1 N: a mean pressure below the hardness 1 kPa is needed"),
        ("--normal-approach 1m", "--normal-approach = 1 m: less than"),
        ("--normal-approach 1e6m --periodic none", "--normal-approach = 1000000 m: a length from"),
        (f"--normal-approach 1e-60m {COATING}", "--normal-approach = 1e-45 fm: a length from"),
        (
            "--mean-pressure 1MPa --set map.points=32768",
            "map.points: a grid of 32768 × 32768 nodes needs about 220 GB of m",
        ),
        (
            "--mean-pressure 1MPa --set map.points=32768 --periodic none",
            "of 32768 × 32768 nodes needs about 440 GB",
        ),
    ],
)
def test_load_out_of_range_is_refused_before_computing(folder, capsys, words, line):
    assert status("run", "mine.txt", *BODY, *words.split(), "--out", "out") in (1, 2)
    said = capsys.readouterr().err
    assert line in said
    assert said.count("\n") == 1
    assert not Path("out").exists()


@pytest.mark.skipif(not os.path.exists("/dev/full"), reason="needs a device that is always full")
@pytest.mark.parametrize("unbuffered", ["", "1"])
def test_an_output_that_cannot_be_printed_is_named(folder, unbuffered):
    command = [sys.executable, "-m", "asperity", "info", "mine.txt"]
    with open("/dev/full", "w") as full:
        environment = os.environ | {"PYTHONUNBUFFERED": unbuffered}
        found = subprocess.run(command, stdout=full, stderr=subprocess.PIPE, text=True, env=environment)
    assert found.returncode == 1
    assert found.stderr == "asperity: standard output: cannot be written (No space left on device)\n"


def test_exports_and_pictures_replace_only_own_files(folder, chain, capsys):
    Path("foreign.csv").write_text("1,2\n3,4\n")
    contact = chain["contact"]
    for words, line in (
        (["export", contact, "--surface", "q.csv", "--profile", "y=0.5", "./q.csv"], "./q.csv: named"),
        (["export", contact, "--surface", "foreign.csv"], "--surface foreign.csv: asperity has not written"),
        (["export", contact, "--surface", contact], f"--surface {contact}: is read too"),
        (["view", contact, "gap", "--out", "v.png", "v.png"], "--out v.png: named twice"),
        (["view", contact, "gap", "--out", "v.xyz"], "v.xyz: the name of a picture is needed"),
        (["view", contact, "gap", "--out", "v.png", "./v.png"], "--out ./v.png: named twice"),
        (["view", contact, "gap", "--out", ""], "--out = '': the name of a file is needed"),
    ):
        assert status(*words) == 1
        assert line in capsys.readouterr().err
    assert {path.name for path in folder.iterdir()} == {"foreign.csv", "mine.txt", "other.txt"}
    for _ in range(2):  # its own files are replaced
        assert status("export", contact, "--surface", "q.csv", "--surface", "q.vti") == 0
        assert status("view", contact, "gap", "--out", "v.png", "v.pdf", "v.svg") == 0


def test_case_is_saved_in_its_own_folder(folder, without_pictures):
    for _ in range(2):
        assert status(*RUN, "--save", "out/case.yaml") == 0
    assert yaml.safe_load(Path("out/case.yaml").read_text())["map"]["file"] == "../mine.txt"
    assert status("run", "out/case.yaml", "--out", "out") == 0


def test_changed_map_of_a_case_is_refused(folder, capsys, without_pictures):
    assert status(*RUN, *COUNTER, "--save", "saved.yaml") == 0
    Path("other.txt").write_text(Path("other.txt").read_text().replace("0.1", "0.2"))
    for case in ("saved.yaml", "out/case.yaml"):
        capsys.readouterr()
        assert status("run", case, "--out", "again") == 2
        said = capsys.readouterr().err
        assert f"{case}: checksums.counter_map: " in said
        assert "other.txt has changed since" in said
    assert status("run", "saved.yaml", "--counter-map", "mine.txt", "--out", "again") == 0


@pytest.fixture(scope="module")
def answer():
    height = 1e-8 * np.random.default_rng(1).normal(size=(16, 16))
    surface = HeightMap(height, (16e-6, 16e-6), name="small", periodic=True)
    return asp.run(
        surface,
        Body(young=210e9, poisson=0.3, hardness=5e9, fatigue_torsion=3e8, fatigue_bending=5e8),
        Body(young=70e9, poisson=0.3),
        mean_pressure=50e6,
        load_curve={"loads": [20e6]},
        fields=("von_mises", "xx"),
    )


def test_names_of_an_answer_are_known_before(answer, tmp_path):
    written = [path for path in answer.write(tmp_path / "out") if path.is_file()]
    stems = stems_of(answer.case)
    assert [path.name for path in written if not path.stem.startswith((*stems, "."))] == []
    # Only the study cites the paper.
    assert [path.name for path in written if b"Venugopalan" in path.read_bytes()] == []


HOLD = """
import sys
from pathlib import Path
from asperity.engineering.folder import locked
with locked(Path(sys.argv[1])):
    (Path(sys.argv[1]) / ".unfinished-of-the-first").mkdir()
    print("held", flush=True)
    sys.stdin.read()
"""


def test_second_process_does_not_write(folder, answer, capsys, without_pictures):
    command = [sys.executable, "-c", HOLD, "out"]
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True) as first:
        assert first.stdout.readline() == "held\n"
        host, process, _ = system.process_name().replace(str(os.getpid()), str(first.pid)).rsplit(".", 2)
        assert status(*RUN) == 1
        said = capsys.readouterr().err
        assert f"out: process {process} on {host} writes into it; wait until it ends" in said
        assert said.count("\n") == 1
        with pytest.raises(DatasetError, match="writes into it"):
            answer.write("out")
        assert Path("out/.unfinished-of-the-first").is_dir()
        first.kill()
    assert len(list(Path("out").glob(LOCK.format("*")))) == 1
    assert status(*RUN) == 0
    assert not [*Path("out").glob(LOCK.format("*")), *Path("out").glob(f"{UNFINISHED}*")]


def test_a_lock_of_another_host_is_kept(folder, capsys):
    Path("out").mkdir()
    lock = Path("out") / LOCK.format("elsewhere.7.1700000000.ab")
    lock.touch()
    assert status(*RUN) == 1
    assert "process 7 on elsewhere writes into it; wait" in capsys.readouterr().err
    assert os.listdir("out") == [lock.name]
    lock.unlink()
    with locked(Path("out")), locked(Path("out")):  # one thread locks it again
        assert len(os.listdir("out")) == 1
    assert not os.listdir("out")
