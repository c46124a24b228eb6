"""State of the page, which the server keeps: every tab shows it, and a reload does not change it."""

from __future__ import annotations

import os
import re
import shutil
import time
from collections.abc import Callable, Mapping
from contextlib import suppress
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import yaml
from jinja2 import ChoiceLoader, Environment, PackageLoader

from asperity.app import form
from asperity.app.pictures import AnswerPictures, Ends, MapPictures, Units
from asperity.app.worker import Worker
from asperity.core.errors import DatasetError, InputError
from asperity.core.units import shown_si, to_si
from asperity.engineering.case_file import MAP_FILES, at, load_case
from asperity.engineering.folder import COMPLETE, MANIFEST, UNFINISHED, names_in
from asperity.engineering.show.tables import tiles_of, unknown_of
from asperity.results.atomic import locked
from asperity.surface.reading.container import maps_in

LONGEST_TEXT = 100_000
"""Characters of a field of the form; a longer text is refused."""

LISTED = 12
"""Most peaks in the table."""

FRAME = ("x", "y", "dw", "dh")
"""Corner and edges of a picture."""

UNITS = {"length": ("", "nm", "µm", "mm"), "stress": ("", "kPa", "MPa", "GPa")}
"""Units that can be chosen; an empty one suits the values."""

NEEDED = {
    "map.file": "a map",
    "load": "the load",
    "counter_body.map.file": "the map of the counter body",
    "sliding.friction": "the coefficient of friction of the sliding",
    "choose.counter_body": "the kind of the counter body: a rigid one makes the contact smaller",
    "choose.maps": "whether the maps are positions of one surface, or surfaces to be compared",
}
"""Key that is missing → what is needed, in words."""

KILLED = "was killed, perhaps for lack of memory. Inputs are kept."

TEMPLATES = Environment(
    loader=ChoiceLoader([PackageLoader("asperity.app", ""), PackageLoader("asperity.engineering.show", "")]),
    autoescape=True,
    trim_blocks=True,
    lstrip_blocks=True,
)
TEMPLATES.filters["si"] = partial(shown_si, digits=3)
TEMPLATES.globals |= {"tiles_of": tiles_of, "unknown_of": unknown_of}


@dataclass(eq=False)
class Slot:
    """An answer or a sample: being computed or opened, shown, or ended without one.

    Attributes
    ----------
    content : dict or None
        Groups of the case from which it is computed; None for one that was opened.
    summary : dict
        As of `asperity.app.answer_job.summary_of`.
    drawn : dict
        As of `asperity.app.answer_job.drawn_of`, for the map that is looked at.
    worker : Worker or None
        The process that computes it, or planes of it when they are asked for.
    first : Slot or None
        The answer beside which it is shown when it is computed.
    """

    label: str
    folder: Path | None
    state: str
    content: dict[str, Any] | None = None
    worker: Worker | None = None
    done: float = 0.0
    stage: str = ""
    since: float = field(default_factory=time.monotonic)
    summary: dict[str, Any] = field(default_factory=dict)
    drawn: dict[str, Any] = field(default_factory=dict)
    plane: dict[str, Any] | None = None
    section: dict[str, Any] | None = None
    message: str = ""
    first: Slot | None = None


class Tab:
    """The pictures of one tab of the browser."""

    def __init__(self, document: Any, session: Session) -> None:
        self.document = document
        self.map = MapPictures(session.drag_profile)
        self.answers = [
            AnswerPictures(end, session.drag_section, lambda number: session.do_peak(str(number)))
            for end in ("", "_beside")
        ]
        first, second = (pictures.scatter for pictures in self.answers)
        second.x_range, second.y_range = first.x_range, first.y_range
        for pictures in (self.map, *self.answers):
            for name, root in pictures.roots().items():  # type: ignore[attr-defined]
                root.name = name
                document.add_root(root)


