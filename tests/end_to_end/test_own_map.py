"""From the files of every instrument family, by command, case file and Python, to one answer.

The examples of the pages for users run as they stand.
"""

import re
import shlex
import shutil
from pathlib import Path

import numpy as np
import pytest
import yaml
from project import ROOT

import asperity as asp
from asperity.cli.main import main
from asperity.core.packages import absent
from asperity.engineering.face import read_face
from asperity.results import dataset
from asperity.settings.map import Map
from asperity.settings.study import read_study

DATA = ROOT / "tests/data"
PAGES = {path.name: path.read_text(encoding="utf-8") for path in (ROOT / "docs").glob("*.md")}
OWN_MAP, OWN_STUDY = PAGES["first_map.md"], PAGES["own_study.md"]
README = (ROOT / "README.md").read_text(encoding="utf-8")


@pytest.fixture
def answers(monkeypatch, tmp_path):
    """Answers of the commands that follow, in place of their pictures, which take seconds."""
    found = []

    def keep(answer, folder, *_):
        found.append(answer)
        return [Path(folder) / "report.html"]

    for module in ("jobs", "answer"):  # the first one imports from the other
        monkeypatch.setattr(f"asperity.engineering.{module}.write_answer", keep)
    monkeypatch.chdir(tmp_path)
    for name in ("steel", "lapped", "ring", "honed"):
        shutil.copy(DATA / "steel.x3p", tmp_path / f"{name}.x3p")
    for number in (1, 2, 3):
        ground = ROOT / f"src/asperity/engineering/maps/ground_{number}.x3p"
        shutil.copy(ground, tmp_path / f"ring_{number}.x3p")
    return found


COMMAND = ["run", "steel.x3p", "--despike", "8", "--out", "steel"]
LOADS = {
    "mean_pressure": ("50 MPa", 50e6),
    "force": ("0.3 N", 0.3),
    "normal_approach": ("200 nm", 200e-9),
    "contact_area_fraction": ("0.03", 0.03),
}


@pytest.mark.parametrize("kind", LOADS)
def test_every_interface_imposes_the_same_load(kind, answers, tmp_path):
    text, value = LOADS[kind]
    steel = ["--young", "210 GPa", "--poisson", "0.3"]
    assert main([*COMMAND, *steel, f"--{kind.replace('_', '-')}", text]) == 0
    bodies = "map: {file: steel.x3p, despike: 8}\nbody: {young: 210 GPa, poisson: 0.3}\n"
    (tmp_path / "steel.yaml").write_text(f"{bodies}load: {{{kind}: {text}}}\n")
    assert main(["run", "steel.yaml"]) == 0
    settings = {"file": DATA / "steel.x3p", "despike": 8}
    answers.append(asp.run(settings, asp.Body(young=210e9, poisson=0.3), **{kind: value}))
    found = [answer.contact for answer in answers]
    indenter = read_face(Map(**settings)).face
    imposed = {kind: value}
    if kind == "normal_approach":  # the library's approach is the position of the indenter
        imposed = {"approach": value + indenter.height.min()}
    layer = asp.Solid(210e9, 0.3)
    found.append(asp.solve_contact(indenter.height, layer, indenter.grid, **imposed))
    for contact in found[1:]:
        np.testing.assert_allclose(contact.pressure, found[0].pressure, rtol=1e-6)
    area = answers[0]["contact area fraction"].value
    assert area == pytest.approx(found[-1].contact_area_fraction)
    reached = answers[0][kind.replace("_", " ")].value
    assert reached == pytest.approx(value, rel=0.05 if kind == "contact_area_fraction" else 1e-5)


FIRST_MINUTES = re.findall(r"^    (asperity (?:info|run) .*)$", README + OWN_MAP, re.MULTILINE)
ADDED = [
    flags
    for row in re.findall(r"^\| [^|]+ \| (`--[^|]*)\|", OWN_MAP, re.MULTILINE)
    for flags in re.findall(r"`(--[^`]+)`", row)
]


def test_the_first_commands_of_the_pages_run(answers, capsys, tmp_path):
    """The answer that the README shows is the one that is printed."""
    assert len(FIRST_MINUTES) == 5
    assert main(["case", "plain"]) == 0
    (tmp_path / "case.yaml").write_text(capsys.readouterr().out)
    for line in dict.fromkeys(FIRST_MINUTES):
        assert main(shlex.split(line)[1:]) == 0
    printed = capsys.readouterr().out
    assert "rms gradient" in printed
    assert "every calculation needs" not in printed
    assert "asperity run takes peaks as upward, fills non-measured points and mirrors the map" in printed
    assert "report  steel/report.html" in printed
    (shown,) = re.findall(r"```text\n(.*?)```", README, re.DOTALL)
    assert [line for line in shown.splitlines() if line not in printed.splitlines()] == []
    assert len(answers) == 3
    assert len(ADDED) >= 12


