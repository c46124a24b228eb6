"""``asperity run --pooled``: patches of two faces of a bearing to one folder; kept answers; refusals."""

import copy
import json
import sys
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
import yaml
from samples import leave_pictures_out

import asperity as asp
from asperity.cli.main import main
from asperity.engineering.sample import SampleData
from asperity.engineering.show.comparison import compared

sys.path.append(str(Path(__file__).parents[1] / "data"))
import bearing

STEEL = ["--young", "210 GPa", "--poisson", "0.3", "--yield-stress", "2 GPa", "--hardness", "6 GPa"]
PAIR = ["--counter-young", "210 GPa", "--counter-poisson", "0.3"]
PAIR += ["--set", "counter_body.yield_stress=2 GPa", "--set", "counter_body.hardness=6 GPa"]
COMMAND = [*STEEL, *PAIR, "--friction", "0.08", "--mean-pressure", "400 MPa", "--despike", "5", "--pooled"]


@pytest.fixture(scope="module", autouse=True)
def without_pictures():
    """They take most of the time, and `test_run_command` draws them."""
    with pytest.MonkeyPatch.context() as patch:
        leave_pictures_out(patch)
        yield


@pytest.fixture(scope="module")
def maps(tmp_path_factory):
    return bearing.write_maps(tmp_path_factory.mktemp("maps"), (60, 80))


@pytest.fixture(scope="module")
def folder(maps, tmp_path_factory):
    out = tmp_path_factory.mktemp("answers") / "bearing"
    files = [*map(str, maps["ring"]), "--counter-map", *map(str, maps["counter"])]
    assert main(["run", *files, *COMMAND, "--set", "sample.area=0.1 mm2", "--out", str(out)]) == 0
    return out


def test_the_folder_holds_means_of_all_maps(folder):
    sample = pd.read_csv(folder / "sample.csv").drop_duplicates("quantity").set_index("quantity")
    files = [folder / f"ring_{number}/answer.csv" for number in (1, 2, 3)]
    each = [pd.read_csv(file).drop_duplicates("quantity").set_index("quantity") for file in files]
    for column in ("value", "extrapolated"):
        areas = [answer[column]["contact area fraction"] for answer in each]
        assert sample[column]["contact area fraction"] == pytest.approx(np.mean(areas), rel=1e-6)
    area = sample.loc["contact area fraction"]
    assert area["error"] > area["error_between_measurement_positions"] > 0
    assert area["error_discretisation"] > 0  # under the hardness, too
    maximum = pd.read_csv(folder / "maximum.csv").drop_duplicates("quantity").set_index("quantity")
    assert maximum["value_Pa"]["pressure"] == pytest.approx(6e9)  # is the hardness
    assert (maximum["low_Pa"] <= maximum["value_Pa"]).all()
    page = (folder / "sample.html").read_text(encoding="utf-8")
    assert page.index("±") < page.index("<h2>All numbers</h2>")
    assert "95 % between" in page
    assert "<script" not in page
    shown = (folder / "ring_1/report.html").read_text(encoding="utf-8")
    assert shown.count("maximum shear stress (Tresca)") == 1  # of two bodies of the same material
    assert "upper body: only numbers that differ" in shown.lower()
    assert "stress beyond yield</b>: 3 of 3 maps; ring_1: " in page.replace("Stress", "stress")


