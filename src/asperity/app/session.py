"""State of the page, which the server keeps: every tab shows it, and a reload does not change it."""

from __future__ import annotations

import math
import os
import re
import shutil
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import yaml
from jinja2 import Environment, PackageLoader

from asperity.app import form
from asperity.app.pictures import AnswerPictures, Ends, MapPictures, Units, later
from asperity.app.worker import Worker
from asperity.core.errors import InputError
from asperity.core.markup import with_error
from asperity.core.units import shown_si
from asperity.engineering.case_file import at, load_case, names_of_maps, put
from asperity.engineering.question import IN_PER_CENT
from asperity.settings.materials import table

LONGEST_TEXT = 4000
"""Characters of a field of the form."""

DRAWN = 200
"""Peaks in the pictures, the largest ones."""

LISTED = 12
"""Peaks in the table of the page."""

TILES = (
    *(
        "real contact",
        "largest pressure",
        "largest von Mises stress",
        "at depth",
        "volume above yield per area",
    ),
    *("largest Dang Van stress over limit", "shakedown factor, at least"),
)
"""Numbers that stand at the top of an answer."""

UNITS = {"length": ("", "nm", "µm", "mm"), "stress": ("", "kPa", "MPa", "GPa")}
"""Units that can be chosen; an empty one suits the values."""

TEMPLATES = Environment(
    loader=PackageLoader("asperity.app", ""), autoescape=True, trim_blocks=True, lstrip_blocks=True
)
TEMPLATES.filters["si"] = lambda value, unit: shown_si(value, unit, 3)
TEMPLATES.filters["zip_same"] = lambda names: [
    (name, name.replace("_", " ") or "automatic") for name in names
]


@dataclass
class Slot:
    """An answer: being computed, shown, or ended without one."""

    name: str
    worker: Worker
    folder: Path
    state: str = "running"
    done: float = 0.0
    since: float = field(default_factory=time.monotonic)
    summary: dict[str, Any] = field(default_factory=dict)
    plane: dict[str, Any] | None = None
    line: tuple[Ends, dict[str, Any]] | None = None
    message: str = ""


class Tab:
    """The pictures of one tab of the browser."""

    def __init__(self, document: Any, session: Session) -> None:
        self.document = document
        self.map = MapPictures(session.drag_profile)
        self.answers = [
            AnswerPictures(place, session.drag_section, session.mark) for place in ("", "_beside")
        ]
        roots = self.map.roots() | self.answers[0].roots() | self.answers[1].roots()
        for name, root in roots.items():
            root.name = name
            document.add_root(root)


