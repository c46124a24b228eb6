"""Transforms by ducc0.

The lines of an array are transformed in blocks that do not depend on the number of threads, so that the
result has the same bits for any number of threads.
"""

from __future__ import annotations

import ducc0
import numpy as np

from asperity.engines.interface import Engine
from asperity.parallel import in_parts
from asperity.types import Array

# Lines are transformed in multiples of this number, and the remaining ones by a single thread. ducc0
# transforms as many lines at once as a vector register holds numbers, and left-over lines one by one, which
# rounds differently: multiples of 128 leave none over in any thread.
_BLOCK = 128

# Distance of rows in bytes whose elements share the same lines of the processor's cache. Writing several such
# rows at once in single precision takes three times as long as writing rows that are `_PADDING` numbers
# longer.
_CRITICAL_STRIDE = 4096
_PADDING = 16


class Ducc0Engine(Engine):
    """Transforms by ducc0, which needs no plans."""

    @property
    def description(self) -> str:
        return f"ducc0 {ducc0.__version__}"

    def forward(self, values: Array, out: Array, threads: int = 1) -> None:
        lines = values.shape[0]
        for rows, workers in _blocks(lines, threads):
            ducc0.fft.r2c(values[rows], axes=(1,), forward=True, inorm=2, out=out[rows], nthreads=workers)
        out[lines:] = 0
        for columns, workers in _blocks(out.shape[1], threads):
            part = out[:, columns]
            ducc0.fft.c2c(part, axes=(0,), forward=True, inorm=2, out=part, nthreads=workers)

    def inverse(self, coefficients: Array, out: Array, work: Array, threads: int = 1) -> None:
        for columns, workers in _blocks(coefficients.shape[1], threads):
            ducc0.fft.c2c(
                coefficients[:, columns], axes=(0,), forward=False, out=work[:, columns], nthreads=workers
            )
        lines, nx = out.shape
        if out.strides[0] % _CRITICAL_STRIDE or out.dtype != np.float32:
            for rows, workers in _blocks(lines, threads):
                _inverse_rows(work[rows], out[rows], workers)
            return

        def transform(part: slice) -> None:
            room = np.empty((_BLOCK, nx + _PADDING), out.dtype)[:, :nx]
            for first in range(part.start, part.stop, _BLOCK):
                rows = slice(first, min(first + _BLOCK, part.stop))
                target = room[: rows.stop - first]
                _inverse_rows(work[rows], target, 1)
                out[rows] = target

        in_parts(transform, lines, threads, multiple=_BLOCK, smallest=_BLOCK)

    def inverse_columns(self, coefficients: Array, out: Array, nx: int) -> None:
        ducc0.fft.c2c(coefficients, axes=(1,), forward=False, out=out, nthreads=1)

    def inverse_rows(self, coefficients: Array, out: Array, ny: int) -> None:
        ducc0.fft.c2r(
            coefficients,
            axes=(2,),
            lastsize=out.shape[2],
            forward=False,
            out=out,
            nthreads=1,
            allow_overwriting_input=True,
        )


def _inverse_rows(coefficients: Array, out: Array, threads: int) -> None:
    ducc0.fft.c2r(
        coefficients,
        axes=(1,),
        lastsize=out.shape[1],
        forward=False,
        out=out,
        nthreads=threads,
        allow_overwriting_input=True,
    )


def _blocks(lines: int, threads: int) -> list[tuple[slice, int]]:
    """Blocks of lines, with the number of threads for each."""
    whole = lines - lines % _BLOCK
    parts = [(slice(0, whole), threads), (slice(whole, lines), 1)]
    return [(block, workers) for block, workers in parts if block.start < block.stop]
