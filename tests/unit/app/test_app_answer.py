"""Pictures of the page: lines over a map, and sections of an answer that was opened."""

import gc
import weakref
from types import SimpleNamespace

import numpy as np
import pytest
from samples import leave_pictures_out

import asperity as asp
from asperity.app.answer_job import AnswerJob, Reader
from asperity.app.map_job import MapJob, along
from asperity.app.session import Session
from asperity.core.errors import InputError
from asperity.engineering.answer import opened

EDGE = 2e-4

STEEL = {"young": "210 GPa", "poisson": 0.3}


@pytest.fixture(scope="module")
def answer(tmp_path_factory):
    """An answer with gross sliding in a folder, and the folder."""
    height = asp.self_affine((32, 32), 0.8, 1e-4, 2.5e-5, rms_height=1e-7, seed=1, length=EDGE)
    surface = asp.HeightMap(height, (EDGE, EDGE), periodic=True, unit="m", name="ground")
    found = asp.run(surface, STEEL, mean_pressure="50 MPa", sliding={"friction": 0.2})
    folder = tmp_path_factory.mktemp("answer")
    with pytest.MonkeyPatch.context() as patch:
        leave_pictures_out(patch)
        found.write(folder)
    return found, folder


def test_a_line_is_cut_at_the_edges_of_the_map():
    shown = {"values": np.tile(np.arange(8.0), (4, 1)), "x": 0.0, "y": 0.0, "dw": 8.0, "dh": 4.0}
    distance, values = along(shown, (-4.0, 2.0, 4.0, 2.0))
    assert distance[-1] == pytest.approx(4.0)
    assert values[-1] == pytest.approx(3.5)
    assert along(shown, (2.0, -9.0, 2.0, 9.0))[0][-1] == pytest.approx(4.0)
    assert along(shown, (0.0, 4.3, 8.0, 4.3))[0][-1] == pytest.approx(8.0)  # next to the edge
    for ends in ((9.0, 0.0, 9.0, 4.0), (1.0, 1.0, 1.0, 1.0), (-1.0, 5.0, 9.0, 5.0)):
        with pytest.raises(InputError, match="crosses the map"):
            along(shown, ends)


def test_planes_and_sections_are_those_of_the_answer(answer):
    found, folder = answer
    reader = Reader(lambda *_: None)
    summary = reader.open(str(folder), 3)
    assert summary["number"] == 3
    differences = reader.compare(["1", "2"], [str(folder)] * 2)["differences"]
    assert {each.first.quantity for each in differences} == {each.quantity for each in found.records}
    assert summary["title"] == ("ground", "mean pressure 50 MPa")
    assert summary["whole"]["verdict"] == list(found.verdict)
    assert summary["whole"]["tiles"] == found.tiles[:4]
    depth = summary["drawn"]["depths"]["lower"][4]
    job = AnswerJob(lambda *_: None)
    job.look(str(folder), summary["drawn"]["name"])
    plane = job.plane("lower", "von_mises", depth)["picture"]["values"]
    # Single precision, and planes on coarser grids to 1e-3 of the rms of the stress.
    assert plane == pytest.approx(found.plane(depth).values, abs=2e-3 * plane.max())
    row = 5 * EDGE / 32
    section = job.section("lower", "von_mises", (0.0, row, EDGE, row))["picture"]
    expected = found.section(at=row)
    values = np.interp(section["dw"] / 2, expected["x"], expected.sel(depth=depth))
    number = int(np.argmin(abs(np.linspace(0, section["dh"], 160) - depth)))
    assert section["values"][number, 200] == pytest.approx(values, rel=0.05)


def test_an_opened_answer_goes_with_its_last_reference(answer):
    """Else a process that opens many large ones keeps them until it searches for garbage."""
    gc.disable()
    found = opened(answer[1])
    assert found.contact.height.shape == (32, 32)
    known = weakref.ref(found.contact), weakref.ref(found)
    del found
    left = [each() for each in known]
    gc.enable()
    assert left == [None, None]