class Session:
    """All inputs and answers of one server.

    Parameters
    ----------
    loop : IOLoop
        Of the server, which handles the replies of workers.
    reader : Worker
        The process that checks cases, and reads maps and answers.
    flags : mapping
        Dotted key of a setting → flag of ``asperity run``, for messages and the command line.
    folder : Path
        Of uploaded maps and of answers.
    memory : float
        Bytes that a computation may use.
    """

    def __init__(
        self, loop: Any, reader: Worker, flags: Mapping[str, str], folder: Path, memory: float
    ) -> None:
        self.loop, self.flags, self.folder, self.memory = loop, flags, folder, memory
        self.values: dict[str, str] = {}
        self.check: dict[str, Any] = {"problems": [("map.file", ": a map is needed")]}
        self.slots: list[Slot] = []
        self.shown: list[Slot | None] = [None, None]
        self.compared: dict[str, Any] = {}
        self.view = {"contact": "pressure", "body": "", "field": ""}
        self.depth, self.peak = 0.0, -1
        self.units = Units()
        self.notice = ""
        self.sockets: set[Any] = set()
        self.tabs: set[Tab] = set()
        self.last_seen = time.monotonic()
        self._heights: dict[str, Any] | None = None
        self._profile: Any = None
        self._lines: dict[str, Ends] = {}
        self._number, self._starts = 0, False
        self._left: list[dict[str, Any]] = []
        self._reader = self._listen(reader, self._of_reader)
        self.set({})

    def _listen(self, worker: Worker, handler: Callable[..., None]) -> Worker:
        worker.listen(lambda name, found: self.loop.add_callback(handler, name, found))
        return worker

    # What the page asks for

    def act(self, message: Any, socket: Any = None) -> None:
        """Do what a message of the page asks for; messages of another form are ignored."""
        if not isinstance(message, dict):
            return
        name, value = message.get("do"), str(message.get("value", ""))
        if isinstance(given := message.get("set"), dict):
            known = form.settings().keys() | form.SWITCHES.keys() | form.CHOICES.keys()
            texts = {key: text for key, text in given.items() if isinstance(text, str) and key in known}
            if long := [key for key, text in texts.items() if len(text) > LONGEST_TEXT]:
                self._say(
                    f"{_words(long[0])}: at most {LONGEST_TEXT} characters are accepted, nothing is changed"
                )
            else:
                self.set(texts, socket)
        elif isinstance(name, str) and hasattr(self, f"do_{name}"):
            getattr(self, f"do_{name}")(value)

    def set(self, values: Mapping[str, str], socket: Any = None) -> None:
        """Take texts of the form, and check the case that they make."""
        if values.get("choose.load") == "hertz" != form.chosen("choose.load", self.values):
            values, socket = {"load.force": "", "load.mean_pressure": ""} | dict(values), None
        if (file := values.get("map.file", "").strip()).endswith(".zip"):
            try:
                maps = {"map.file": "\n".join(maps_in(file)), "choose.maps": "pooled"}
                values, socket = dict(values) | maps, None
            except InputError as error:
                self._say(str(error))
        self.values |= values
        self._number += 1
        content = form.content_of(self.values)
        self._reader.send("check", content=content, out=str(self.folder / "answer"), number=self._number)
        self.tell({"values": dict(values)}, without=socket)
        self.tell({"html": {"repeat": self._repeat(), "stale": self._part("stale")}})

    def do_open(self, path: str) -> None:
        """Take a map, a case file, or the folder of an answer."""
        self._say("")
        if os.path.isdir(path):
            self._add(Slot(Path(path).name, Path(path), "opening"))
            self._reader.send("open", folder=path, number=len(self.slots) - 1)
        elif path.endswith((".yaml", ".yml")):
            try:
                values = {"choose.counter_body": "flat"} | form.values_of(load_case(path))
                self.set(dict.fromkeys(self.values, "") | values)
            except (InputError, OSError) as error:
                self._say(str(error))
        else:
            self.set({"map.file": path})

    def do_example(self, _: str) -> None:
        """Take a map that comes with asperity, with a steel and a load."""
        values = {"map.file": form.EXAMPLE, "body.material": "100Cr6", "load.mean_pressure": "50 MPa"}
        self.set({"choose.counter_body": "flat"} | values)

    def do_start(self, _: str) -> None:
        """Compute the answer of the case, once it is checked, unless one is being computed."""
        self._starts = self.check.get("number") != self._number
        if self._starts or self._running() or self._problems():
            return
        content = form.content_of(self.values)
        self._left = [content] if "sample" in content else form.contents_of(content)
        self._run_next(None)

    def _run_next(self, first: Slot | None) -> None:
        """Compute the next of the cases of one start, whose answers are shown beside the first of them."""
        content = self._left.pop(0)
        slot = self._add(Slot("", None, "running", content, first=first))
        self._worker_of(slot).send("run", content=content, out=str(self.folder), memory=self.memory)

    def do_stop(self, _: str) -> None:
        """Stop the computation."""
        if slot := self._running():
            (slot.worker or self._reader).stop()

    def do_show(self, number: str) -> None:
        """Show an answer, with the plane of its largest peak and the section through it."""
        if (slot := self._chosen(number)) is not None:
            self.shown = [slot, None if self.shown[1] is slot else self.shown[1]]
            self._compare()
            self._look_at_largest(slot)

    def do_beside(self, number: str) -> None:
        """Show an answer beside the other, and their differences; none for an empty number."""
        slot = self._chosen(number)
        self.shown[1] = None if slot is self.shown[0] else slot
        is_compared = self._compare()
        self._ask(True)
        if not is_compared:
            self._draw("contact", "planes")

    def do_view(self, value: str) -> None:
        """Show another field, body, or picture of the contact, or other units: ``name=value``."""
        name, _, chosen = value.partition("=")
        known: dict[str, Any] = dict(UNITS) | {"contact": ("pressure", "gap")}
        if (first := self.shown[0]) is not None:
            known |= {
                "field": first.drawn["fields"],
                "body": first.drawn["bodies"],
                "map": first.summary["maps"],
            }
        if chosen not in known.get(name, ()):
            return
        if name in UNITS:
            setattr(self.units, name, chosen)
            self._draw("heights", "curves", "contact", "planes")
            self._tell_answer()
        elif name == "map":
            for slot in filter(None, self.shown):
                if chosen in slot.summary["maps"]:
                    self._worker_of(slot).send("map", name=chosen)
        elif name == "contact":
            self.view[name] = chosen
            self._draw("contact")
        else:
            self.view[name], self.peak = chosen, -1
            self._draw("contact")  # its peaks
            self._ask(True)

    def do_depth(self, number: str) -> None:
        """Show the plane at a depth of the slider."""
        depths = self._depths()
        if number.isdecimal() and int(number) < len(depths):
            is_marked, self.depth, self.peak = self.peak >= 0, depths[int(number)], -1
            self._ask(False)
            if is_marked:
                self._tell_answer()

    def do_peak(self, number: str) -> None:
        """Mark a peak of the first answer in the table and in all pictures."""
        slot = self.shown[0]
        if slot is not None and number.isdecimal() and int(number) < len(self._peaks(slot)["depth"]):
            self.peak = int(number)
            self._look_at(slot, self.peak)

    def do_line(self, value: str) -> None:
        """Place the line of the profile or section: ``name=x, y, x, y`` with units."""
        name, _, text = value.partition("=")
        try:
            x, y, to_x, to_y = (to_si(each, "length", "line") for each in text.split(","))
        except ValueError as error:
            self._say(f"{error}: x, y, x, y of its ends are needed, such as 0 um, 9 um, 50 um, 9 um")
            return
        (self.drag_profile if name == "profile" else self.drag_section)((x, y, to_x, to_y))

    def drag_profile(self, ends: Ends) -> None:
        """Ask for the heights along a line."""
        if self._heights is not None:
            self._lines["profile"] = ends
            self._reader.send("profile", ends=ends)

    def drag_section(self, ends: Ends) -> None:
        """Ask for the section along a line, of all answers that are shown."""
        self._lines["section"] = ends
        self._ask(True)

    # What workers reply

    def _of_reader(self, name: str, found: Any) -> None:
        """Take the heights of a map, the result of a check, a profile, an answer, or a comparison."""
        if name == "profile":
            self._profile = found
            self._draw("curves")
        elif name == "heights" and found["number"] == self._number:
            known, self._heights, ends = self._heights, found, self._lines.get("profile")
            frame = [found["picture"][name] for name in FRAME]
            if ends is None or known is None or frame != [known["picture"][name] for name in FRAME]:
                x, y, width, height = frame
                ends = x, y + height / 2, x + width, y + height / 2
            self._draw("heights")
            self.drag_profile(ends)
        elif name == "check" and found["number"] == self._number:
            self.check = found
            self._draw("curves")
            self.tell(self._state_of_form())
            if self._starts:
                self.do_start("")
        elif name == "open":
            self._take(self.slots[found["number"]], found)
        elif name == "compare":
            if found["names"] == self._names():  # else of answers that were shown before
                self.compared = found
                self._tell_answer()
        elif name == "refused" and found[0] == "open":
            self._end(self.slots[found[2]["number"]], " ".join(found[1]))
        elif name == "refused":
            self._say(" ".join(found[1]))
        elif name == "ended":
            killed = "" if self._reader.stopped else f"The process that reads maps and answers {KILLED}"
            self._reader = self._listen(Worker("reader"), self._of_reader)
            for slot in [slot for slot in self.slots if slot.state == "opening"]:
                self._end(slot, killed or "Stopped.")
            self._say(killed)
            if not killed:
                self.set({})
        if name in ("compare", "refused", "ended"):  # pictures that waited for a comparison
            self._draw("contact", "planes")
        self.tell({"progress": self._progress()})

    def _of_answer(self, worker: Worker, name: str, found: Any) -> None:
        """Take progress, an answer, or a picture of it."""
        slot = next((each for each in self.slots if each.worker is worker), None)
        worker.looks -= (found[0] if name == "refused" else name) == "look"
        if slot is None or (worker.looks and name != "ended"):  # about an answer that was given up
            return
        if name == "folder":
            slot.folder = found
        elif name == "progress":
            slot.done, slot.stage = found
        elif name == "run":
            self._take(slot, found)
            if self._left:
                self._run_next(slot.first or slot)
        elif name == "map":
            slot.drawn = found
            if slot is self.shown[0]:
                self._look_at_largest(slot)
            self._ask(True)
        elif name in ("plane", "section"):
            setattr(slot, name, found)
            self._draw("planes")
            return
        elif name == "refused" and slot.state == "shown":
            self._say(" ".join(found[1]))
        elif name == "refused":
            slot.message = " ".join(found[1])
            worker.stop()
        elif name == "ended" and slot.state != "shown":
            if slot.state == "running" and slot.folder is not None:
                remove_made(slot.folder)
            killed = f"The computation (exit code {found}) {KILLED}"
            self._end(slot, "Stopped." if worker.stopped else killed)
        elif name == "ended" and not worker.stopped:
            self._say(f"The process that draws {slot.label} {KILLED} Choose the answer again for its planes.")
        self.tell({"progress": self._progress()})

    def _take(self, slot: Slot, found: dict[str, Any]) -> None:
        """Show an answer that was computed or opened."""
        slot.state, slot.summary, slot.drawn = "shown", found, found["drawn"]
        slot.label = ", ".join(found["title"])
        self.do_show(str(self.slots.index(slot.first or slot)))
        if slot.first is not None:
            self.do_beside(str(self.slots.index(slot)))

    def _end(self, slot: Slot, message: str) -> None:
        """Give up an answer, for a reason that may be known already."""
        slot.state, slot.message, self._left = "ended", slot.message or message, []

    # What the page shows

    def tell(self, message: Mapping[str, Any], without: Any = None) -> None:
        """Send a message to all tabs."""
        for socket in self.sockets - {without}:
            socket.tell(message)

    def state(self) -> dict[str, Any]:
        """Everything that a new tab shows besides its pictures."""
        found = self._state_of_form() | {"values": self.values, "beside": self.shown[1] is not None}
        found["html"] |= self._parts_of_answer()
        found["html"] |= {"repeat": self._repeat(), "notice": self._part("notice")}
        return found | {"progress": self._progress(), "plane": self._slider()}

    def add_tab(self, document: Any) -> None:
        """Fill the document of a new tab."""
        tab = Tab(document, self)
        self.tabs.add(tab)
        document.on_session_destroyed(lambda _: self.tabs.discard(tab))
        self._fill(tab, "heights", "curves", "contact", "planes")

    def watch(self) -> None:
        """Report progress, and end a computation that uses too much memory."""
        self.last_seen = time.monotonic() if self.sockets else self.last_seen
        if (slot := self._running()) is not None:
            worker = slot.worker or self._reader
            if (used := worker.memory()) > self.memory:
                slot.message = (
                    f"The computation used {used / 2**30:.1f} GiB, more than its limit of "
                    f"{self.memory / 2**30:.1f} GiB, and was ended. Fewer points need less. Inputs are kept."
                )
                worker.stop()
            self.tell({"progress": self._progress()})

    def close(self) -> None:
        """End all processes."""
        for worker in filter(None, (self._reader, *(slot.worker for slot in self.slots))):
            worker.stop()

    def _part(self, name: str, **values: Any) -> str:
        """A part of the page as HTML; texts in it are escaped."""
        return TEMPLATES.get_template("updates.html.j2").render(part=name, session=self, **values)

    def _say(self, text: str) -> None:
        self.notice = text
        self.tell({"html": {"notice": self._part("notice")}})

    def _add(self, slot: Slot) -> Slot:
        self.slots.append(slot)
        self.tell({"progress": self._progress()})
        return slot

    def _worker_of(self, slot: Slot) -> Worker:
        """The process of an answer: one of an answer that is not shown any more, or a new one."""
        worker = slot.worker
        if worker is None or worker.stopped or not worker.process.is_alive():
            worker = self._given_up() if slot.state == "shown" else None
            if worker is None:
                worker = Worker("answer")
                self._listen(worker, partial(self._of_answer, worker))
            slot.worker = worker
            if slot.state == "shown":
                worker.looks += 1
                worker.send("look", folder=str(slot.folder), name=slot.drawn["name"])
        return worker

    def _given_up(self) -> Worker | None:
        """The process of an answer that is not shown any more, which loses it."""
        for slot in self.slots:
            if slot.worker is not None and slot.state == "shown" and slot not in self.shown:
                worker, slot.worker = slot.worker, None
                if worker.process.is_alive() and not worker.stopped:
                    return worker
        return None

    def _running(self) -> Slot | None:
        return next((slot for slot in self.slots if slot.state in ("running", "opening")), None)

    def _chosen(self, number: str) -> Slot | None:
        """An answer that is to be shown."""
        known = {str(index): slot for index, slot in enumerate(self.slots) if slot.state == "shown"}
        return known.get(number)

    def _problems(self) -> list[tuple[str, str]]:
        """Keys and texts of everything that is missing or wrong."""
        needed = ["choose.counter_body", *(["choose.maps"] if form.has_several(self.values) else [])]
        asked = [(key, ": missing") for key in needed if not self.values.get(key)]
        return [*self.check["problems"], *asked]

    def _state_of_form(self) -> dict[str, Any]:
        """Missing and wrong settings, at their fields where these have a text; doubts; table constants."""
        listed, at_fields = [], {}
        imposed = f"load.{form.LOADS[form.chosen('choose.load', self.values)][0]}"
        for key, text in self._problems():
            listed.append(_needed(key, text))
            first = imposed if key.startswith("load.") and "," in key else key.split(",")[0]
            first = "map.file" if first == "map" else first
            if self.values.get(first):
                at_fields[first] = _words(text).lstrip(" :=")
        listed, doubts = [*dict.fromkeys(listed)], self.check.get("doubts", ())
        return {
            "html": {name: self._part(name, listed=listed) for name in ("info", "hertz", "ready", "stale")},
            "problems": at_fields,
            "doubts": [(f"map.{each.option}", each.sentence, each.proposed) for each in doubts],
            "constants": self.check.get("constants", {}),
            "ready": not listed,
            "has_map": bool(self.values.get("map.file")),
            "several": form.has_several(self.values),
        }

    @property
    def outdated(self) -> list[str]:
        """Numbers of the answers that are shown whose inputs have changed since."""
        content, shown = form.content_of(self.values), filter(None, self.shown)
        same = (None, content, *form.contents_of(content))
        changed = [slot for slot in shown if slot.content not in same]
        return [str(self.slots.index(slot) + 1) for slot in changed]

    def _repeat(self) -> str:
        """The command line and the case file of the answer; they name uploaded maps without a folder."""
        content = form.content_of(self.values)
        for keys in MAP_FILES:
            if (group := at(content, keys[:-1])) and "file" in group:
                files = group["file"]
                group["file"] = [*map(self._path, files)] if isinstance(files, list) else self._path(files)
        text = yaml.safe_dump(content, sort_keys=False, allow_unicode=True)
        return self._part("repeat", command=form.command_of(content, self.flags), case=text)

    def _path(self, path: str) -> str:
        """The whole path of a map, or the name of one that was uploaded."""
        is_uploaded = Path(path).is_relative_to(self.folder)
        return Path(path).name if is_uploaded else os.path.abspath(path) if os.path.exists(path) else path

    def _progress(self) -> dict[str, Any]:
        slot = self._running()
        if slot is None:
            return {"running": False, "text": self.slots[-1].message if self.slots else ""}
        passed = time.monotonic() - slot.since
        return {"running": True, "done": slot.done, "passed": passed, "stage": slot.stage}

    def _looked_at(self, slot: Slot) -> tuple[str, str]:
        """Body and field that are looked at, as far as an answer has them."""
        bodies, fields = slot.drawn["bodies"], slot.drawn["fields"]
        body, name = self.view["body"], self.view["field"]
        return body if body in bodies else bodies[0], name if name in fields else fields[0]

    def _look_at_largest(self, slot: Slot) -> None:
        """Show the plane of the largest peak of an answer."""
        self.peak = -1
        self.view["body"], self.view["field"] = self._looked_at(slot)
        self._look_at(slot, 0)
        self._draw("contact", "planes")

    def _compare(self) -> bool:
        """Ask for the differences of the two answers that are shown; they come before the pictures."""
        first, second = self.shown
        self.compared = {}
        if first is None or second is None:
            return False
        folders = [str(first.folder), str(second.folder)]
        self._reader.send("compare", names=self._names(), folders=folders)
        return True

    def _names(self) -> list[str]:
        """Numbers and maps of the answers that are shown, with their loads if these differ."""
        shown = [(self.slots.index(slot) + 1, *slot.summary["title"]) for slot in self.shown if slot]
        is_one_load = len({load for *_, load in shown}) == 1
        return [
            f"{number}: {maps}" if is_one_load else f"{number}: {maps}, {load}"
            for number, maps, load in shown
        ]

    def _look_at(self, slot: Slot, number: int) -> None:
        """Show the plane of a peak, and the section through it along x; without peaks the surface."""
        peaks, frame = self._peaks(slot), slot.drawn["pressure"]
        has_peak = number < len(peaks["depth"])
        self.depth = float(peaks["depth"][number]) if has_peak else 0.0
        y = float(peaks["y"][number]) if has_peak else frame["y"] + frame["dh"] / 2
        self._lines["section"] = (frame["x"], y, frame["x"] + frame["dw"], y)
        self._ask(True)

    def _ask(self, with_section: bool) -> None:
        """Ask for the plane, and the section, of the answers that are shown."""
        if with_section:
            self._tell_answer()
        self.tell({"plane": self._slider()})
        for slot in filter(None, self.shown):
            body, name = self._looked_at(slot)
            deepest = slot.drawn["depths"][body][-1]
            worker = self._worker_of(slot)
            worker.send("plane", body=body, field=name, depth=min(self.depth, deepest))
            if with_section and "section" in self._lines:
                worker.send("section", body=body, field=name, ends=self._lines["section"])
        while (given_up := self._given_up()) is not None:
            given_up.stop()
        self._draw("mark")

    def _tell_answer(self) -> None:
        self.tell({"html": self._parts_of_answer(), "beside": self.shown[1] is not None})

    def _peaks(self, slot: Slot) -> dict[str, Any]:
        """Peaks of the field and body that are looked at, the largest first; in m and Pa."""
        return slot.drawn["peaks"].get(
            self._looked_at(slot), dict.fromkeys(("x", "y", "depth", "value"), np.empty(0))
        )

    def _depths(self) -> list[float]:
        return [] if self.shown[0] is None else self.shown[0].drawn["depths"][self.view["body"]]

    def _slider(self) -> dict[str, Any]:
        """The depth slider: its end, the position next to the depth, and the depth in words."""
        if not (depths := self._depths()):
            return {}
        nearest = int(np.abs(np.subtract(depths, self.depth)).argmin())
        return {"last": len(depths) - 1, "at": nearest, "text": shown_si(self.depth, "m", 3)}

    def _parts_of_answer(self) -> dict[str, str]:
        """Tiles, warnings, numbers, peaks and files of the answers that are shown."""
        answers = list(filter(None, self.shown))
        known = self._peaks(answers[0]) if answers else {"value": ()}
        peaks = [
            {name: self.in_words(values[number], name) for name, values in known.items()}
            for number in range(min(LISTED, len(known["value"])))
        ]
        names = ("answer", "stale", "peaks", "choices")
        return {each: self._part(each, answers=answers, peaks=peaks, units=UNITS) for each in names}

    def in_words(self, value: float, name: str) -> str:
        """A length, or the value of a peak, in the chosen unit."""
        factor, symbol = self.units.of(value, "Pa" if name == "value" else "m")
        return f"{value / factor:.4g} {symbol}"

    def _draw(self, *parts: str) -> None:
        """Draw parts of the pictures of all tabs when their documents are free."""
        for tab in self.tabs:
            tab.document.add_next_tick_callback(partial(self._fill, tab, *parts))

    def _fill(self, tab: Tab, *parts: str) -> None:
        """Draw heights, curves, contact, planes, or the mark of a peak in a tab, as far as they are known."""
        answers = [(slot, own) for slot, own in zip(self.shown, tab.answers, strict=True) if slot is not None]
        for slot, own in answers:
            own.prefix = f"{self.slots.index(slot) + 1}: " if len(answers) > 1 else ""
        if "heights" in parts and self._heights is not None:
            tab.map.show(self._heights, self.units)
        if "curves" in parts:
            if "spectrum" in self.check:
                wavelength, power = self.check["spectrum"]
                tab.map.show_spectrum(wavelength, power, self.units)
            if self._profile is not None:
                distance, height = self._profile
                tab.map.show_profile(distance, height, self._lines["profile"], self.units)
        if "contact" in parts:
            which = self.view["contact"]
            highest = max(
                (float(np.nanmax(slot.drawn[which]["values"], initial=0.0)) for slot, _ in answers),
                default=0.0,
            )
            peaks = [self._peaks(slot) for slot, _ in answers]
            deepest, largest = (
                max((float(np.abs(each[name]).max(initial=0)) for each in peaks), default=0.0)
                for name in ("depth", "value")
            )
            for (slot, own), found in zip(answers, peaks, strict=True):
                own.show_contact(slot.drawn[which], which, self.units, (0.0, highest))
                own.show_peaks(found, self.units, slot.drawn["pressure"], (deepest, largest))
        if "planes" in parts:
            drawn = [(slot, own) for slot, own in answers if slot.plane is not None]
            values = [self._peaks(slot)["value"] for slot, _ in drawn]
            values += [
                each["picture"]["values"] for slot, _ in drawn for each in (slot.plane, slot.section) if each
            ]
            low = min([0.0, *(float(each.min()) for each in values if each.size)])
            high = max([0.0, *(float(each.max()) for each in values if each.size)])
            deepest = max((slot.section["picture"]["dh"] for slot, _ in drawn if slot.section), default=0.0)
            for slot, pictures in drawn:
                plane: Any = slot.plane
                body, name = self._looked_at(slot)
                level = slot.drawn["yield"].get(body) if name == "von_mises" else None
                words = name.replace("von_mises", "von Mises").replace("_", " ")
                title = f"{words} at depth {shown_si(plane['depth'], 'm', 3)}"
                shown = (plane, slot.section, self._lines["section"])
                pictures.show_planes(*shown, self.units, title, level, (low, high), deepest)
        tab.answers[0].mark(self.peak)


