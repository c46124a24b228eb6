"""``asperity run``: from a file of a ground steel surface to a folder with an answer."""

import os
import re
import shutil
from contextlib import chdir, suppress
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from samples import write_map

from asperity import Body, run
from asperity.cli.main import main
from asperity.core.units import to_si
from asperity.results import dataset
from asperity.surface.reading.height_map import HeightMap

POINTS, EDGE = 128, 128e-6


@pytest.fixture(scope="module")
def steel():
    """Ground steel: grooves along y, fine roughness, a tilt, non-measured points; heights in µm."""
    rng = np.random.default_rng(7)
    along_x = np.convolve(rng.normal(size=POINTS + 8), np.hanning(9), "valid")
    fine = rng.normal(size=(POINTS, POINTS))
    for axis in (0, 1):
        fine = sum(np.roll(fine, shift, axis) for shift in range(-3, 4)) / 7
    height = 0.25 * along_x + 0.4 * fine + 0.02 * np.arange(POINTS)[:, None]
    height[rng.integers(0, POINTS, 20), rng.integers(0, POINTS, 20)] = np.nan
    return height


@pytest.fixture(scope="module")
def path(steel, tmp_path_factory):
    return Path(write_map(tmp_path_factory.mktemp("maps") / "steel.asc", steel, steel.shape))


COMMAND = ["--young", "210 GPa", "--poisson", "0.3", "--mean-pressure", "50 MPa", "--yield-stress", "1.5 GPa"]


@pytest.fixture(scope="module")
def folder(path, tmp_path_factory):
    out = tmp_path_factory.mktemp("answers") / "steel"
    assert main(["run", str(path), *COMMAND, "--out", str(out)]) == 0
    return out


def test_result_files_are_in_si_and_agree(folder):
    contact, stress = (dataset.read(folder / f"{stage}.nc") for stage in ("contact", "stress"))
    assert contact.attrs["unit_system"] == stress.attrs["unit_system"] == "SI"
    assert (contact["pressure"].attrs["units"], contact["x"].attrs["units"]) == ("Pa", "m")
    assert float(contact["mean_pressure"]) == pytest.approx(50e6, rel=1e-4)
    assert contact.attrs["force"] == pytest.approx(50e6 * EDGE**2, rel=1e-4)
    assert contact["pressure"].shape == (POINTS, POINTS)
    answer = pd.read_csv(folder / "answer.csv").set_index("quantity")["value"]
    assert answer["maximum pressure"] == pytest.approx(float(contact["pressure"].max()), rel=1e-6)
    spots = pd.read_csv(folder / "contact_spots.csv")
    np.testing.assert_allclose(contact["spot_load"], spots["load_N"], rtol=1e-6)
    peaks = pd.read_csv(folder / "peaks.csv")
    largest = answer["maximum von Mises stress"]
    assert largest == pytest.approx(peaks[peaks["quantity"] == "von_mises"]["value_Pa"].max(), rel=0.05)
    assert largest == pytest.approx(float(stress["maximum_von_mises"].max()), rel=0.1)


def test_the_report_is_whole_without_a_network(folder):
    page = (folder / "report.html").read_text(encoding="utf-8")
    assert page.count("data:image/png;base64,") == 6
    assert not re.findall(r'(?:src|href)="(?!data:)', page)
    assert not re.findall(r"\b(?:fetch|import)\(|XMLHttpRequest|@import|url\(", page)
    assert "http" not in re.sub(r"doi\S+|base64,\S+", "", page)
    assert page.index(" ± ") < page.index("the stress is elastic") < page.index("All numbers</h2>")
    assert page.index("All numbers</h2>") < page.index("<h2>Pictures") < page.index("ertificate")
    for words in ("levelled: tilt", "Cite as", "asperity", "GPa"):
        assert words in page


TABLES = {"answer.csv", "warnings.csv", "peaks.csv", "contact_spots.csv", "gaps.csv"}
RESULTS = {"surface.nc", "contact.nc", "stress.nc", "answer.json", *TABLES}


def loads_in(folder):
    """Loads of all results in a folder that say theirs."""
    settings = [dataset.settings_of(dataset.read(path)) for path in folder.glob("*.nc")]
    found = {to_si(each["load"]["mean_pressure"], "pressure") for each in settings}
    tables = [pd.read_csv(path).set_index("quantity")["value"] for path in folder.glob("answer.csv")]
    return found | {round(table["mean pressure"], -3) for table in tables}


@pytest.fixture(scope="module")
def two_answers():
    rng = np.random.default_rng(1)
    surface = HeightMap(1e-8 * rng.normal(size=(16, 16)), (16e-6, 16e-6), name="small", periodic=True)
    return [run(surface, Body(young=210e9, poisson=0.3), mean_pressure=load) for load in (50e6, 60e6)]


class Killed(BaseException):
    """Raised in place of a kill: no code of asperity catches it."""


