"""Plans of FFTW for blocks of lines, measured or estimated.

FFTW keeps what it knows of plans, its wisdom, for the whole process, and it may change the next plan. Each
plan is therefore made from a given wisdom alone; the wisdom of other users of pyFFTW in the process is kept
for them.
"""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from math import prod
from typing import NamedTuple

import numpy as np
import pyfftw

from asperity.types import Array

KINDS = ("r2c", "c2r", "forward", "inverse")
"""Transforms of rows, real to complex and back, and of complex columns."""

PRECISIONS = ("float64", "float32")
"""Precisions in the order in which pyFFTW gives its wisdom."""

_LONG = 64
"""Length above which blocks have `_FEW` lines."""

_FEW, _MANY = 16, 64
"""Lines in a block. For more than 16 long columns FFTW estimates plans that are up to six times slower."""

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


def lines_of_block(length: int) -> int:
    """Number of lines of this length in a block."""
    return _FEW if length > _LONG else _MANY


class Plan:
    """A transform of one block of lines, in memory of its own or shared with plans that run at other times.

    Attributes
    ----------
    source, target : array
        Lines before and after the transform: rows (lines, length), or columns (length, lines) in one array.
    execute : callable
        Transforms `source` into `target`, and may overwrite `source`.
    """

    def __init__(self, key: Key, memory: Array, flags: tuple[str, ...]) -> None:
        self.source, self.target = _arrays(key, memory)
        self.execute: Callable[[], None] = pyfftw.FFTW(
            self.source,
            self.target,
            axes=(0 if self.source is self.target else 1,),
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

    def plan(self, key: Key) -> Plan:
        """The plan of a key, made when it is first asked for."""
        if key not in self._plans:
            if (size := _bytes(key)) > self._memory.size:
                self._plans.clear()
                self._memory = pyfftw.empty_aligned(size, np.uint8, n=_ALIGNMENT)
            known = self._wisdom.get(key.name)
            with _wisdom_of_its_own(key.precision, known):
                flags = ("FFTW_MEASURE", "FFTW_WISDOM_ONLY") if known else ("FFTW_ESTIMATE",)
                self._plans[key] = Plan(key, self._memory, flags)
        return self._plans[key]


def measure(key: Key) -> str:
    """Wisdom of the fastest plan that FFTW finds by timing candidates."""
    memory = pyfftw.empty_aligned(_bytes(key), np.uint8, n=_ALIGNMENT)
    with _wisdom_of_its_own(key.precision):
        Plan(key, memory, ("FFTW_MEASURE",))
        return pyfftw.export_wisdom()[PRECISIONS.index(key.precision)].decode("ascii")


def is_known(precision: str, wisdom: str) -> bool:
    """True for a wisdom that comes from the FFTW in use, on a processor of the same kind."""
    try:
        with _wisdom_of_its_own(precision, wisdom):
            return True
    except ValueError:
        return False


@contextmanager
def _wisdom_of_its_own(precision: str, wisdom: str | None = None) -> Iterator[None]:
    """Block in which FFTW has this wisdom, or none; ValueError if it does not accept it."""
    texts = [wisdom.encode("ascii", "replace") if wisdom and precision == p else b"" for p in PRECISIONS]
    with _planner:
        kept = pyfftw.export_wisdom()
        pyfftw.forget_wisdom()
        try:
            if wisdom and not pyfftw.import_wisdom((*texts, b""))[PRECISIONS.index(precision)]:
                raise ValueError("wisdom: that of another FFTW or processor")
            yield
        finally:
            pyfftw.forget_wisdom()
            pyfftw.import_wisdom(kept)


def _shapes(key: Key) -> list[tuple[tuple[int, int], np.dtype[np.generic]]]:
    """Shape and type of the source of a plan and, if it is another array, of its target."""
    real = np.dtype(key.precision)
    complex_ = np.result_type(real, np.complex64)
    if key.kind in ("forward", "inverse"):
        return [((key.length, key.lines), complex_)]
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
