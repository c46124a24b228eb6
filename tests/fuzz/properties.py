"""Inputs of everything that a user calls, and what must hold whatever the input is.

A property is a strategy that draws an input, and a function that tries it and returns the outcome in a few
words. It raises `PromiseError` if a promise is not kept. Every other exception than the package's own is a
defect as well, which the search notices itself.
"""

import contextlib
import io
import math
import tempfile
from pathlib import Path
from typing import NamedTuple

import numpy as np
import yaml
from hypothesis import strategies as st

import asperity as asp
from asperity.cli import main as cli

ROOT = Path(__file__).parents[2]
PAPER = yaml.safe_load((ROOT / "config/config.yaml").read_text(encoding="utf-8"))

WORST_NODE = 100.0
"""Violation of the contact conditions that a node may have, in units of the solver's tolerance."""

LONGEST_MESSAGE = 500
"""Characters of an error message."""


class PromiseError(AssertionError):
    """A promise that was not kept."""


def require(holds, promise):
    """Raise `PromiseError` unless a promise holds."""
    if not holds:
        raise PromiseError(promise)


def require_finite(**values):
    """Raise `PromiseError` for a result with numbers that are not finite."""
    for name, value in values.items():
        require(np.all(np.isfinite(value)), f"{name} is not finite")


odd = st.shared(st.sampled_from([False, False, True]), key="odd")
"""True for a case in which some arguments are out of range, or of a wrong type."""

extreme = st.sampled_from(
    [0.0, -0.0, 1e-320, 1e-300, 1e-30, 1e30, 1e300, -1.0, math.inf, -math.inf, math.nan]
)
wrong = st.sampled_from([None, "1", True, 1j, [1.0], (), {}, b"1", [1.0, 2.0], object])


def among(good, *bad):
    """Arguments of a strategy, and in odd cases sometimes those of others."""
    return odd.flatmap(lambda is_odd: st.one_of(*[good] * 6, *bad) if is_odd else good)


def number(low, high):
    """A number in a range; in odd cases perhaps another, or none."""
    return among(st.floats(low, high), extreme, wrong)


def choice(*names):
    """One of some names; in odd cases perhaps another."""
    return among(st.sampled_from(names), st.sampled_from(["", "magic", None, 1]))


shapes = st.tuples(st.integers(1, 24), st.integers(1, 24))
lengths = st.just(1.0) | number(1e-6, 1e6) | st.tuples(st.floats(0.1, 10), st.floats(0.1, 10))


class Height(NamedTuple):
    """A surface, by the way it is made: the example of a defect stays short."""

    kind: str
    shape: tuple[int, int] = (8, 8)
    seed: int = 0
    scale: float = 1.0
    offset: float = 0.0


KINDS = ("noise", "smooth", "levels", "flat", "spike")
ODD_KINDS = ("nan", "inf", "1e300", "complex", "line", "empty", "text")
heights = st.builds(
    Height,
    among(st.sampled_from(KINDS), st.sampled_from(ODD_KINDS)),
    shapes,
    st.integers(0, 100),
    st.sampled_from([1e-3, 1.0, 1e-2]) | among(st.just(1e-3), st.sampled_from([1e-140, 1e-9, 1e9, 1e140])),
    st.sampled_from([0.0, 1.0, 1e6]),
)


def made(height):
    """The array of a surface."""
    kind, shape, number, scale, offset = height
    y, x = np.indices(shape)
    values = np.random.default_rng(number).standard_normal(shape)
    if kind == "smooth":
        values = np.cos(2 * np.pi * x / shape[1]) + np.cos(2 * np.pi * y / shape[0])
    elif kind == "levels":
        values = np.round(values)
    elif kind == "flat":
        values = np.zeros(shape)
    elif kind == "spike":
        values = -np.where((x == 0) & (y == 0), 1.0, 0.0)
    elif kind in ("nan", "inf", "1e300"):
        values[0, 0] = float(kind)
    elif kind == "complex":
        return values.astype(complex)
    elif kind == "line":
        return values[0]
    elif kind == "empty":
        return values[:0]
    elif kind == "text":
        return values.astype(str)
    return values * scale + offset


def pressed(case):
    """The pressure of a surface's upper half on a solid."""
    values = made(case["pressure"])
    if values.dtype == float:
        values = np.maximum(values, 0.0)
    return Pressed(values, asp.Grid(values.shape, case.get("length", 1.0)), asp.Layer(**case["layer"]))


class Pressed(NamedTuple):
    """A pressure on a solid."""

    pressure: np.ndarray
    grid: asp.Grid
    layer: asp.Layer


layers = st.fixed_dictionaries(
    {"young": st.just(1.0) | number(1e-3, 1e12), "poisson": number(-0.99, 0.5)},
    optional={
        "height": st.none() | number(1e-3, 10.0),
        "bottom": choice("bonded", "frictionless", "free"),
        "lateral": choice("confined", "free"),
    },
)