def test_two_pools_are_compared(folder, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert main(["run", str(folder), str(folder / "ring_1"), "--out", "cmp"]) == 0
    shown = capsys.readouterr().out
    assert "differences between positions are not known" in " ".join(shown.split())
    assert "contact area fraction" in shown
    table = pd.read_csv("cmp/comparison.csv").drop_duplicates("quantity").set_index("quantity")
    own = pd.read_csv(folder / "ring_1/answer.csv").drop_duplicates("quantity").set_index("quantity")
    pressure = table.loc["maximum pressure"].filter(like="value_").iloc[1]
    assert pressure == pytest.approx(own["extrapolated"].fillna(own["value"])["maximum pressure"])


@pytest.mark.parametrize("option", [["--friction", "0"], ["--pooled"], ["--set", "body.young=1 GPa"]])
def test_options_of_maps_are_refused_beside_answers(option, folder, capsys):
    with pytest.raises(SystemExit, match="2"):
        main(["run", str(folder), str(folder / "ring_1"), *option])
    assert f"{option[0]}: maps are needed beside it" in capsys.readouterr().err


def test_samples_under_other_loads_are_not_compared(folder):
    sample = asp.open_answer(folder)
    more = {name: copy.copy(answer) for name, answer in sample.answers.items()}
    for answer in more.values():
        answer.__dict__["case"] = answer.case.replaced(load={"mean_pressure": 1e6})
    with pytest.raises(ValueError, match="samples under one load are needed"):
        compared([sample, SampleData(more)])


def test_case_file_repeats_and_keeps_answers(folder, maps, capsys):
    """The same bits from answers of other processes; a changed map is named."""
    case = yaml.safe_load((folder / "case.yaml").read_text(encoding="utf-8"))
    assert len(case["map"]["file"]) == len(case["checksums"]["counter_map"]) == 3
    before = (folder / "sample.csv").read_bytes()
    (folder / "ring_2/case.yaml").unlink()
    assert main(["run", str(folder / "case.yaml"), "--out", str(folder), "--only", "ring_2"]) == 0
    assert "ring_1" not in capsys.readouterr().out
    reports = [folder / f"ring_{number}/report.html" for number in (1, 2, 3)]
    written = [path.stat().st_mtime_ns for path in reports]
    assert main(["run", str(folder / "case.yaml"), "--out", str(folder), "--resume"]) == 0
    assert [path.stat().st_mtime_ns for path in reports] == written  # kept
    assert (folder / "sample.csv").read_bytes() == before
    changed = maps["counter"][1]
    content = changed.read_bytes()
    bearing.write_x3p(changed, *bearing.patch("counter", 7, (60, 80)), **bearing.X3P)
    with pytest.raises(SystemExit):
        main(["run", str(folder / "case.yaml"), "--out", str(folder), "--check"])
    changed.write_bytes(content)
    assert f"{changed.name} has changed since" in capsys.readouterr().err


def test_results_without_a_report_are_kept(folder, maps, tmp_path, monkeypatch):
    """Two processes write the same bits as one; a killed one leaves results whose pictures are drawn."""
    monkeypatch.setattr("asperity.engineering.face.SMALLEST_PARALLEL", 0)
    monkeypatch.setattr("os.cpu_count", lambda: 2)
    command = ["run", str(folder / "case.yaml"), "--out", str(tmp_path / "again")]
    assert main(command) == 0
    for name in ("sample.csv", "ring_1/peaks.csv", "ring_2/answer.csv", "ring_3/answer.csv"):
        assert (tmp_path / "again" / name).read_bytes() == (folder / name).read_bytes()
    manifest, contact = (tmp_path / "again/ring_2" / name for name in (".asperity-run.json", "contact.nc"))
    names, written = json.loads(manifest.read_text()), contact.stat().st_mtime_ns
    del names["report.html"]
    manifest.write_text(json.dumps(names))
    (tmp_path / "again/ring_2/report.html").unlink()
    assert main([*command, "--resume"]) == 0
    assert (tmp_path / "again/ring_2/report.html").exists()
    assert contact.stat().st_mtime_ns == written


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (["--set", "sample.area=2 mm2"], "area = 2 mm²: an area > 0 and ≤ 0.36 mm² is needed, 100 times"),
        (["--set", "sample.area=2 mm"], "sample.area = '2 mm': an area > 0 with its unit"),
        (["--counter-map", "a", "b"], "--counter-map: 2 files are given; one, or one for each MAP"),
        (["--only", "ring_4"], "--only ring_4: one of ring_1, ring_2, ring_3 is needed"),
    ],
)
def test_impossible_pool_is_refused_before_computing(options, message, maps, tmp_path, capsys):
    with pytest.raises(SystemExit) as caught:
        main(["run", *map(str, maps["ring"]), *COMMAND, *options, "--out", str(tmp_path / "out")])
    assert caught.value.code == 2
    assert message in capsys.readouterr().err
    assert not (tmp_path / "out").exists()