class Session:
    """All inputs and answers of one server.

    Parameters
    ----------
    loop : IOLoop
        Of the server; replies of workers are handled in it.
    flags : mapping
        Dotted key of a setting → flag of ``asperity run``, for messages and the command line.
    folder : Path
        Of uploaded maps and of answers.
    memory : float
        Bytes that a computation may use.
    """

    def __init__(self, loop: Any, flags: Mapping[str, str], folder: Path, memory: float) -> None:
        self.loop, self.flags, self.folder, self.memory = loop, flags, folder, memory
        self.values: dict[str, str] = {}
        self.check: dict[str, Any] = {}
        self.slots: list[Slot] = []
        self.shown: list[int | None] = [None, None]
        self.view: dict[str, Any] = {
            "contact": "pressure",
            "body": "",
            "field": "",
            "depth": 0.0,
            "peak": None,
        }
        self.units = Units()
        self.notice = ""
        self.sockets: set[Any] = set()
        self.tabs: set[Tab] = set()
        self.last_seen = time.monotonic()
        self._profile: tuple[Ends, dict[str, Any]] | None = None
        self._ends: Ends | None = None
        self._number = 0
        self._map = self._worker("map", self._of_map)

    def _worker(self, kind: str, handler: Callable[..., None], *arguments: Any) -> Worker:
        return Worker(kind, lambda name, found: self.loop.add_callback(handler, *arguments, name, found))

    # What the page asks for

    def act(self, message: Any, socket: Any = None) -> None:
        """Do what a message of the page asks for; messages of another form are ignored."""
        if not isinstance(message, dict):
            return
        given, name = message.get("set"), message.get("do")
        if isinstance(given, dict):
            known = form.settings().keys() | form.SWITCHES.keys() | form.CHOICES.keys()
            kept = {
                key: text for key, text in given.items()
                if key in known and isinstance(text, str) and len(text) <= LONGEST_TEXT
            }  # fmt: skip
            self.set(kept, socket)
        elif isinstance(name, str) and name in ACTIONS:
            ACTIONS[name](self, str(message.get("value", ""))[:LONGEST_TEXT])

    def set(self, values: Mapping[str, str], socket: Any = None) -> None:
        """Take texts of the form, and check the case that they make."""
        self.values |= values
        self.tell({"values": dict(values)}, without=socket)
        self._number += 1
        self._map.send("check", content=form.content_of(self.values), number=self._number)
        self.tell({"html": {"repeat": self._repeat()}})

    def open(self, path: str) -> None:
        """Take a map, a case file, or the folder of an answer."""
        self.notice = ""
        if os.path.isdir(path):
            slot = self._add(Path(path).name or path, Path(path))
            slot.state = "opening"
            slot.worker.send("open", folder=path)
        elif path.endswith((".yaml", ".yml")):
            try:
                content = load_case(path)
            except (InputError, OSError) as error:
                self._say(str(error))
                return
            self.values = dict.fromkeys(self.values, "")
            self.set(form.values_of(content))
        else:
            self.set({"map.file": path})

    def example(self, _: str = "") -> None:
        """Take a map that comes with asperity, with a steel and a load."""
        import asperity.engineering

        path = Path(asperity.engineering.__file__).parent / "maps" / "ground_1.x3p"
        self.set({"map.file": str(path), "body.material": "100Cr6", "load.mean_pressure": "50 MPa"})

    def start(self, _: str = "") -> None:
        """Compute the answer of the case, unless one is being computed."""
        if any(slot.state == "running" for slot in self.slots) or self._problems()[0]:
            return
        content = form.content_of(self.values)
        files = content["map"]["file"]
        maps = files if isinstance(files, list) else [files]
        names = names_of_maps(maps)
        name = "sample" if len(maps) > 1 else names[0]
        slot = self._add(name, self.folder / f"answer_{len(self.slots) + 1}")
        if len(maps) == 1:
            slot.worker.send("run", content=content, folder=str(slot.folder))
        else:
            contents = {}
            for each, file in zip(names, maps, strict=True):
                contents[each] = {**content, "map": {**content["map"], "file": file}}
            slot.worker.send("sample", contents=contents, folder=str(slot.folder))
        self._tell_progress()

    def stop(self, _: str = "") -> None:
        """Stop the computation."""
        for slot in self.slots:
            if slot.state == "running":
                slot.worker.stop()

    def show(self, number: str) -> None:
        """Show an answer."""
        self._show(0, number)

    def beside(self, number: str) -> None:
        """Show an answer beside the other; none for an empty number."""
        self._show(1, number)

    def _show(self, place: int, number: str) -> None:
        chosen = int(number) if number.isdecimal() and int(number) < len(self.slots) else None
        if chosen is not None and self.slots[chosen].state != "shown":
            return
        self.shown[place] = chosen
        if place == 0 and chosen is not None:
            summary = self.slots[chosen].summary
            if self.view["body"] not in summary["bodies"]:
                self.view["body"] = summary["bodies"][0]
            if self.view["field"] not in summary["fields"]:
                self.view["field"] = summary["fields"][0]
            self.view["peak"] = None
            peaks, frame = self._peaks(self.slots[chosen]), summary["pressure"]
            self.view["depth"] = float(peaks["depth"][0]) if len(peaks["depth"]) else 0.0
            middle = float(peaks["y"][0]) if len(peaks["y"]) else frame["y"] + frame["dh"] / 2
            self._ends = (frame["x"], middle, frame["x"] + frame["dw"], middle)
        self._ask_planes()
        if self._ends is not None:
            self.drag_section(self._ends)
        self._draw_answers()

    def choose_view(self, name: str, value: str) -> None:
        """Show another field, body, or picture of the contact."""
        self.view[name], self.view["peak"] = value, None
        self._ask_planes()
        if self._ends is not None:
            self.drag_section(self._ends)
        self._draw_answers()

    def depth(self, number: str) -> None:
        """Show the plane at a depth of the slider."""
        slot = self._slot(0)
        depths = [] if slot is None else slot.summary["depths"].get(self.view["body"], [])
        if number.isdecimal() and int(number) < len(depths):
            self.view["depth"], self.view["peak"] = depths[int(number)], None
            self._ask_planes()
            self._each_tab(lambda tab: tab.answers[0].mark(None))

    def mark(self, number: int) -> None:
        """Mark a peak of the first answer in all pictures, and show its plane."""
        slot = self._slot(0)
        peaks = None if slot is None else self._peaks(slot)
        if peaks is None or not 0 <= number < len(peaks["depth"]):
            return
        self.view["peak"], self.view["depth"] = number, float(peaks["depth"][number])
        self._ask_planes()
        self._each_tab(lambda tab: tab.answers[0].mark(number))
        self.tell({"html": self._parts_of_answer()})

    def choose_unit(self, name: str, value: str) -> None:
        """Show lengths or stresses in another unit."""
        if value in UNITS[name]:
            setattr(self.units, name, value)
            self._each_tab(self._draw_map)
            self._draw_answers()

    def drag_profile(self, ends: Ends) -> None:
        """Ask for the heights along a line."""
        self._profile = (ends, {})
        self._map.send("profile", ends=ends)

    def drag_section(self, ends: Ends) -> None:
        """Ask for the section along a line, of all answers that are shown."""
        self._ends = ends
        for place in (0, 1):
            if (slot := self._slot(place)) is not None:
                slot.line = None
                slot.worker.send("line", **self._looked_at(slot), ends=ends)

    # What workers reply

    def _of_map(self, name: str, found: Any) -> None:
        """Take the result of a check, or a profile."""
        if name == "check" and found["number"] == self._number:
            is_new = found.get("name") != self.check.get("name")
            self.check = found
            if "picture" in found and (is_new or self._profile is None):
                frame = found["picture"]
                middle = frame["y"] + frame["dh"] / 2
                self._profile = ((frame["x"], middle, frame["x"] + frame["dw"], middle), {})
            if self._profile is not None:
                self.drag_profile(self._profile[0])
            self._each_tab(self._draw_map)
            self.tell(self._state_of_form())
        elif name == "profile" and self._profile is not None:
            self._profile = (self._profile[0], found)
            self._each_tab(self._draw_map)
        elif name == "refused":
            self._say(" ".join(found[1]))
        elif name == "ended":
            self._say(
                "The process that reads maps was ended, perhaps for lack of memory; it is started again."
            )
            self._map = self._worker("map", self._of_map)

    def _of_answer(self, slot: Slot, name: str, found: Any) -> None:
        """Take progress, an answer, or a picture."""
        if name == "progress":
            slot.done = found
            self._tell_progress()
        elif name in ("run", "sample", "open"):
            slot.state, slot.summary = "shown", found
            self._tell_progress()
            self.show(str(self.slots.index(slot)))
        elif name == "plane":
            slot.plane = found
            self._each_tab(self._draw_planes)
            self.tell({"plane": self._slider()})
        elif name == "line" and self._ends is not None:
            slot.line = (self._ends, found)
            self._each_tab(self._draw_planes)
        elif name == "refused":
            lines = found[1]
            if slot.state != "shown":
                slot.state, slot.message = "failed", " ".join(lines)
                slot.worker.stop()
            else:
                self._say(" ".join(lines))
            self._tell_progress()
        elif name == "ended" and slot.state in ("running", "opening"):
            if slot.state == "running":  # an unfinished folder, which the page has made
                shutil.rmtree(slot.folder, ignore_errors=True)
            slot.state = "stopped" if slot.worker.stopped else "killed"
            killed = f"The computation was killed (exit code {found}), perhaps for lack of memory."
            slot.message = slot.message or (
                "Stopped." if slot.worker.stopped else f"{killed} The inputs are kept."
            )
            self._tell_progress()
        elif name == "ended" and slot.state == "shown" and not slot.worker.stopped:
            self._say(
                f"The process that draws {slot.name} was killed; open its folder again to see its planes."
            )

    # What the page shows

    def tell(self, message: Mapping[str, Any], without: Any = None) -> None:
        """Send a message to all tabs."""
        for socket in self.sockets:
            if socket is not without:
                socket.write_message(message)

    def state(self) -> dict[str, Any]:
        """Everything that a new tab shows besides its pictures."""
        found = self._state_of_form()
        found["values"] = self.values
        found["html"] |= self._parts_of_answer() | {"repeat": self._repeat(), "notice": self._part("notice")}
        return found | {"progress": self._progress(), "plane": self._slider()}

    def add_tab(self, document: Any) -> None:
        """Fill the document of a new tab."""
        tab = Tab(document, self)
        self.tabs.add(tab)
        document.on_session_destroyed(lambda _: self.tabs.discard(tab))
        self._draw_map(tab)
        self._draw_contact(tab)
        self._draw_planes(tab)

    def watch(self) -> None:
        """Tell the remaining time, and end a computation that uses too much memory."""
        if self.sockets:
            self.last_seen = time.monotonic()
        for slot in self.slots:
            if slot.state == "running":
                if (used := slot.worker.memory()) > self.memory:
                    slot.message = (
                        f"The computation used {used / 2**30:.1f} GiB, more than the limit of "
                        f"{self.memory / 2**30:.1f} GiB, and was ended; the inputs are kept. Fewer points "
                        "(map.points) need less."
                    )
                    slot.worker.stop()
                self._tell_progress()

    def close(self) -> None:
        """End all processes."""
        for worker in (self._map, *(slot.worker for slot in self.slots)):
            worker.stop()

    def _part(self, name: str, **values: Any) -> str:
        """A part of the page as HTML; texts in it are escaped."""
        return TEMPLATES.get_template("parts.html.j2").render(part=name, session=self, **values)

    def _say(self, text: str) -> None:
        self.notice = text
        self.tell({"html": {"notice": self._part("notice")}})

    def _add(self, name: str, folder: Path) -> Slot:
        slot = Slot(name, None, folder)  # type: ignore[arg-type]
        slot.worker = self._worker("answer", self._of_answer, slot)
        self.slots.append(slot)
        return slot

    def _problems(self) -> tuple[list[str], dict[str, str]]:
        """What is missing or wrong, and the messages at fields that have a text."""
        listed, at_fields = [], {}
        for key, text in self.check.get("problems", [("map.file", ": a map is needed")]):
            first = key.split(",")[0].strip()
            if key.startswith("load.") and "," in key:
                first = f"load.{form.LOADS[form.chosen('choose.load', self.values)][0]}"
            message = f"{self.flags.get(key, key)}{text}"
            if self.values.get(first):
                at_fields[first] = message
            listed.append(message)
        return listed, at_fields

    def _state_of_form(self) -> dict[str, Any]:
        listed, at_fields = self._problems()
        doubts = {}
        for text in self.check.get("doubts", ()):
            key, _, rest = text.partition(": ")
            found = re.search(r"set it to ([\w.]+)", rest)
            doubts[f"map.{key}"] = {"text": rest, "apply": found[1] if found else ""}
        constants = {
            f"{body}.{name}": f"{value:g}"
            if name in ("poisson", "conductivity", "resistivity")
            else shown_si(value, "Pa")
            for body, known in self.check.get("constants", {}).items()
            for name, value in known.items()
        }
        parts = {name: self._part(name, listed=listed) for name in ("info", "hertz", "ready")}
        return {
            "html": parts,
            "problems": at_fields,
            "doubts": doubts,
            "constants": constants,
            "ready": not listed,
            "has_map": "picture" in self.check,
        }

    def _repeat(self) -> str:
        """The command line and the case file that give this answer."""
        content = form.content_of(self.values)
        name = None
        file = at(content, ("map", "file"))
        if isinstance(file, str):
            if Path(file).is_relative_to(self.folder):
                name = Path(file).name
            content["map"]["file"] = file
        command = form.command_of(content, self.flags, name)
        if isinstance(file, str):
            put(content, ("map", "file"), name or os.path.abspath(file))
        text = yaml.safe_dump(content, sort_keys=False, allow_unicode=True)
        return self._part("repeat", command=command, case=text)

    def _progress(self) -> dict[str, Any]:
        running = next((slot for slot in self.slots if slot.state in ("running", "opening")), None)
        if running is None:
            last = self.slots[-1] if self.slots else None
            return {"running": False, "text": last.message if last is not None else ""}
        passed, text = time.monotonic() - running.since, "starting"
        if running.done > 0.02:
            left = passed * (1 - running.done) / running.done
            text = (
                f"{running.done:.0%}, about {left:.0f} s left"
                if left < 90
                else f"{running.done:.0%}, about {left / 60:.0f} min left"
            )
        return {"running": True, "done": running.done, "text": text}

    def _tell_progress(self) -> None:
        self.tell({"progress": self._progress()})

    def _slot(self, place: int) -> Slot | None:
        number = self.shown[place]
        return None if number is None else self.slots[number]

    def _looked_at(self, slot: Slot) -> dict[str, str]:
        """Body and field that are looked at, as far as an answer has them."""
        bodies, fields = slot.summary["bodies"], slot.summary["fields"]
        return {
            "body": self.view["body"] if self.view["body"] in bodies else bodies[0],
            "field": self.view["field"] if self.view["field"] in fields else fields[0],
        }

    def _ask_planes(self) -> None:
        for place in (0, 1):
            if (slot := self._slot(place)) is not None:
                slot.worker.send("plane", **self._looked_at(slot), depth=self.view["depth"])

    def _peaks(self, slot: Slot) -> dict[str, Any]:
        """Peaks of the field and body that are looked at, the largest first."""
        known = {name: np.array(values) for name, values in slot.summary["peaks"].items()}
        looked_at = self._looked_at(slot)
        own = (known["body"] == looked_at["body"]) & (known["quantity"] == looked_at["field"])
        names = {"x": "x_m", "y": "y_m", "depth": "depth_m", "value": "value_Pa"}
        return {name: known[column][own][:DRAWN] for name, column in names.items()}

    def _slider(self) -> dict[str, Any]:
        """The depth slider: its end, the position next to the depth, and the depth in words."""
        slot = self._slot(0)
        depths = [] if slot is None else slot.summary["depths"].get(self.view["body"], [])
        if not depths:
            return {}
        nearest = int(np.abs(np.subtract(depths, self.view["depth"])).argmin())
        return {"last": len(depths) - 1, "at": nearest, "text": shown_si(self.view["depth"], "m", 3)}

    def words(self, row: Mapping[str, Any]) -> dict[str, str]:
        """A number of an answer as text in the chosen units, its error, and what this is the error of."""
        value, unit, error = row["value"], row["unit"], row.get("error", math.nan)
        factor, symbol = 1.0, "" if unit == "1" else unit
        if row["name"] in IN_PER_CENT:
            factor, symbol = 0.01, "%"
        elif unit in ("m", "Pa") and math.isfinite(value):
            factor, symbol = self.units.of(value, unit)
        text = shown_si(value, unit) if symbol == unit else f"{value / factor:.4g} {symbol}".strip()
        found = {"name": row["name"], "text": text, "error": "", "meaning": ""}
        if error > 0:
            estimate = row["estimate"]
            found["error"] = f"{with_error(estimate / factor, error / factor)} {symbol}".strip()
            found["meaning"] = "by the pixels" if estimate == value else "for vanishing pixels"
        return found

    def _parts_of_answer(self) -> dict[str, str]:
        """Tiles, warnings, numbers, peaks and files of the answers that are shown."""
        answers = [slot for slot in (self._slot(0), self._slot(1)) if slot is not None]
        found = []
        for slot in answers:
            rows = slot.summary["rows"]
            groups: dict[str, list[dict[str, str]]] = {}
            for row in rows:
                groups.setdefault(row["group"], []).append(self.words(row))
            tiles = [self.words(row) for row in rows if row["name"] in TILES]
            found.append({"slot": slot, "number": self.slots.index(slot), "tiles": tiles, "groups": groups})
        peaks: list[dict[str, Any]] = []
        if answers:
            known = self._peaks(answers[0])
            for number in range(min(LISTED, len(known["depth"]))):
                texts = {}
                for name, values in known.items():
                    unit = "Pa" if name == "value" else "m"
                    factor, symbol = self.units.of(values[number], unit)
                    texts[name] = f"{values[number] / factor:.4g} {symbol}"
                peaks.append(texts)
        return {
            "answer": self._part("answer", answers=found),
            "peaks": self._part("peaks", peaks=peaks),
            "choices": self._part("choices", answers=answers, all_units=UNITS),
        }

    def _each_tab(self, change: Callable[[Tab], Any]) -> None:
        for tab in self.tabs:
            later(tab.document, change, tab)

    def _draw_map(self, tab: Tab) -> None:
        tab.map.show(self.check, self.units)
        if self._profile is not None and self._profile[1]:
            tab.map.show_profile(self._profile[1], self._profile[0], self.units)

    def _draw_answers(self) -> None:
        self._each_tab(self._draw_contact)
        self._each_tab(self._draw_planes)
        self.tell(
            {"html": self._parts_of_answer(), "plane": self._slider(), "beside": self.shown[1] is not None}
        )

    def _draw_contact(self, tab: Tab) -> None:
        """Draw contact and peaks of the answers, in common colours."""
        which, slots = self.view["contact"], [self._slot(0), self._slot(1)]
        shown = [slot.summary[which]["values"] for slot in slots if slot is not None]
        for slot, pictures in zip(slots, tab.answers, strict=True):
            if slot is not None:
                limits = (0.0, max(float(values.max()) for values in shown))
                pictures.show(slot.summary, which, self.units, limits)
                pictures.show_peaks(self._peaks(slot), self.units, slot.summary["pressure"])
        if self.view["peak"] is not None:
            tab.answers[0].mark(self.view["peak"])

    def _draw_planes(self, tab: Tab) -> None:
        """Draw planes and sections of the answers, in the colours of the largest stress."""
        slots = [self._slot(0), self._slot(1)]
        for slot, pictures in zip(slots, tab.answers, strict=True):
            if slot is None or slot.plane is None:
                continue
            looked_at = self._looked_at(slot)
            values = [slot.plane["plane"]["values"]] + (
                [slot.line[1]["section"]["values"]] if slot.line else []
            )
            low, high = min(float(each.min()) for each in values), max(float(each.max()) for each in values)
            limits = (min(low, 0.0), high)
            if looked_at["field"] in ("von_mises", "largest_shear"):
                known = [self._peaks(each)["value"] for each in slots if each is not None]
                limits = (0.0, max([high, *(float(each.max()) for each in known if len(each))]))
            level = (
                slot.summary["yield"].get(looked_at["body"]) if looked_at["field"] == "von_mises" else None
            )
            title = f"{looked_at['field'].replace('_', ' ')} at depth {shown_si(slot.plane['depth'], 'm', 3)}"
            pictures.show_plane(slot.plane, self.units, title, level, limits)
            if slot.line is not None:
                pictures.show_section(slot.line[1], slot.line[0], self.units, level, limits)

    @property
    def materials(self) -> list[str]:
        """Names of the materials of the table."""
        return list(table())


ACTIONS: dict[str, Callable[[Session, str], None]] = {
    "open": Session.open,
    "example": Session.example,
    "start": Session.start,
    "stop": Session.stop,
    "show": Session.show,
    "beside": Session.beside,
    "depth": Session.depth,
    "peak": lambda session, value: session.mark(int(value)) if value.isdecimal() else None,
    "contact": lambda session, value: session.choose_view("contact", "gap" if value == "gap" else "pressure"),
    "field": lambda session, value: session.choose_view("field", value),
    "body": lambda session, value: session.choose_view("body", value),
    "length": lambda session, value: session.choose_unit("length", value),
    "stress": lambda session, value: session.choose_unit("stress", value),
}
"""Name in a message of the page → what it does with the value."""