def test_files_of_the_library_are_read_by_commands(answers, capsys):
    """View, export and verify."""
    height = asp.self_affine((64, 64), 0.8, 20e-6, 4e-6, rms_height=80e-9, seed=1, length=80e-6)
    contact = asp.solve_contact(height, asp.Solid(210e9, 0.3), 80e-6, mean_pressure=50e6)
    stress = asp.analyse_stress(contact)
    first, second = re.findall(r"`((?:contact\.to|asp\.write)_[^`]*)`", OWN_MAP)
    exec(f"{first}; {second}", {"asp": asp, "contact": contact, "stress": stress})
    for line in (
        "view contact.nc section y=40um x=0-60um",
        "export contact.nc stress.nc --peaks all.csv --surface surface.csv",
        "verify contact.nc stress.nc",
    ):
        assert main(line.split()) == 0
    assert "certificate computed anew" in capsys.readouterr().out


@pytest.mark.parametrize("flags", ADDED)
def test_every_flag_of_the_table_can_be_added(flags, answers):
    words = shlex.split(flags)
    load = (
        []
        if {"--force", "--normal-approach", "--contact-area-fraction"} & {*words}
        else ["--mean-pressure", "50 MPa"]
    )
    assert main(["run", "steel.x3p", "--young", "210 GPa", "--poisson", "0.3", *load, *words, "--check"]) == 0


CASES = {path.stem: path for path in sorted((ROOT / "docs/cases").glob("*.yaml"))}


@pytest.mark.parametrize("name", CASES)
def test_every_case_of_the_pages_is_accepted(name, answers, tmp_path):
    """A page shows the groups beside the link to the file; `test_answer_folder` computes the answers."""
    shutil.copy(CASES[name], tmp_path)
    link = rf"`([^`\n]+)`[^`\n]*\(cases/{name}.yaml\)"
    (shown,) = {groups for page in PAGES.values() for groups in re.findall(link, page)}
    case = yaml.safe_load(CASES[name].read_text(encoding="utf-8"))
    for group, values in yaml.safe_load(f"{{{shown}}}").items():
        assert case[group] == values or values.items() <= case[group].items()
    if name == "leak" and absent(["pyamg"]):
        pytest.skip("needs pyamg")
    assert main(["run", f"{name}.yaml", "--check"]) == 0


def test_pages_show_every_case():
    linked = {name for page in PAGES.values() for name in re.findall(r"\(cases/(\w+)\.yaml\)", page)}
    assert linked == {*CASES}


def test_results_of_the_python_example_are_drawn(monkeypatch, tmp_path, capsys, without_pictures):
    monkeypatch.chdir(tmp_path)
    shutil.copy(DATA / "steel.x3p", tmp_path)
    (example,) = re.findall(r"```python\n(.*?)```", OWN_MAP, re.DOTALL)
    exec(example, {})
    assert "contact area fraction" in capsys.readouterr().out
    assert dataset.read(tmp_path / "steel/contact.nc").attrs["unit_system"] == "SI"
    # The example has two bodies, whose stress is in two files.
    shown = f"{OWN_MAP}\n{PAGES['export.md']}"
    lines = re.findall(r"^    (asperity (?:view|export) .*)$", shown, re.MULTILINE)
    assert len(lines) == 5
    for line in lines:
        assert main(shlex.split(line.replace("stress.nc", "stress_lower.nc"))[1:]) == 0
    written = {"surface.csv", "line.csv", "peaks.csv", "field.vti"}
    assert written <= {path.name for path in tmp_path.iterdir()}


def test_the_studies_of_the_pages_are_accepted(monkeypatch, tmp_path):
    monkeypatch.chdir(ROOT)
    (own,) = re.findall(r"```yaml\n(.*?)```", OWN_STUDY, re.DOTALL)
    (changed,) = re.findall(r"((?:^    (?:based_on|contact):.*\n?)+)", OWN_STUDY, re.MULTILINE)
    for name, text in {"mine": own, "half": re.sub("^    ", "", changed, flags=re.M)}.items():
        (tmp_path / f"{name}.yaml").write_text(text, encoding="utf-8")
    mine, half = (read_study([tmp_path / f"{name}.yaml"]) for name in ("mine", "half"))
    assert mine["studies"] == {"all": ["ground", "lapped"]}
    assert mine["results"] == "results/mine"
    assert half["contact"]["contact_area_fraction"] == 0.05
    assert half["results"] == "results/half"
