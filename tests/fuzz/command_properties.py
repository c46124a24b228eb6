"""The command line: its words, configurations, and files of maps."""

import contextlib
import io
import tempfile
from pathlib import Path

import numpy as np
import yaml
from hypothesis import strategies as st
from inputs import LONGEST_MESSAGE, require

from asperity.cli import main as cli

ROOT = Path(__file__).parents[2]
PAPER = yaml.safe_load((ROOT / "config/config.yaml").read_text(encoding="utf-8"))


def answer(arguments):
    """Exit status of the command line in the temporary folder, and what it printed on stderr."""
    said = io.StringIO()
    with (
        contextlib.chdir(Files.folder.name),
        contextlib.redirect_stderr(said),
        contextlib.redirect_stdout(io.StringIO()),
    ):
        try:
            code = cli.main(arguments)
        except SystemExit as stopped:
            code = stopped.code
    return code, said.getvalue()


def require_answer(arguments):
    """Outcome of a command: done, or one line of what is wrong."""
    code, said = answer(arguments)
    require(code in (0, 1, 2), f"exit status {code}")
    if code == 0:
        return "done"
    lines = said.splitlines()
    require(lines, "the error has no message")
    # One line for each thing that is wrong.
    for line in lines:
        require(line.startswith("asperity: "), "the error does not begin with asperity:")
        require(line.isprintable(), "the error has unprintable characters")
        require(len(line) < LONGEST_MESSAGE, "the error is long")
    return "refused"


HEADER = "# Channel: Height\n# Width: 8 m\n# Height: 8 m\n# Value units: m\n"
ROWS = "\n".join(
    " ".join(f"{np.sin(0.7 * y) * np.cos(1.3 * x + y):.6f}" for x in range(16)) for y in range(16)
)
MAP = (HEADER + ROWS + "\n").encode()
SOLVE = "--periodic mirrored --detrend tilt --area-fraction 0.2"


class Files:
    """Results of a chain of commands in a temporary folder, made when first asked for."""

    folder = None

    @classmethod
    def names(cls):
        """Name → path of a file that the words of a command may stand for."""
        if cls.folder is None:
            cls.folder = tempfile.TemporaryDirectory(prefix="fuzz-")
            paths = cls.paths()
            Path(paths["map"]).write_bytes(MAP)
            for command in (
                f"solve {paths['map']} {SOLVE} --out {paths['contact']}",
                f"stress {paths['contact']} --out {paths['stress']}",
                f"peaks {paths['stress']} --contact {paths['contact']} --out {paths['statistics']}",
            ):
                code, said = answer(command.split())
                require(code == 0, f"asperity {command}: {said}")
        return cls.paths()

    @classmethod
    def paths(cls):
        """The same, whether the files are made or not."""
        folder = cls.folder.name
        return {
            "map": f"{folder}/map.asc",
            **{name: f"{folder}/{name}.nc" for name in ("contact", "stress", "statistics")},
            "new": f"{folder}/new.nc",
            "missing": f"{folder}/missing.nc",
            "folder": folder,
        }


COMMANDS = (
    f"solve {{map}} {SOLVE} --out {{new}}",
    "stress {contact} --poisson 0.33 --out {new}",
    "peaks {stress} --contact {contact} --out {new}",
    "plot 9 {statistics} --out {folder}/x.png",
    "run {map} --young 70GPa --pressure 1MPa --points 8 --out {folder}/answer",
    "surface --help",
    'plan {"hurst":0.8,"wavelength_long":0.125,"wavelength_short":0.01}',
)
VOCABULARY = """
    solve stress peaks plot plan run surface view export --young --radius --boundary free 1e-300 1e300 1e400
    --friction --counter-young 70GPa --physical-size
    --contact --path --poisson --points --periodic --detrend --undefined --help
    --version --out --area-fraction --tolerance --precision --layer-height --bottom --bins --confidence
    --error --seconds --output mirrored declared windowed tilt none nan inf -1 0 0.1 0.33 0.5 1 3 9 16 24 --
    - = % %s { float32 bonded von_mises {map} {contact} {stress} {statistics} {new} {missing} {folder}
"""
WORDS = VOCABULARY.split()
# A word may become the name of a file that is written: none may lead out of the temporary folder.
inside = st.characters(exclude_characters="/\\~", exclude_categories=["Cs"])
edits = st.tuples(
    st.sampled_from(["insert", "replace", "delete"]),
    st.integers(0, 8),
    st.sampled_from(WORDS) | st.text(inside, max_size=6),
)
commands = st.tuples(st.sampled_from(COMMANDS), st.lists(edits, max_size=4))


def try_command(case):
    """A command with some words inserted, replaced or deleted."""
    command, changes = case
    words = command.split()
    for kind, place, word in changes:
        end = place if kind == "insert" else place + 1
        words[place:end] = [] if kind == "delete" else [word]
    for name, path in Files.names().items():
        words = [word.replace(f"{{{name}}}", path) for word in words]
    return require_answer(words)


plain = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=8),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(max_size=8), inner, max_size=3),
    max_leaves=8,
)


def places(tree, path=()):
    """Path to every key of a configuration."""
    for key, value in tree.items():
        yield (*path, key)
        if isinstance(value, dict):
            yield from places(value, (*path, key))


configs = st.tuples(
    st.lists(st.tuples(st.sampled_from(list(places(PAPER))), plain), max_size=3), st.binary(max_size=30)
)


def try_config(case):
    """The study's configuration with other values, or followed by some bytes: planned or refused."""
    changes, tail = case
    config = yaml.safe_load((ROOT / "config/config.yaml").read_text(encoding="utf-8"))
    for path, value in changes:
        tree = config
        for key in path[:-1]:
            tree = tree.get(key) if isinstance(tree, dict) else None
        if isinstance(tree, dict):
            tree[path[-1]] = value
    file = Path(Files.names()["folder"]) / "config.yaml"
    file.write_bytes(yaml.safe_dump(config, allow_unicode=True).encode("utf-8", "replace") + tail)
    return require_answer(["plan", str(file)])


@st.composite
def map_files(draw):
    """A map file with some of its bytes or words replaced, and its suffix."""
    content = bytearray(MAP)
    for _ in range(draw(st.integers(0, 3))):
        start = draw(st.integers(0, len(content)))
        end = start + draw(st.sampled_from([0, 1, 8, 100, 10_000]))
        words = st.sampled_from([b"nan", b"inf", b"1e300", b"\n", b" ", b"#", b"0 m", b"%", b"{", b"\x00"])
        content[start:end] = draw(words | st.binary(max_size=8))
    return bytes(content), draw(st.sampled_from(["asc", "asc", "asc", "txt", "npy", "x3p", "nc", ""]))


def try_map(case):
    """A damaged map file: solved or refused."""
    content, suffix = case
    folder = Path(Files.names()["folder"])
    path = folder / f"given.{suffix}"
    path.write_bytes(content)
    return require_answer(["solve", str(path), *SOLVE.split(), "--out", str(folder / "given_contact.nc")])