class Process:
    """A `Worker` without a process: it keeps the requests, and replies when a test says so."""

    made: list

    def __init__(self, kind):
        self.kind, self.sent, self.stopped, self.looks = kind, [], False, 0
        self.process = SimpleNamespace(is_alive=lambda: True)
        self.made.append(self)

    def listen(self, reply):
        self.reply = reply

    def send(self, request, **given):
        self.sent.append(request)

    def stop(self):
        self.stopped = True


def test_the_process_of_an_answer_that_is_given_up_shows_the_next(answer, monkeypatch, tmp_path):
    """Until it has followed, its replies are about the answer that it had before."""
    monkeypatch.setattr("asperity.app.session.Worker", Process)
    monkeypatch.setattr(Process, "made", made := [], raising=False)
    loop = SimpleNamespace(add_callback=lambda function, *given: function(*given))
    session = Session(loop, Process("reader"), {}, tmp_path, 1e9)
    summary = Reader(lambda *_: None).open(str(answer[1]), 0)
    for number in (0, 1):
        session.do_open(str(answer[1]))
        made[0].reply("open", summary | {"number": number})
        (worker,) = made[1:]
        assert (session.slots[number].worker, worker.looks) == (worker, 1)
        worker.reply("plane", "of the answer before")
        worker.reply("look", None)
        worker.reply("plane", number)
        assert session.slots[number].plane == number
    assert worker.sent == ["look", "plane", "section"] * 2
    assert (session.slots[0].worker, session.slots[0].plane) == (None, 0)
    session.do_beside("0")
    assert [each.kind for each in made] == ["reader", "answer", "answer"]
    session.do_beside("")
    assert [each.stopped for each in made] == [False, False, True]


def test_a_section_needs_all_planes_however_many_are_kept(answer, monkeypatch):
    _, folder = answer
    ends = (0.0, EDGE / 3, EDGE, EDGE / 2)
    job = AnswerJob(lambda *_: None)
    job.look(str(folder), "")
    whole = job.section("lower", "von_mises", ends)["picture"]
    monkeypatch.setattr("asperity.app.answer_job.MOST_KEPT", 0)
    job.section("lower", "von_mises", (0.0, 0.0, EDGE, EDGE))
    job.plane("lower", "von_mises", 0.0)
    again = job.section("lower", "von_mises", ends)["picture"]
    assert np.array_equal(again["values"], whole["values"])


def test_everything_that_run_refuses_is_refused_before(tmp_path):
    job = MapJob(lambda *_: None)
    height = asp.self_affine((16, 16), 0.8, 1e-4, 2.5e-5, rms_height=1e-7, seed=1, length=EDGE)
    files = [tmp_path / "a.npy", tmp_path / "sample.csv.npy", tmp_path / "b.npy"]
    for number, file in enumerate(files):
        np.save(file, height * (1 + 0.1 * number))
    case = {"map": {"unit": "m", "physical_size": [EDGE, EDGE]}, "body": STEEL, "load": {"force": "1 N"}}

    def problems(*maps, **groups):
        content = case | groups
        content["map"] = content["map"] | {"file": list(map(str, maps)) if len(maps) > 1 else str(maps[0])}
        more = {"sample": {}} if len(maps) > 1 else {}
        found = job.check(content | more, str(tmp_path / "out"), 1)
        return " ".join(key + text for key, text in found["problems"])

    assert problems(files[0]) == problems(files[0], files[2]) == ""
    # What is missing is listed at once, also where groups are checked only when all others are right.
    lacking = job.check({"film": {}, "cycles": {}, "sliding": {"friction": None}}, str(tmp_path / "out"), 1)
    assert {key for key, _ in lacking["problems"]} == {
        *("map.file", "body", "load", "sliding.friction", "film", "cycles")
    }
    assert "frction: unknown key" in problems(files[0], frction=0.1)
    assert "load" in problems(files[0], load={"force": "1 N", "mean_pressure": "1 MPa"})
    assert "different names" in problems(files[0], files[0])
    assert "cannot be the name of the folder" in problems(*files)
    (tmp_path / "c.npy").write_bytes(files[0].read_bytes())
    assert "are copies of one file" in problems(files[0], tmp_path / "c.npy")
    assert "no such file" in problems(files[0], tmp_path / "none.npy")