# --- the solvers


contacts = st.fixed_dictionaries(
    {
        "height": heights,
        "layer": layers,
        "control": st.one_of(
            st.fixed_dictionaries({"area_fraction": number(1e-3, 1.0)}),
            st.fixed_dictionaries({"mean_pressure": number(0, 1.0)}),
            st.fixed_dictionaries({"approach": number(-1.0, 1.0)}),
            among(st.just({"area_fraction": 0.1}), st.just({}), st.just({"approach": 0, "mean_pressure": 1})),
        ),
        "settings": st.fixed_dictionaries(
            {},
            optional={
                "length": lengths,
                "method": choice("active_set", "gfmd"),
                "rtol": st.sampled_from([1e-2, 1e-4, 1e-6]) | number(1e-8, 1e-2),
                "dtype": choice("float64", "float32"),
            },
        ),
    }
)


def try_contact(case):
    """Solve a contact: certified and under the control asked for."""
    layer = asp.Layer(**case["layer"])
    contact = asp.solve(made(case["height"]), layer, **case["control"], **case["settings"])
    require_finite(
        pressure=contact.pressure,
        displacement=contact.displacement,
        gap=contact.gap,
        approach=contact.approach,
        mean_pressure=contact.mean_pressure,
    )
    require(contact.pressure.min() >= 0, "a pressure is negative")
    found = asp.verify_contact(
        contact.height, contact.pressure, layer, contact.grid.length, approach=contact.approach
    )
    allowed = WORST_NODE * contact.rtol * max(1.0, reach(contact)) + rounding(contact)
    require(found.worst <= allowed, "the certificate does not hold")
    ((kind, value),) = ((kind, float(value)) for kind, value in case["control"].items())
    if kind == "mean_pressure":
        require(math.isclose(contact.mean_pressure, value, rel_tol=1e-5), "the mean pressure is another")
    elif kind == "area_fraction" and np.unique(contact.height).size == contact.height.size:
        wanted, nodes = round(value * contact.height.size), np.count_nonzero(contact.pressure)
        require(abs(nodes - max(1, wanted)) <= max(1, 1e-3 * wanted), "the area is another")
    return "solved"


def reach(contact):
    """Displacement that an error of the pressure as large as itself causes, over the rms height."""
    qy, qx = (
        2 * np.pi * np.fft.fftfreq(n, length / n) for n, length in zip(*grid_axes(contact), strict=True)
    )
    compliance = contact.layer.surface_compliance(np.hypot(qy[:, None], qx[None, :]))
    compliance[0, 0] = 0
    norm = float(np.sqrt(np.mean(np.square(contact.pressure, dtype=float))))
    rms = float(np.std(contact.height, dtype=float))
    return norm * float(compliance.max()) / rms if rms else 1.0


def rounding(contact):
    """Rounding error of the heights, over their rms."""
    rms = float(np.std(contact.height, dtype=float))
    largest = float(np.abs(contact.height).max())
    return 10 * float(np.finfo(contact.pressure.dtype).eps) * largest / rms if rms else 0.0


def grid_axes(contact):
    """Nodes and edges of the grid."""
    return contact.grid.shape, contact.grid.length


# --- the stress


names = st.lists(
    choice("xx", "yy", "zz", "yz", "xz", "xy", "von_mises"), min_size=1, max_size=3, unique_by=repr
)
stresses = st.fixed_dictionaries(
    {
        "pressure": heights,
        "layer": layers,
        "length": lengths,
        "poisson": st.none() | number(-0.99, 0.5) | st.lists(number(-0.99, 0.5), max_size=3),
        "fields": names,
        "depths": among(st.lists(st.floats(0, 1), min_size=1, max_size=4, unique=True).map(sorted), wrong),
        "tolerance": st.sampled_from([0, 1e-2, 1e-6]) | number(0, 1),
    }
)


def try_stress(case):
    """Stress planes and their peaks: finite, and peaks within the planes."""
    on_solid = pressed(case)
    grid = on_solid.grid
    settings = {name: case[name] for name in ("poisson", "fields", "tolerance")}
    planes = list(asp.stress_planes(on_solid, case["depths"], **settings))
    for plane in planes:
        require_finite(**{name: np.asarray(field) for name, field in plane.fields.items()})
    peaks = asp.find_peaks(iter(planes), case["fields"][0])
    require_finite(value=peaks.value, depth=peaks.depth, y=peaks.y, x=peaks.x)
    for place, edge in ((peaks.y, grid.length[0]), (peaks.x, grid.length[1])):
        require(np.all((place >= 0) & (place <= edge)), "a peak lies outside the cell")
    return "computed"