def test_killed_run_leaves_old_or_new_answer(two_answers, tmp_path, monkeypatch, without_pictures):
    """Killed before each call that changes the folder, one after the other."""
    folder, step, calls = tmp_path / "answer", 0, []
    genuine = {name: getattr(os, name) for name in ("replace", "rename", "unlink")}

    def counted(name):
        def function(*arguments, **options):
            calls.extend([name] * (Path(arguments[-1]).parent == folder))
            if len(calls) == step:
                raise Killed
            return genuine[name](*arguments, **options)

        return function

    for answer, name in zip(two_answers, ("old", "new"), strict=True):
        written = {path.name for path in answer.write(tmp_path / name)}
    for name, files in {"write_data": RESULTS, "write_report": written - RESULTS}.items():

        def copied(_, target, *__, files=files):
            for file in files:
                shutil.copy(tmp_path / "new" / file, target)

        monkeypatch.setattr(f"asperity.engineering.answer.{name}", copied)
    while step <= len(calls):
        step += 1
        shutil.rmtree(folder, ignore_errors=True)
        shutil.copytree(tmp_path / "old", folder)
        calls.clear()
        with monkeypatch.context() as patch, suppress(Killed):
            for name in genuine:
                patch.setattr(os, name, counted(name))
            two_answers[1].write(folder)
        assert len(loads_in(folder)) <= 1
        assert {path.name for path in folder.rglob("*")} >= RESULTS
    assert step > 15
    assert loads_in(folder) == {60e6}


def test_links_modes_and_other_files_are_kept(two_answers, tmp_path, without_pictures):
    (tmp_path / "link").symlink_to(tmp_path / "target", target_is_directory=True)
    written = two_answers[0].write(tmp_path / "link")
    assert (tmp_path / "link").is_symlink()
    assert {path.resolve().parent for path in written} == {tmp_path / "target"}
    (tmp_path / "target/contact.nc").chmod(0o640)
    (tmp_path / "target/thesis.tex").write_text("precious")
    (tmp_path / "target/.unfinished-killed").mkdir()
    two_answers[1].write(tmp_path / "link")
    assert (tmp_path / "target/contact.nc").stat().st_mode & 0o777 == 0o640
    assert (tmp_path / "target/thesis.tex").read_text() == "precious"
    assert not list(tmp_path.glob("target/.unfinished*"))
    (tmp_path / "target/contact.nc").chmod(0o440)
    with pytest.raises(ValueError, match=r"holds contact\.nc, which is read-only"):
        two_answers[0].write(tmp_path / "link")
    assert loads_in(tmp_path / "target") == {60e6}


@pytest.fixture
def refused(capsys):
    """Text on stderr when a command is refused."""

    def found(*command):
        with pytest.raises(SystemExit, match=r"^2$"):
            main([*map(str, command)])
        return capsys.readouterr().err

    return found


def test_files_that_run_has_not_written_are_kept(path, tmp_path, refused):
    (tmp_path / "contact.nc").write_text("of asperity view")
    command = ["run", path, *COMMAND, "--out"]
    assert "holds contact.nc, which asperity run has not written" in refused(*command, tmp_path)
    assert "holds the map; another folder is needed" in refused(*command, path.parent)
    assert (tmp_path / "contact.nc").read_text() == "of asperity view"


def test_everything_wrong_is_named_at_once(tmp_path, refused):
    wrong = (
        "--young 210 --poisson 0.7 --mean-pressure 50m --force 3N --counter-young 70GPa --counter-poisson x"
        " --set body.layers.0.young=1GPa --set lek.viscosity=1 --set cycles.shifts=1"
    )
    lines = refused("run", tmp_path / "none.x3p", *wrong.split()).splitlines()
    starts = [line.removeprefix("asperity: ").split(" ")[0].rstrip(":,") for line in lines]
    assert starts == [
        *("--young", "--poisson", "body.layers.0.poisson", "body.layers.0.thickness", "--counter-poisson"),
        *("--mean-pressure", "cycles.shifts", "lek", str(tmp_path / "none.x3p")),
    ]
    assert "(kPa, MPa, GPa, N/mm^2) is needed" in lines[0]
    assert "did you mean leak?" in lines[-2]


@pytest.mark.parametrize(
    ("words", "line"),
    [
        ("body.fatigue_torsion=3MPa body.fatigue_bending=9MPa", "body.fatigue_torsion: 0.5 to 1 times"),
        ("counter_body.fatigue_torsion=3MPa counter_body.fatigue_bending=4MPa", "--counter-young: missing"),
        ("body.hardness=1MPa", "or set --hardness inf for an elastic contact"),
        ("map.form=cylinder", "map.form: needs --set map.radius=…"),
        ("map.cylinder_axis=x", "map.cylinder_axis: needs --set map.form=cylinder"),
        ("map.file=b.txt", "--set map.file: the map is given as MAP, too"),
        ("sample.area=1m2", "area = 1 m²: an area > 0 and"),
    ],
)
def test_a_case_that_contradicts_itself_is_refused(words, line, path, tmp_path, refused):
    given = [word for setting in words.split() for word in ("--set", setting)]
    assert line in refused("run", path, *COMMAND, *given, "--out", tmp_path / "out")
    assert not (tmp_path / "out").exists()


