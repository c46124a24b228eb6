"""Transforms by FFTW, through pyFFTW.

A plan of FFTW holds for arrays of one shape, distance of rows and alignment in memory. Here every plan
transforms a block of lines in an aligned array of its own: blocks are copied there, transformed, and copied
back, within the processor's cache. A plan then depends on the length and number of the lines, the kind of
transform and the precision alone, and the result does not depend on where the allocator places an array.
Plans use one thread. With several threads, each transforms blocks of its own, so that the result has the
same bits for any number of threads.

Columns are copied into rows and transformed in place. For rows, whose real and complex lines differ in
length, a transform in place takes a tenth longer than one from an array to another.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial
from importlib.metadata import version
from itertools import pairwise

import numpy as np
import pyfftw

from asperity.engines.interface import Engine
from asperity.engines.plans import Key, Plan, Workspace, keys_of
from asperity.engines.wisdom import Wisdom
from asperity.tasks import results_of
from asperity.types import Array

_SMALL = 2**19
"""Number of values up to which an array is transformed by one thread: several would wait for each other."""


class PyfftwEngine(Engine):
    """Transforms by FFTW, with the measured plans of a wisdom and with estimated ones for other lengths."""

    def __init__(self, wisdom: Wisdom | None = None) -> None:
        self._wisdom = wisdom or Wisdom({})
        self._idle: list[Workspace] = []

    @property
    def description(self) -> str:
        plans = f"wisdom {self._wisdom.digest}" if self._wisdom.plans else "estimated plans"
        return f"pyfftw {version('pyfftw')}, FFTW {pyfftw.fftw_version}, {plans}"

    def forward(self, values: Array, out: Array, threads: int = 1) -> None:
        (rows, nx), ny = values.shape, out.shape[0]
        keys = keys_of(rows, ny, nx, values.dtype.name)
        factor = values.dtype.type(1 / (nx * ny))

        def transform(plan: Plan, lines: slice, count: int) -> None:
            np.multiply(values[lines], factor, out=plan.source[:count])
            plan.execute()
            out[lines] = plan.target[:count]

        self._run("r2c", keys, rows, threads, transform)
        out[rows:] = 0
        self._columns("forward", keys, out, out, threads)

    def inverse(self, coefficients: Array, out: Array, work: Array, threads: int = 1) -> None:
        keys = keys_of(out.shape[0], coefficients.shape[0], out.shape[1], out.dtype.name)
        self._columns("inverse", keys, coefficients, work, threads)
        self._inverse_rows(keys, work, out, threads)

    def inverse_columns(self, coefficients: Array, out: Array, nx: int) -> None:
        ny = coefficients.shape[1]
        keys = keys_of(ny, ny, nx, coefficients.real.dtype.name)
        for source, target in zip(coefficients, out, strict=True):
            self._columns("inverse", keys, source, target, threads=1)

    def inverse_rows(self, coefficients: Array, out: Array, ny: int) -> None:
        keys = keys_of(ny, ny, out.shape[2], out.dtype.name)
        for source, target in zip(coefficients, out, strict=True):
            self._inverse_rows(keys, source, target, threads=1)

    def _inverse_rows(self, keys: Mapping[str, Key], source: Array, target: Array, threads: int) -> None:
        def transform(plan: Plan, lines: slice, count: int) -> None:
            plan.source[:count] = source[lines]
            plan.execute()
            target[lines] = plan.target[:count]

        self._run("c2r", keys, target.shape[0], threads, transform)

    def _columns(
        self, kind: str, keys: Mapping[str, Key], source: Array, target: Array, threads: int
    ) -> None:
        """Transform the columns of an array into those of another, which may be the same."""

        def transform(plan: Plan, lines: slice, count: int) -> None:
            plan.source[:count] = source[:, lines].T
            plan.execute()
            target[:, lines] = plan.target[:count].T

        self._run(kind, keys, source.shape[1], threads, transform)

    def _run(
        self,
        kind: str,
        keys: Mapping[str, Key],
        lines: int,
        threads: int,
        transform: Callable[[Plan, slice, int], None],
    ) -> None:
        """Transform all lines, block by block.

        Parameters
        ----------
        kind : str
            One of `asperity.engines.plans.KINDS`.
        keys : mapping
            Kind → plan for the grid.
        lines : int
            Number of lines.
        threads : int
        transform : callable
            Transforms a block; called with plan, lines and number of lines.
        """
        _, length, size, _ = keys[kind]
        starts = range(0, lines, size)

        def work(part: range) -> None:
            try:
                workspace = self._idle.pop()
            except IndexError:
                workspace = Workspace(self._wisdom.plans)
            try:
                plan = workspace.plan(kind, keys)
                for start in part:
                    count = min(size, lines - start)
                    transform(plan, slice(start, start + count), count)
            finally:
                self._idle.append(workspace)

        workers = min(threads, len(starts)) if lines * length > _SMALL else 1
        edges = [len(starts) * number // workers for number in range(workers + 1)]
        results_of([partial(work, starts[first:last]) for first, last in pairwise(edges)], workers)