def _needed(key: str, text: str) -> str:
    """What is missing or wrong, in words."""
    if text.startswith(form.MISSING):
        group, _, name = key.rpartition(".")
        if key == "body" or name in ("young", "poisson"):
            of = _words(group or key)
            return f"the material of the {of}, or its Young's modulus and Poisson's ratio"
        if key in NEEDED:
            return NEEDED[key]
    return _words(f"{key}{text}").lstrip(": ")


def _words(text: str) -> str:
    """A message with words in place of keys: ``body.layers.0.young`` is "body, layer 1, young"."""
    layers = {f"layer_{number + 1}" for number in range(form.LAYERS)}
    known = {part for key in form.settings() for part in key.split(".")} | layers

    def words(found: re.Match[str]) -> str:
        is_key = known.issuperset(found[0].split("."))  # and no name of a file
        return ", ".join(map(form.label_of, found[0].split("."))) if is_key else found[0]

    text = re.sub(r"\blayers\.(\d)\b", lambda found: f"layer_{int(found[1]) + 1}", text)
    return re.sub(r"\b[a-z]+(?:[._][a-z\d]+)+\b", words, text)


def remove_made(folder: Path) -> None:
    """Remove what an ended process has written into the folder of an answer or a sample; other files stay."""
    below = (each for each in folder.iterdir() if each.is_dir() and not each.name.startswith("."))
    for place in (*below, folder):
        with suppress(DatasetError, OSError):
            with locked(place):
                for name in {*names_in(place), MANIFEST}:
                    (place / name).unlink(missing_ok=True)
                for unfinished in (*place.glob(f"{UNFINISHED}*"), place / COMPLETE):
                    shutil.rmtree(unfinished, ignore_errors=True)
            place.rmdir()
