"""Whole runs of ``asperity run``: options of every kind, and files that must survive.

The pictures are left out: they take most of the time of a small run, and the folder of an answer is the same
without them but for their files.
"""

import contextlib
import shutil
import tempfile
from pathlib import Path
from unittest import mock

import bad_input
from hypothesis import strategies as st
from inputs import LONGEST_MESSAGE, PromiseError, require
from samples import write_map

import asperity as asp
from asperity.cli import main as cli
from asperity.results import dataset

FOLDER = Path(tempfile.mkdtemp(prefix="fuzz-answers-"))
NO_PICTURES = mock.patch("asperity.engineering.show.pictures.pictures", return_value=[])
TABLES = {"answer.csv", "peaks.csv", "contact_spots.csv", "gaps.csv", "warnings.csv"}
WHOLE = {"answer.json", "case.yaml", "surface.nc", "contact.nc", *TABLES, "report.html"}
POINTS, EDGE = 16, 16e-6
CASE = "map: mine.txt\nbody: {young: 210 GPa, poisson: 0.3}\n"

LOADS = {
    "pressure": "--mean-pressure 50MPa",
    "curve": "--mean-pressure 50MPa --set load_curve.loads=[20MPa]",
    "steps": "--mean-pressure 50MPa --set load_curve.loads=[5MPa] --set load_curve.steps=3",
    "force": "--force 10mN",
    "normal_approach": "--normal-approach 40nm",
    "area": "--contact-area-fraction 0.1",
}
SECOND = "--counter-young 70GPa --counter-poisson 0.33"
OPTIONS = {
    "hardness": "--hardness 3GPa",
    "soft": "--hardness 1MPa",
    "yield": "--yield-stress 1GPa",
    "second": SECOND,
    "conductivity": f"{SECOND} --set body.conductivity=50 --set counter_body.conductivity=200",
    "resistivity": f"{SECOND} --set body.resistivity=1e-7 --set counter_body.resistivity=3e-8 "
    "--set counter_body.hardness=2GPa",
    "fatigue": "--set body.fatigue_torsion=300MPa --set body.fatigue_bending=480MPa",
    "friction": "--friction 0.3 --sliding-direction 30",
    "layer": "--set body.layers.0.thickness=5um --set body.layers.0.young=3GPa "
    "--set body.layers.0.poisson=0.4",
    "layers": "--set body.layers.0.thickness=2um --set body.layers.0.material=DLC "
    "--set body.layers.0.residual_stress=-1GPa --set body.layers.0.strength.shear=300MPa "
    "--set body.layers.1.thickness=300nm --set body.layers.1.material=chromium",
    "free": "--periodic none",
    "counter map": f"{SECOND} --counter-map other.txt --set counter_body.map.turned_about=x",
    "fields": "--set fields=[xx,von_mises]",
    "points": "--set map.points=24",
    "treatment": "--detrend curvature --despike 8 --set map.wavelength_short=3um",
}
SAVED = ("saved.yaml", "out/case.yaml", "out/more.yaml")
LOST = (
    "mine.txt",
    "other.txt",
    "foreign.yaml",
    "case.yaml",
    "notes.txt",
    "",
    ".",
    "mine.txt/new.yaml",
    "out/answer.csv",
)
OUT, NO_OUT = ("out", "new/out"), ("", ".", "mine.txt", "mine.txt/out", "used")
NO_OUT_OF_SEVERAL = ("", "mine.txt", "mine.txt/out")

runs = st.fixed_dictionaries(
    {
        "maps": st.sampled_from(
            [("mine.txt",), ("case.yaml",), ("mine.txt", "other.txt"), ("case.yaml", "other.txt")]
        ),
        "load": st.sampled_from(list(LOADS)),
        "options": st.lists(st.sampled_from(list(OPTIONS)), max_size=3, unique=True),
        "save": st.none() | st.sampled_from(SAVED) | st.sampled_from(LOST),
        "out": st.sampled_from(OUT) | st.sampled_from(OUT) | st.sampled_from(NO_OUT),
    }
)