def test_a_case_file_can_say_the_materials(path, tmp_path, capsys, refused):
    config = tmp_path / "steel.yaml"
    config.write_text(
        "body: {young: 210 GPa, poisson: 0.3}\nload: {force: 1 N}\n"
        "counter_body: {young: 70 GPa, poisson: 0.33}"
    )
    out = tmp_path / "out"
    given = ["run", str(path), "--case", str(config)]
    more = ["--set", "counter_body.yield_stress=1 GPa", "--set", "fields=[xx]"]
    assert main([*given, *more, "--out", str(out)]) == 0
    printed = capsys.readouterr().out
    assert "E = 210 GPa, ν = 0.3 against E = 70 GPa, ν = 0.33, force imposed: 1 N" in printed
    assert (out / "stress_lower.nc").exists()
    drawn = {f"{kind}_xx_{body}" for kind in ("section", "plane", "peaks") for body in ("lower", "upper")}
    assert {path.stem for path in out.glob("*.png")} == {"height", "pressure", "plastic_depth", *drawn}
    assert set(pd.read_csv(out / "peaks.csv")["quantity"]) == {"pressure", "xx"}
    assert dataset.read(out / "stress_upper.nc").attrs["yield_stress"] == 1e9
    config.write_text("body: {young: 210}\nload: {mean_pressure: 1 GPa}\ncolour: red")
    errors = refused(*given, "--poisson", "0.3", "--out", out)
    assert "steel.yaml: body.young = 210: a pressure > 0" in errors
    assert "steel.yaml: colour: unknown key" in errors


def test_a_saved_case_is_repeated(steel, tmp_path, refused, without_pictures):
    """With every kind of option: texts, numbers, lists, files; from another folder than it was saved in."""
    path = write_map(tmp_path / "steel.asc", steel[:32, :32], (32, 32))
    shutil.copy(path, tmp_path / "lapped.asc")
    given = (
        "--despike 8 --periodic none --friction 0.2 --sliding-direction 30 --counter-young 70GPa "
        "--counter-poisson 0.33 --counter-map lapped.asc --set map.wavelength_short=8um --set map.points=16 "
        "--set counter_body.map.turned_about=x --set fields=[xx] --set"
    )
    command = ["run", str(path), *COMMAND, *given.split(), "counter_body.map.shift=[2 um, -4 um]"]
    (tmp_path / "cases").mkdir()
    with chdir(tmp_path):
        assert main([*command, "--out", "first", "--save", "cases/case.yaml"]) == 0
    case = tmp_path / "cases/case.yaml"
    assert main(["run", str(case), "--out", str(tmp_path / "second")]) == 0
    assert main(["run", str(tmp_path / "first/case.yaml"), "--out", str(tmp_path / "third")]) == 0
    answers = [(tmp_path / name / "answer.csv").read_text() for name in ("first", "second", "third")]
    assert answers[0] == answers[1] == answers[2]
    case.write_text(case.read_text().replace("despike", "despik"))
    said = refused("run", case, "--out", tmp_path / "second")
    assert "case.yaml: map.despik: unknown key; did you mean despike?" in said


def test_several_maps_are_compared(steel, tmp_path, capsys, refused, request):
    """Twice the heights: the second of two columns; the page shows the pictures of both."""
    maps = {"steel": steel[:64, :64], "rough": 2 * steel[:64, :64]}
    files = [write_map(tmp_path / f"{name}.asc", height, (64, 64)) for name, height in maps.items()]
    command = ["run", *files, *COMMAND, "--out", str(tmp_path / "both")]
    assert main(command) == 0
    _, _, compared = capsys.readouterr().out.rpartition("report.html\n\n")
    *compared, _, report = compared.splitlines()
    assert report.endswith("comparison.html")
    assert " against " in " ".join(compared[:2])
    assert any("difference" in line for line in compared)
    assert max(map(len, compared)) <= 100
    frame = pd.read_csv(tmp_path / "both/comparison.csv")
    (height,) = frame[frame["quantity"] == "Sq"].itertuples()
    assert height.value_rough == pytest.approx(2 * height.value_steel, rel=1e-4)
    page = (tmp_path / "both/comparison.html").read_text(encoding="utf-8")
    assert page.count("<img ") == 3
    request.getfixturevalue("without_pictures")
    assert main(command) == 0  # its own files are replaced
    (tmp_path / "mine").mkdir()
    (tmp_path / "mine/comparison.csv").write_text("precious")
    said = refused(*command[:-1], tmp_path / "mine", "--save", "case.yaml")
    assert "holds comparison.csv, which asperity run has not written" in said
    assert "--save: one MAP is needed" in said
