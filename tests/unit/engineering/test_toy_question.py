"""A question needs its class and its field of the case alone to be in commands, files, cost and the form."""

import json
import os
import subprocess
import sys

import numpy as np
import pytest
from project import ROOT

TOY = ROOT / "tests/unit/engineering/toy_question.py"
FACTS = """
import json, sys
import toy_question
from asperity.engineering import case
case.Case = toy_question.Case
from asperity import open_answer
from asperity.cli.main import main
from asperity.app import form
from asperity.core.errors import InputError
from asperity.engineering.folder import stems_of
from asperity.engineering.stages import work_of
from asperity.engineering.templates import explanation, hint
from asperity.settings.model import described
assert main(sys.argv[1:]) == 0
answer = open_answer("out")
body = {"young": "210 GPa", "poisson": 0.3}
content = {"map": {"file": "map.txt"}, "body": body, "load": {"mean_pressure": "50 MPa"}, "toy": {"times": 4}}
again = form.content_of(form.values_of(content))
facts = {
    "settings": answer.case.toy.times,
    "number": answer["toy pressure"].value / answer["mean pressure"].value,
    "tiles": [each.quantity for each in answer.tiles],
    "dataset": float(answer.datasets["toy"]["mean_pressure"]),
    "work": [work_of(case.Case.read(each)).get("toy") for each in (content, content | {"toy": None})],
    "stems": "toy" in stems_of(answer.case),
    "form": form.QUESTIONS["toy"],
    "inputs": [each.key for each in form.inputs("toy")],
    "again": again["toy"],
    "explanation": explanation("toy.times"),
    "hint": hint("--times")[0],
    "schema": described(case.Case)["properties"]["toy"]["description"],
}
try:
    case.Case.read(content | {"toy": {"time": 3}})
except InputError as error:
    facts["refused"] = str(error)
print(json.dumps(facts))
"""


@pytest.fixture(scope="module")
def answered(tmp_path_factory):
    """Folder of a run that asks the question, what the command printed, and what others know of it."""
    folder = tmp_path_factory.mktemp("toy")
    y, x = np.mgrid[:16, :16] * 2 * np.pi / 16
    header = "# Width: 16 um\n# Height: 16 um\n# Value units: um"
    np.savetxt(folder / "map.txt", 0.1 * np.cos(x) * np.cos(y), header=header, comments="")
    words = "run map.txt --young 210GPa --poisson 0.3 --mean-pressure 50MPa --set toy.times=3 --out out"
    command = [sys.executable, "-c", FACTS, *words.split()]
    path = os.pathsep.join([str(TOY.parent), str(ROOT / "src")])
    found = subprocess.run(
        command, cwd=folder, env=os.environ | {"PYTHONPATH": path}, capture_output=True, text=True
    )
    assert found.returncode == 0, found.stderr
    *said, facts = found.stdout.splitlines()
    return folder, "\n".join(said), json.loads(facts)


def test_command_report_and_files_show_it(answered):
    folder, said, _ = answered
    assert "It is a toy." in said
    assert "toy pressure" in said
    page = (folder / "out/report.html").read_text("utf-8")
    for text in (
        "It is a toy.",
        "toy pressure",
        "150 MPa",
        "toys are for play.",
        "A line to the toy pressure",
    ):
        assert text in page, text
    assert {"toy.nc", "toy.png"} <= {path.name for path in (folder / "out").iterdir()}
    assert "toys,,toy pressure,150" in (folder / "out/answer.csv").read_text("utf-8")
    assert "times: 3" in (folder / "out/case.yaml").read_text("utf-8")


def test_form_cost_schema_and_reader_know_it(answered):
    *_, facts = answered
    assert facts["settings"] == facts["number"] == 3
    assert facts["tiles"][0] == "toy pressure"
    assert facts["dataset"] == pytest.approx(150e6)
    assert facts["work"] == [7.0, None]
    assert facts["stems"]
    assert facts["form"] == "Is it a toy?"
    assert facts["inputs"] == ["toy.times"]
    assert facts["again"] == {"times": 4}
    assert facts["explanation"].startswith("toy.times: Toy pressure over mean pressure (")
    assert facts["hint"] == "toy.times"
    assert facts["schema"] == "A toy."
    assert facts["refused"].endswith("toy.time: unknown key; did you mean times?")