def command_of(case):
    """Words of the command; an option that two of the chosen ones have is given once."""
    words, given = ["run", *case["maps"], "--out", case["out"]], set()
    if case["maps"][0] != "case.yaml":
        words += ["--young", "210GPa", "--poisson", "0.3"]
    if len(case["maps"]) > 1 and case["maps"][0] == "case.yaml":
        words += ["--young", "210GPa", "--poisson", "0.3"]
    if case["save"] is not None:
        words += ["--save", case["save"]]
    for text in (LOADS[case["load"]], *(OPTIONS[name] for name in case["options"])):
        for option in text.split("--")[1:]:
            name, *values = option.split()
            key = values[0].partition("=")[0] if name == "set" else name
            if key not in given:
                words += [f"--{name}", *values]
            given.add(key)
    return words


def is_refused(case):
    """True if the command breaks a documented rule, so that it has to be refused."""
    options, save = set(case["options"]), case["save"]
    return bool(
        case["out"] in (NO_OUT if len(case["maps"]) == 1 else NO_OUT_OF_SEVERAL)
        or save in LOST
        or (save is not None and len(case["maps"]) > 1)
        or (
            "soft" in options
            and "hardness" not in options
            and case["load"] in ("pressure", "curve", "steps", "force")
        )
        or (options & {"layer", "layers"} and options & {"free", "conductivity", "resistivity"})
        or ("fatigue" in options and options & {"counter map", "friction"})
    )


def made_folder():
    """A new folder with maps, a case, and files of the user's."""
    folder = Path(tempfile.mkdtemp(dir=FOLDER))
    height = asp.self_affine((POINTS, POINTS), 0.8, 8e-6, 3e-6, rms_height=5e-8, seed=3, length=EDGE) * 1e6
    for name, values in (("mine.txt", height), ("other.txt", 2 * height[::-1])):
        write_map(folder / name, values, (16, 16))
    (folder / "case.yaml").write_text(CASE)
    (folder / "foreign.yaml").write_text("contact: {contact_area_fraction: 0.1}\n")
    (folder / "notes.txt").write_text("precious\n")
    (folder / "used").mkdir()
    (folder / "used/peaks.csv").write_text("precious\n")
    return folder


def try_answer(case):
    """A run: whole, or refused in lines that are not too long, as its options say; other files stay."""
    folder = made_folder()
    before = {path: path.read_bytes() for path in folder.rglob("*") if path.is_file()}
    with contextlib.chdir(folder), NO_PICTURES:
        code, said = bad_input.answer(cli.main, command_of(case))
        for path, content in before.items():
            if not (path.is_file() and path.read_bytes() == content):
                raise PromiseError(f"{path.name} is destroyed")  # told apart from other promises
        if code:
            lines = said.splitlines()
            require(lines and all(line.startswith("asperity: ") for line in lines), "another message")
            require(
                all(len(line) < LONGEST_MESSAGE and line.isprintable() for line in lines), "a long message"
            )
            if "stopped: residual" not in said:
                require(is_refused(case), f"a run within the documented ranges is refused: {lines[0]}")
            left = [path for path in folder.rglob("*") if path.is_file() and path not in before]
            require(not [path for path in left if case["save"] is None], "a refused run leaves files")
            shutil.rmtree(folder)
            return "refused"
        require(not is_refused(case), "a run that breaks a documented rule is carried out")
        folders = [path.parent for path in Path(case["out"]).rglob("report.html")]
        require(len(folders) == len(case["maps"]), "an answer is missing")
        for out in folders:
            require_whole(out)
        if case["save"] is not None:
            code, said = bad_input.answer(cli.main, ["run", case["save"], "--out", "again"])
            require(code == 0, f"the saved case is refused: {said}")
            same = (folders[0] / "answer.csv").read_bytes() == Path("again/answer.csv").read_bytes()
            require(same, "the saved case has another answer")
    shutil.rmtree(folder)
    return "done"


def require_whole(folder):
    """Raise `PromiseError` unless a folder holds all files of one answer, and nothing unfinished."""
    names = {path.name for path in folder.iterdir()}
    require(names >= WHOLE, f"missing: {WHOLE - names}")
    require(
        not [name for name in names if "unfinished" in name or "lock" in name], "something unfinished is left"
    )
    settings = [dataset.settings_of(dataset.read(path)) for path in folder.glob("*.nc")]
    require(all(each == settings[0] for each in settings), "the folder holds files of two answers")


ANSWERS = {"answer": (runs, try_answer)}
"""Properties, as in `properties.py`."""
