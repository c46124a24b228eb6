"""Plans of FFTW for blocks of lines, measured or estimated.

FFTW keeps what it knows of plans, its wisdom, for the whole process, and it may change the next plan. Each
plan is therefore made from a given wisdom alone; the wisdom of other users of pyFFTW in the process is kept
for them.
"""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from functools import cache
from math import prod
from typing import NamedTuple

import numpy as np
import pyfftw

from asperity.types import Array

COLUMNS = ("forward", "inverse")
KINDS = ("r2c", "c2r", *COLUMNS)
"""Transforms of rows, real to complex and back, and of complex columns."""

PRECISIONS = ("float64", "float32")
"""Precisions in the order in which pyFFTW gives its wisdom."""

_ROWS = 2**15, 16
"""Number of values in a block of rows, about, and the fewest rows: half a megabyte, within the cache."""

_COLUMNS = 2**13, 8
"""The same for columns. Few are copied at a time: each element of a long column lies in another page of the
memory, and more columns take longer than the same number in smaller blocks."""

_ALIGNMENT = 64
"""Bytes of which the address of every array is a multiple."""

_planner = threading.Lock()
"""Held while FFTW plans: it makes one plan at a time."""


class Key(NamedTuple):
    """All that a plan depends on besides its wisdom.

    Parameters
    ----------
    kind : str
        One of `KINDS`.
    length : int
        Number of values in a line, for rows that of the real ones.
    lines : int
        Number of lines in a block.
    precision : "float64" or "float32"
    """

    kind: str
    length: int
    lines: int
    precision: str

    @property
    def name(self) -> str:
        """Name of the plan in a wisdom file, such as ``r2c 1024 16 float64``."""
        return " ".join(map(str, self))


@cache
def keys_of(rows: int, ny: int, nx: int, precision: str) -> dict[str, Key]:
    """Kind → plan for a grid of (ny, nx) nodes, of whose fields the first rows are given or asked for."""
    columns = nx // 2 + 1
    return {
        kind: Key(kind, ny, _lines_of_block(_COLUMNS, columns, ny), precision)
        if kind in COLUMNS
        else Key(kind, nx, _lines_of_block(_ROWS, rows, nx), precision)
        for kind in KINDS
    }


def _lines_of_block(size: tuple[int, int], lines: int, length: int) -> int:
    """Number of lines in a block of an array with so many lines of this length; the last may have fewer."""
    values, fewest = size
    blocks = -(-lines // max(values // length, fewest))
    return -(-lines // blocks)


class Plan:
    """A transform of one block of lines, in memory of its own or shared with plans that run at other times.

    Attributes
    ----------
    source, target : array
        Lines before and after the transform, (lines, length); one array if both are complex.
    execute : callable
        Transforms `source` into `target`, and may overwrite `source`.
    """

    def __init__(self, key: Key, memory: Array, flags: tuple[str, ...]) -> None:
        self.source, self.target = _arrays(key, memory)
        self.execute: Callable[[], None] = pyfftw.FFTW(
            self.source,
            self.target,
            axes=(1,),
            direction="FFTW_FORWARD" if key.kind in ("r2c", "forward") else "FFTW_BACKWARD",
            flags=(*flags, "FFTW_DESTROY_INPUT"),
            threads=1,
        ).execute


class Workspace:
    """The plans of one thread, which share their memory.

    Parameters
    ----------
    wisdom : mapping
        Name of a plan → wisdom with which it was measured. Other plans are estimated.
    """

    def __init__(self, wisdom: Mapping[str, str]) -> None:
        self._wisdom = wisdom
        self._plans: dict[Key, Plan] = {}
        self._memory = pyfftw.empty_aligned(0, np.uint8)

    def plan(self, kind: str, keys: Mapping[str, Key]) -> Plan:
        """The plan of a kind; all plans of a grid are made when one of them is first asked for."""
        if keys[kind] not in self._plans:
            if (size := max(map(_bytes, keys.values()))) > self._memory.size:
                self._plans.clear()
                self._memory = pyfftw.empty_aligned(size, np.uint8, n=_ALIGNMENT)
            with _no_wisdom():
                self._plans |= {key: self._planned(key) for key in keys.values()}
        return self._plans[keys[kind]]

    def _planned(self, key: Key) -> Plan:
        """A plan from its own wisdom, or an estimated one."""
        pyfftw.forget_wisdom()
        if (known := self._wisdom.get(key.name)) is None:
            return Plan(key, self._memory, ("FFTW_ESTIMATE",))
        _import(key.precision, known)
        return Plan(key, self._memory, ("FFTW_MEASURE", "FFTW_WISDOM_ONLY"))


def measure(key: Key) -> str:
    """Wisdom of the fastest plan that FFTW finds by timing candidates."""
    memory = pyfftw.empty_aligned(_bytes(key), np.uint8, n=_ALIGNMENT)
    with _no_wisdom():
        Plan(key, memory, ("FFTW_MEASURE",))
        return pyfftw.export_wisdom()[PRECISIONS.index(key.precision)].decode("ascii")


def is_known(precision: str, wisdom: str) -> bool:
    """True for a wisdom that comes from the FFTW in use, on a processor of the same kind."""
    try:
        with _no_wisdom():
            _import(precision, wisdom)
    except ValueError:
        return False
    return True


@contextmanager
def _no_wisdom() -> Iterator[None]:
    """Block of one thread at a time that begins without wisdom, and ends with that from before."""
    with _planner:
        kept = pyfftw.export_wisdom()
        pyfftw.forget_wisdom()
        try:
            yield
        finally:
            pyfftw.forget_wisdom()
            if any(b"\n  (" in text for text in kept):  # importing none would take as long as importing much
                pyfftw.import_wisdom(kept)


def _import(precision: str, wisdom: str) -> None:
    """Give FFTW a wisdom; ValueError if it does not accept it."""
    texts = [wisdom.encode("ascii", "replace") if precision == known else b"" for known in PRECISIONS]
    if precision not in PRECISIONS or not pyfftw.import_wisdom((*texts, b""))[PRECISIONS.index(precision)]:
        raise ValueError("wisdom: that of another FFTW or processor")


def _shapes(key: Key) -> list[tuple[tuple[int, int], np.dtype[np.generic]]]:
    """Shape and type of the source of a plan and, if it is another array, of its target."""
    real = np.dtype(key.precision)
    complex_ = np.result_type(real, np.complex64)
    if key.kind in COLUMNS:
        return [((key.lines, key.length), complex_)]
    both = [((key.lines, key.length), real), ((key.lines, key.length // 2 + 1), complex_)]
    return both if key.kind == "r2c" else both[::-1]


def _arrays(key: Key, memory: Array) -> tuple[Array, Array]:
    """Source and target of a plan at the beginning of a memory."""
    arrays, start = [], 0
    for shape, kind in _shapes(key):
        size = prod(shape) * kind.itemsize
        arrays.append(memory[start : start + size].view(kind).reshape(shape))
        start += -(-size // _ALIGNMENT) * _ALIGNMENT
    return arrays[0], arrays[-1]


def _bytes(key: Key) -> int:
    """Memory of a plan."""
    return sum(-(-prod(shape) * kind.itemsize // _ALIGNMENT) * _ALIGNMENT for shape, kind in _shapes(key))