analyses = st.fixed_dictionaries(
    {
        "pressure": heights,
        "layer": layers,
        "poisson": st.none() | st.lists(st.floats(-0.9, 0.5), min_size=1, max_size=3, unique=True),
        "tolerance": st.sampled_from([0, 1e-2, 1e-6]),
        "spacing": number(0.3, 4),
        "growth": number(0.05, 1),
        "floor": number(0, 1),
    }
)


def try_analysis(case):
    """Analysis of the stress under any pressure: finite."""
    on_solid = pressed(case)
    settings = {name: case[name] for name in ("poisson", "tolerance", "floor")}
    depths = asp.depth_grid(on_solid.grid, on_solid.layer.height, case["spacing"], case["growth"])
    data = asp.analyse_stress(on_solid, depths, **settings)
    for name, values in data.data_vars.items():
        if values.dtype.kind == "f":
            require_finite(**{str(name): values.values})
    return "computed"


# --- solids and grids


solids = st.fixed_dictionaries(
    {
        "layer": layers,
        "q": among(st.lists(st.floats(0, 1e6), min_size=1, max_size=5), wrong, st.lists(extreme, min_size=1)),
        "depth": st.floats(0, 1e-3) | number(0, 10),
    }
)


def try_layer(case):
    """Kernels of a layer: finite."""
    layer = asp.Layer(**case["layer"])
    compliance = layer.surface_compliance(case["q"])
    # The compliance of a free layer rises as 1/q³, beyond all numbers for the smallest q.
    ordinary = np.asarray(case["q"]) > 1e-70
    require_finite(compliance=compliance[ordinary])
    kernels = layer.kernels(case["q"], case["depth"])
    require_finite(**{name: getattr(kernels, name)[ordinary] for name in kernels._fields})
    return "computed"


grids = st.fixed_dictionaries(
    {
        "shape": among(shapes, wrong, st.tuples(number(1, 8), number(1, 8))),
        "length": lengths,
        "height": st.none() | number(1e-3, 10),
        "spacing": number(0.1, 4),
        "growth": number(0.05, 1),
    }
)


def try_grid(case):
    """Grids, and the depths of their planes: rising from the surface to the bottom."""
    grid = asp.Grid(case["shape"], case["length"])
    depths = asp.depth_grid(grid, case["height"], case["spacing"], case["growth"])
    require_finite(depths=depths)
    require(depths[0] == 0 and np.all(np.diff(depths) > 0), "the depths do not rise from zero")
    return "made"


# --- surfaces


surfaces = st.fixed_dictionaries(
    {
        "shape": among(st.tuples(st.integers(8, 48), st.integers(8, 48)), shapes, wrong),
        "hurst": number(0, 1),
        "wavelength_long": number(0.4, 1),
        "wavelength_short": number(0.2, 0.4),
        "rms_height": number(1e-6, 1),
        "seed": among(st.integers(0, 2**64), st.integers(-5, -1), wrong),
        "length": st.just(1.0) | among(st.just(1.0), number(1e-6, 1e6)),
        "johnson": st.none() | st.tuples(number(-2, 2), number(0.1, 10)),
        "moments": st.none() | st.tuples(number(-2, 2), number(1, 10)),
    }
)


def try_surface(case):
    """Self-affine surfaces and their transforms: finite, with the rms height asked for."""
    case = dict(case)
    transform, moments = case.pop("johnson"), case.pop("moments")
    height = asp.self_affine(**case)
    require_rms(height, case["rms_height"])
    if transform is not None:
        require_rms(asp.johnson(height, *transform), case["rms_height"])
    if moments is not None:
        require_rms(asp.with_moments(height, *moments), case["rms_height"])
    asp.spectrum(height, case["length"])
    require_finite(**vars(asp.roughness_parameters(height, case["length"])))
    return "made"


def require_rms(height, rms):
    """Raise `PromiseError` unless a surface is finite and has its rms height."""
    require_finite(height=height)
    # The square of a smaller height is not a normal number.
    require(rms < 1e-150 or math.isclose(float(np.std(height / rms)), 1, rel_tol=1e-9), "another rms height")


# --- the command line: words, configurations, map files


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
    require(said.startswith("asperity: "), "the error does not begin with asperity:")
    require(said[:-1].isprintable(), "the error is more than one line")
    require(len(said) < LONGEST_MESSAGE, "the error is long")
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
    'plan {"hurst":0.8,"wavelength_long":0.125,"wavelength_short":0.01}',
)
VOCABULARY = """
    solve stress peaks plot plan --contact --path --poisson --points --periodic --detrend --undefined --help
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


PROPERTIES = {
    "contact": (contacts, try_contact),
    "stress": (stresses, try_stress),
    "analysis": (analyses, try_analysis),
    "layer": (solids, try_layer),
    "grid": (grids, try_grid),
    "surface": (surfaces, try_surface),
    "command": (commands, try_command),
    "config": (configs, try_config),
    "map": (map_files(), try_map),
}
