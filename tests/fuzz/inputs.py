"""Random arguments: surfaces, solids, numbers, and in odd cases what is none of these."""

import math
import sys
from pathlib import Path
from typing import NamedTuple

import numpy as np
from hypothesis import strategies as st

import asperity as asp

sys.path.insert(0, str(Path(__file__).parents[2] / "studies" / "stability"))

from families import FAMILIES, Nodes

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

EXTREME = [0.0, -0.0, 5e-324, 1e-300, 1e-60, 1e-30, 1e30, 1e60, 1e300, -1.0, math.inf, -math.inf, math.nan]
WRONG = [None, "1", True, 1j, [1.0], (), {}, b"1", object, 10**400, np.array(1.0), np.True_, "x" * 300]
extreme, wrong = st.sampled_from(EXTREME), st.sampled_from(WRONG)


def among(good, *bad):
    """Arguments of a strategy, and in odd cases sometimes arguments of others."""
    return odd.flatmap(lambda is_odd: st.one_of(*[good] * 6, *bad) if is_odd else good)


def number(low, high):
    """A number in a range; in odd cases perhaps another, or none."""
    return among(st.floats(low, high), extreme, wrong)


def choice(*names):
    """One of some names; in odd cases perhaps another."""
    return among(st.sampled_from(names), st.sampled_from(["", "magic", None, 1, [], {}]))


def count(low, high):
    """A whole number in a range; in odd cases perhaps another, or none."""
    return among(st.integers(low, high), st.sampled_from([0, -1, 2**31, 2**62, 1e300]), wrong)


shapes = st.tuples(st.integers(1, 24), st.integers(1, 24))
lengths = st.just(1.0) | number(1e-6, 1e6) | st.tuples(st.floats(0.1, 10), st.floats(0.1, 10))
boundaries = choice("periodic", "free", "free along y", "free along x")


class Height(NamedTuple):
    """A surface, by the way it is made: the example of a defect stays short."""

    kind: str
    shape: tuple[int, int] = (8, 8)
    seed: int = 0
    scale: float = 1.0
    offset: float = 0.0


KINDS = ("smooth", "levels", "integers", "spike", *FAMILIES)
ODD_KINDS = ("nan", "inf", "1e300", "complex", "boolean", "objects", "line", "empty", "text")
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
    kind, shape, seed, scale, offset = height
    y, x = np.indices(shape)
    noise = np.random.default_rng(seed).standard_normal(shape)
    unscaled = {
        "integers": lambda: np.round(noise).astype(int),
        "complex": lambda: noise.astype(complex),
        "boolean": lambda: noise > 0,
        "objects": lambda: np.full(shape, 10**400, object),
        "line": lambda: noise[0],
        "empty": lambda: noise[:0],
        "text": lambda: noise.astype(str),
    }
    if kind in unscaled:
        return unscaled[kind]()
    if kind in FAMILIES:
        return FAMILIES[kind](Nodes(shape, 0.3, seed)) * scale + offset
    values = {
        "smooth": np.cos(2 * np.pi * x / shape[1]) + np.cos(2 * np.pi * y / shape[0]),
        "levels": np.round(noise),
        "spike": -1.0 * ((x == 0) & (y == 0)),
    }.get(kind, noise)
    if kind in ("nan", "inf", "1e300"):
        values[0, 0] = float(kind)
    return values * scale + offset


layers = st.fixed_dictionaries(
    {"young": st.just(1.0) | number(1e-3, 1e12), "poisson": number(-0.99, 0.5)},
    optional={
        "height": st.none() | number(1e-3, 10.0),
        "bottom": choice("bonded", "frictionless", "free"),
        "lateral": choice("confined", "free"),
    },
)
constants = {"young": number(1e-3, 1e12), "poisson": number(-0.99, 0.5)}
stacks = st.fixed_dictionaries(
    {"layers": st.lists(st.tuples(number(1e-3, 10), *constants.values()), min_size=1, max_size=4)},
    optional={
        "base": st.fixed_dictionaries(constants),
        "bottom": choice("bonded", "frictionless"),
        "lateral": choice("confined", "free"),
    },
)
solids = layers | stacks
bodies = solids | solids | st.tuples(solids, solids)


def solid_of(case):
    """A layer, a stack of them, or two bodies."""
    if isinstance(case, dict):
        base = {"base": asp.Solid(**case["base"])} if "base" in case else {}
        return asp.Solid.stack(**case | base) if "layers" in case else asp.Solid(**case)
    return asp.TwoBodies(*map(solid_of, case))


loaded = {
    "pressure": heights,
    "layer": solids | st.just({"young": 1.0, "poisson": 0.3}),
    "length": lengths,
    "boundary": boundaries,
    "mirrored": st.booleans(),
    "friction": st.just(0.0) | among(st.floats(0, 2), extreme, wrong),
    "sliding_direction": choice("x", "y") | number(-360, 360),
}


def loaded_solid(case):
    """The pressure of a surface's upper half on a solid."""
    values = made(case["pressure"])
    if values.dtype == float:
        values = np.maximum(values, 0.0)
    mirrored = case["mirrored"] and case["boundary"] != "free"  # along the axis that repeats
    grid = asp.Grid(values.shape, case["length"], mirrored)
    return asp.LoadedSolid(values, grid, solid_of(case["layer"]), case["boundary"])
