"""Random arguments of the library: surfaces, solids, numbers, and in odd cases what is none of these."""

import math
from typing import NamedTuple

import numpy as np
from hypothesis import strategies as st

import asperity as asp

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
    [0.0, -0.0, 5e-324, 1e-300, 1e-60, 1e-30, 1e30, 1e60, 1e300, -1.0, math.inf, -math.inf, math.nan]
)
wrong = st.sampled_from(
    [
        None,
        "1",
        True,
        1j,
        [1.0],
        (),
        {},
        b"1",
        [1.0, 2.0],
        object,
        10**400,
        np.array(1.0),
        np.True_,
        "x" * 300,
    ]
)


def among(good, *bad):
    """Arguments of a strategy, and in odd cases sometimes those of others."""
    return odd.flatmap(lambda is_odd: st.one_of(*[good] * 6, *bad) if is_odd else good)


def number(low, high):
    """A number in a range; in odd cases perhaps another, or none."""
    return among(st.floats(low, high), extreme, wrong)


def choice(*names):
    """One of some names; in odd cases perhaps another."""
    return among(st.sampled_from(names), st.sampled_from(["", "magic", None, 1, [], {}]))


shapes = st.tuples(st.integers(1, 24), st.integers(1, 24))
lengths = st.just(1.0) | number(1e-6, 1e6) | st.tuples(st.floats(0.1, 10), st.floats(0.1, 10))


class Height(NamedTuple):
    """A surface, by the way it is made: the example of a defect stays short."""

    kind: str
    shape: tuple[int, int] = (8, 8)
    seed: int = 0
    scale: float = 1.0
    offset: float = 0.0


KINDS = ("noise", "smooth", "levels", "integers", "tilted", "flat", "spike")
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
    kind, shape, number, scale, offset = height
    y, x = np.indices(shape)
    values = np.random.default_rng(number).standard_normal(shape)
    if kind == "smooth":
        values = np.cos(2 * np.pi * x / shape[1]) + np.cos(2 * np.pi * y / shape[0])
    elif kind == "levels":
        values = np.round(values)
    elif kind == "integers":
        return np.round(values).astype(int)
    elif kind == "tilted":
        values = x.astype(float)
    elif kind == "flat":
        values = np.zeros(shape)
    elif kind == "spike":
        values = -np.where((x == 0) & (y == 0), 1.0, 0.0)
    elif kind in ("nan", "inf", "1e300"):
        values[0, 0] = float(kind)
    elif kind == "complex":
        return values.astype(complex)
    elif kind == "boolean":
        return values > 0
    elif kind == "objects":
        return np.full(shape, 10**400, object)
    elif kind == "line":
        return values[0]
    elif kind == "empty":
        return values[:0]
    elif kind == "text":
        return values.astype(str)
    return values * scale + offset


layers = st.fixed_dictionaries(
    {"young": st.just(1.0) | number(1e-3, 1e12), "poisson": number(-0.99, 0.5)},
    optional={
        "height": st.none() | number(1e-3, 10.0),
        "bottom": choice("bonded", "frictionless", "free"),
        "lateral": choice("confined", "free"),
    },
)


def pressed(case):
    """The pressure of a surface's upper half on a solid."""
    values = made(case["pressure"])
    if values.dtype == float:
        values = np.maximum(values, 0.0)
    grid = asp.Grid(values.shape, case.get("length", 1.0))
    return asp.PressedSolid(values, grid, asp.Layer(**case["layer"]), case.get("boundary", "periodic"))
