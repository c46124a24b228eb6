"""Transforms by FFTW, through pyFFTW.

A plan of FFTW holds for arrays of one shape, distance of rows and alignment in memory. Here every plan
transforms a block of lines in an aligned array of its own: blocks are copied there, transformed, and copied
back, within the processor's cache. A plan then depends on the length of the lines, the kind of transform
and the precision alone, and the result does not depend on where the allocator places an array. Plans use
one thread. With several threads, each transforms blocks of its own, so that the result has the same bits
for any number of threads.

Columns are transformed in place. For rows, whose real and complex lines differ in length, this takes a
tenth longer than from one array to another.
"""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from importlib.metadata import version
from itertools import pairwise
from typing import Any

import numpy as np
import pyfftw

from asperity.engines.interface import Engine
from asperity.engines.plans import Key, Plan, Workspace, lines_of_block
from asperity.engines.wisdom import Wisdom
from asperity.types import Array

_SMALL = 2**16
"""Number of values up to which an array is transformed by one thread: starting others would take longer."""


class PyfftwEngine(Engine):
    """Transforms by FFTW, with the measured plans of a wisdom and with estimated ones for other lengths."""

    def __init__(self, wisdom: Wisdom | None = None) -> None:
        self._wisdom = wisdom or Wisdom({})
        self._idle: list[Workspace] = []

    @property
    def description(self) -> str:
        plans = f"wisdom {self._wisdom.digest}" if self._wisdom.plans else "estimated plans"
        return f"pyfftw {version('pyfftw')}, FFTW {pyfftw.fftw_version}, {plans}"

    def rows_forward(self, values: Array, out: Array, threads: int = 1) -> None:
        factor = values.dtype.type(1 / values.shape[1])

        def transform(plan: Plan, rows: slice, count: int) -> None:
            plan.source[:count] = values[rows]
            plan.execute()
            np.multiply(plan.target[:count], factor, out=out[rows])

        self._run("r2c", *values.shape, values.dtype, threads, transform)

    def rows_inverse(self, coefficients: Array, out: Array, threads: int = 1) -> None:
        def transform(plan: Plan, rows: slice, count: int) -> None:
            plan.source[:count] = coefficients[rows]
            plan.execute()
            out[rows] = plan.target[:count]

        self._run("c2r", *out.shape, out.dtype, threads, transform)

    def columns_forward(self, values: Array, out: Array, threads: int = 1) -> None:
        factor = values.real.dtype.type(1 / values.shape[0])

        def transform(plan: Plan, columns: slice, count: int) -> None:
            plan.source[:, :count] = values[:, columns]
            plan.execute()
            np.multiply(plan.target[:, :count], factor, out=out[:, columns])

        self._run("forward", *values.shape[::-1], values.real.dtype, threads, transform)

    def columns_inverse(self, coefficients: Array, out: Array, threads: int = 1) -> None:
        def transform(plan: Plan, columns: slice, count: int) -> None:
            plan.source[:, :count] = coefficients[:, columns]
            plan.execute()
            out[:, columns] = plan.target[:, :count]

        self._run("inverse", *coefficients.shape[::-1], coefficients.real.dtype, threads, transform)

    def _run(
        self,
        kind: str,
        lines: int,
        length: int,
        precision: np.dtype[Any],
        threads: int,
        transform: Callable[[Plan, slice, int], None],
    ) -> None:
        """Transform all lines, block by block; `transform` is given plan, lines and number of lines."""
        size = lines_of_block(length)
        whole, single = (Key(kind, length, count, precision.name) for count in (size, 1))
        starts = range(0, lines, size)

        def work(part: range) -> None:
            try:
                workspace = self._idle.pop()
            except IndexError:
                workspace = Workspace(self._wisdom.plans)
            try:
                for start in part:
                    count = min(size, lines - start)
                    plan = workspace.plan(single if count == 1 else whole)
                    transform(plan, slice(start, start + count), count)
            finally:
                self._idle.append(workspace)

        workers = min(threads, len(starts)) if lines * length > _SMALL else 1
        if workers == 1:
            work(starts)
            return
        edges = [len(starts) * number // workers for number in range(workers + 1)]
        with ThreadPoolExecutor(workers) as pool:
            list(pool.map(work, (starts[first:last] for first, last in pairwise(edges))))
