"""From the files of every instrument family, by command, configuration and Python, to one answer.

The examples of the pages for users run as they stand.
"""

import re
import shlex
import shutil
from pathlib import Path

import numpy as np
import pytest
from project import ROOT

import asperity as asp
from asperity.cli.main import main
from asperity.core.packages import absent
from asperity.engineering import Body, run
from asperity.engineering.face import read_face
from asperity.results import dataset
from asperity.settings.study import read_study

DATA = ROOT / "tests/data"
OWN_MAP = (ROOT / "docs/own_map.md").read_text(encoding="utf-8")
OWN_STUDY = (ROOT / "docs/own_study.md").read_text(encoding="utf-8")
README = (ROOT / "README.md").read_text(encoding="utf-8")


@pytest.fixture
def answers(monkeypatch, tmp_path):
    """Answers of the commands that follow, in place of their pictures, which take seconds."""
    found = []

    def keep(answer, folder):
        found.append(answer)
        return [Path(folder) / "report.html"]

    monkeypatch.setattr("asperity.engineering.write_answer", keep)
    monkeypatch.chdir(tmp_path)
    shutil.copy(DATA / "steel.x3p", tmp_path)
    return found


COMMAND = ["run", "steel.x3p", "--despike", "8", "--out", "steel"]
LOADS = {
    "mean_pressure": ("pressure", "50 MPa", 50e6),
    "force": ("force", "0.3 N", 0.3),
    "approach": ("approach", "200 nm", 200e-9),
    "area_fraction": ("area_fraction", "0.03", 0.03),
}


@pytest.mark.parametrize("kind", LOADS)
def test_every_interface_imposes_the_same_load(kind, answers, tmp_path):
    setting, text, value = LOADS[kind]
    steel = ["--young", "210 GPa", "--poisson", "0.3"]
    assert main([*COMMAND, *steel, f"--{setting.replace('_', '-')}", text]) == 0
    (tmp_path / "steel.yaml").write_text(f"engineering: {{young: 210 GPa, poisson: 0.3, {setting}: {text}}}")
    assert main([*COMMAND, "--config", "steel.yaml"]) == 0
    settings = asp.MapOptions(despike=8)
    answers.append(run(DATA / "steel.x3p", Body(210e9, 0.3), **{kind: value}, map_options=settings))
    found = [answer.contact for answer in answers]
    indenter = read_face(DATA / "steel.x3p", settings).face
    # The library's force is that on the whole cell, its approach the position of the indenter.
    imposed = {"force": 4 * value, "approach": value + indenter.height.min()}.get(kind, value)
    layer = asp.Layer(210e9, 0.3)
    found.append(asp.solve(indenter.height, layer, indenter.grid.length, **{kind: imposed}))
    for contact in found[1:]:
        np.testing.assert_allclose(contact.pressure, found[0].pressure, rtol=1e-6)
    assert answers[0].numbers.area_fraction == pytest.approx(found[-1].area_fraction)
    reached = getattr(answers[0].numbers, {"mean_pressure": "nominal_pressure"}.get(kind, kind))
    assert reached == pytest.approx(value, rel=0.05 if kind == "area_fraction" else 1e-5)


FIRST_MINUTES = re.findall(r"^    (asperity (?:info|run) .*)$", README + OWN_MAP, re.MULTILINE)
ADDED = re.findall(r"^\| [^|]+ \| `(--[^|]*)\|", OWN_MAP, re.MULTILINE)


def test_the_first_commands_of_the_pages_run(answers, capsys):
    assert len(FIRST_MINUTES) == 4
    for line in dict.fromkeys(FIRST_MINUTES):
        assert main(shlex.split(line)[1:]) == 0
    printed = capsys.readouterr().out
    assert "rms gradient" in printed
    assert "every calculation needs" not in printed
    assert "asperity run takes peaks as upward, fills points without data and mirrors the map" in printed
    assert "report    steel/report.html" in printed
    assert len(answers) == 1


def test_stages_in_si_run_in_a_row(answers, capsys):
    stages = re.findall(r"^    (asperity (?:surface|solve|stress|peaks) .*)$", OWN_MAP, re.MULTILINE)
    assert len(stages) == 4
    for line in stages:
        assert main(shlex.split(line)[1:]) == 0
    printed = capsys.readouterr().out
    assert "mean pressure 50 MPa" in printed
    assert "GPa at depth" in printed


EFFECTS = {
    "--boundary free": lambda answer: answer.face.boundary == "free",
    "--form cylinder": lambda answer: "form of a cylinder along x" in answer.face.done[-1],
    "--counter-shift": lambda answer: answer.case.counter_map.shift == pytest.approx((10e-6, -4e-6)),
    "--friction": lambda answer: answer.case.friction == 0.3,
    "--sliding-direction": lambda answer: answer.case.sliding_direction == 30.0,
    "--despike": lambda answer: answer.face.treatment.spikes == 4,
}
"""Option of the table → its effect on an answer."""


@pytest.mark.parametrize("added", ADDED)
def test_every_option_of_the_table_can_be_added(added, answers):
    base = ["run", "steel.x3p", "--young", "210 GPa", "--poisson", "0.3", "--out", "steel/"]
    examples = re.findall(r"`(--[^`]+)`", "`" + added)
    shutil.copy("steel.x3p", "lapped.x3p")
    for example in examples:
        words = shlex.split(example)
        if words == ["--pressure"]:  # named as what the others replace
            continue
        if "--viscosity" in words and absent(["reynoldsflow"]):
            continue
        if words[0] == "--config":
            content = re.search(r"`({young[^`]+)`", added)[1]
            Path(words[1]).write_text(content, encoding="utf-8")
        loads = {"--force", "--approach", "--area-fraction", "--hertz-pressure"}
        load = [] if loads & set(words) else ["--pressure", "50 MPa"]
        more = shlex.split(examples[0]) if words[0] == "--form" else []  # "with it"
        more += shlex.split(examples[0]) if words[0] == "--counter-turned-about" else []
        assert main([*base, *more, *words, *load]) == 0
        for option, holds in EFFECTS.items():
            assert option not in " ".join([*more, *words]) or holds(answers[-1])
    assert answers


def test_results_of_the_python_example_are_drawn(monkeypatch, tmp_path, capsys):
    monkeypatch.chdir(tmp_path)
    shutil.copy(DATA / "steel.x3p", tmp_path)
    (example,) = re.findall(r"```python\n(.*?)```", OWN_MAP, re.DOTALL)
    exec(example, {})
    assert "real contact" in capsys.readouterr().out
    assert dataset.read(tmp_path / "steel/contact.nc").attrs["unit_system"] == "SI"
    # The example has two bodies, whose stress is in two files.
    lines = re.findall(r"^    (asperity (?:view|export) .*)$", OWN_MAP, re.MULTILINE)
    assert len(lines) == 4
    for line in lines:
        assert main(shlex.split(line.replace("stress.nc", "stress_lower.nc"))[1:]) == 0
    written = {"surface.csv", "line.csv", "all.csv", "field.vti"}
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
    assert half["contact"]["area_fraction"] == 0.05
    assert half["results"] == "results/half"
