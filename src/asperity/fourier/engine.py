"""Engines: the libraries that compute Fourier transforms, and the choice between them.

There are three: ducc0, the default, pyFFTW and SciPy. `fft_engine` chooses one for a ``with`` block, in the
thread that enters it. Outside such blocks the environment variable ``ASPERITY_FFT_ENGINE`` names the engine,
else it is `DEFAULT`.

All have the same methods, with the normalisation of `asperity.fourier.grid`. Arrays may be views, with rows
at any distance, and an engine may be used by several threads at once.

Results of two engines differ by rounding errors. Results of one engine have the same bits for any number of
threads and in every run, with pyFFTW as long as the wisdom of FFTW is kept.
"""

import json
import os
import re
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from contextvars import ContextVar
from functools import cache, partial
from importlib import metadata
from pathlib import Path
from tempfile import NamedTemporaryFile
from typing import Any

import numpy as np
import scipy  # whose transforms are loaded when they are first used

from asperity.core.errors import shown
from asperity.core.packages import ENGINES as ENGINES
from asperity.core.packages import require
from asperity.core.parallel import in_parts
from asperity.core.types import Array

DEFAULT = ENGINES[0]
"""Engine where none is chosen; paper/supplement/tradeoff.md has the measurement behind it."""

VARIABLE = "ASPERITY_FFT_ENGINE"
"""Environment variable with the engine of a process in which none is chosen."""

# ducc0 reads one number, 0 for all processors, and fails at anything else. OpenMP allows one for each level
# of nested threads, such as "4,2", and ignores other text.
_threads = (os.environ.get("DUCC0_NUM_THREADS") or os.environ.get("OMP_NUM_THREADS", "0")).split(",")[0]
os.environ["DUCC0_NUM_THREADS"] = _threads if re.fullmatch(r"\s*[0-9]{1,9}\s*", _threads) else "0"

_chosen: ContextVar["Engine | None"] = ContextVar("asperity_fft_engine", default=None)


@contextmanager
def fft_engine(name: str) -> "Iterator[Engine]":
    """Compute all Fourier transforms within a ``with`` block by one engine.

    The choice holds in the thread that enters the block; a thread that is started inside makes its own.
    Results carry the engine in their attribute ``fft_engine``.

    Parameters
    ----------
    name : "ducc0", "pyfftw" or "scipy"
        SciPy is under the BSD licence, ducc0 and FFTW under the GPL. pyFFTW is installed by
        ``pip install "asperity[fftw]"``. FFTW measures the fastest plans at the first use of each size of
        grid; they are kept in the folder ``asperity`` of the user's cache.

    Yields
    ------
    Engine

    Raises
    ------
    ValueError
        If there is no engine of this name.
    MissingPackageError
        If the engine is not installed.

    Examples
    --------
    >>> height = asp.self_affine((64, 64), 0.8, 0.5, 0.125, rms_height=1e-3, seed=1)
    >>> with asp.fft_engine("ducc0"):
    ...     contact = asp.solve_contact(height, asp.Solid(young=1.0, poisson=0.3), contact_area_fraction=0.1)
    >>> contact.fft_engine
    'ducc0 ...'
    """
    engine = _engine("fft_engine", name)
    token = _chosen.set(engine)
    try:
        yield engine
    finally:
        _chosen.reset(token)


def current_engine() -> "Engine":
    """The engine in use: chosen by the block, else by the environment variable, else the default."""
    return _chosen.get() or _engine(VARIABLE, os.environ.get(VARIABLE) or DEFAULT)


def _engine(argument: str, name: str) -> "Engine":
    if name not in ENGINES:
        raise ValueError(f"{argument} = {shown(name)}: {' or '.join(ENGINES)} is needed")
    require((name,))
    return _ENGINES[name]


version = cache(metadata.version)
"""Version of a package, whose files are read once."""


class Ducc0Engine:
    """Transforms by ducc0, which needs no plans.

    ducc0 transforms as many lines at once as a vector register holds numbers, and left-over lines one by one,
    which rounds differently. Several threads therefore share a multiple of `LINES`, and one does the rest: no
    thread has lines left over.
    """

    LINES = 128

    # Distance of rows in bytes whose elements share the same lines of the processor's cache. In single
    # precision ducc0 takes two to four times as long to write such rows, and twice as long to read them, as
    # with rows that are so many numbers longer, and to copy them.
    CRITICAL_STRIDE = 4096
    PADDING = 16

    @property
    def description(self) -> str:
        """Library and version, as recorded in results."""
        return f"ducc0 {version('ducc0')}"

    def forward(self, values: Array, out: Array, threads: int = 1) -> None:
        """Write the coefficients of a field into `out`, (ny, nx // 2 + 1).

        `values`, (rows, nx), are the first rows of the field; the other ny - rows are taken to be zero.
        """
        import ducc0

        def transform(rows: Array, target: Array, workers: int) -> None:
            ducc0.fft.r2c(rows, axes=(1,), forward=True, inorm=2, out=target, nthreads=workers)

        def transform_copied(rows: slice, room: Array) -> None:
            room[...] = values[rows]
            transform(room, out[rows], 1)

        count = len(values)
        if self._is_slow(values):
            self._with_room(transform_copied, values, threads)
        else:
            for part, workers in self._shares(count, threads):
                transform(values[part], out[part], workers)
        out[count:] = 0
        for part, workers in self._shares(out.shape[1], threads):
            columns = out[:, part]
            ducc0.fft.c2c(columns, axes=(0,), forward=True, inorm=2, out=columns, nthreads=workers)

    def inverse_along_y(self, coefficients: Array, out: Array, threads: int = 1) -> None:
        """Transform columns back, (..., ny, columns); `out` may be `coefficients`."""
        import ducc0

        axis = out.ndim - 2
        for part, workers in self._shares(out.shape[-1], threads):
            columns, target = coefficients[..., part], out[..., part]
            ducc0.fft.c2c(columns, axes=(axis,), forward=False, out=target, nthreads=workers)

    def inverse_along_x(self, coefficients: Array, out: Array, threads: int = 1) -> None:
        """Transform rows back, from (..., rows, nx // 2 + 1) to `out`, (..., rows, nx).

        `coefficients` may be overwritten, and the rows of `out` may begin at the same addresses.
        """
        if not self._is_slow(out):
            for part, workers in self._shares(out.shape[-2], threads):
                _rows_back(coefficients[..., part, :], out[..., part, :], workers)
            return

        def transform(rows: slice, room: Array) -> None:
            for source, target in zip(_planes(coefficients), _planes(out), strict=True):
                _rows_back(source[rows], room, 1)
                target[rows] = room

        self._with_room(transform, out, threads)

    def cosines(
        self, values: Array, out: Array, axis: int, odd: bool, forward: bool, threads: int = 1
    ) -> None:
        """Transform along an axis of a mirrored field, (ny, nx), to coefficients of cosines, or back.

        An odd field has coefficients of sines instead; the sine of the wave k has the index k − 1.
        `out` may be `values`.
        """
        import ducc0

        transform = partial(
            ducc0.fft.dst if odd else ducc0.fft.dct,
            axes=(axis,),
            type=2 if forward else 3,
            inorm=2 if forward else 0,
        )
        if axis == 0 or not self._is_slow(values):
            for part, workers in self._shares(values.shape[1 - axis], threads):
                lines = (part, slice(None)) if axis == 1 else (slice(None), part)
                transform(values[lines], out=out[lines], nthreads=workers)
            return

        def transform_copied(rows: slice, room: Array) -> None:
            room[...] = values[rows]
            transform(room, out=room)
            out[rows] = room

        self._with_room(transform_copied, values, threads)

    def _is_slow(self, field: Array) -> bool:
        """True if the distance of the rows of a field makes its transforms slow."""
        return field.dtype == np.float32 and field.strides[-2] % self.CRITICAL_STRIDE == 0

    def _with_room(self, work: Callable[[slice, Array], None], field: Array, threads: int) -> None:
        """Call a function for `LINES` rows at a time, with memory for them at a distance that is not slow."""

        def go_through(part: slice) -> None:
            room = np.empty((self.LINES, field.shape[-1] + self.PADDING), field.dtype)[:, : field.shape[-1]]
            for first in range(part.start, part.stop, self.LINES):
                rows = slice(first, min(first + self.LINES, part.stop))
                work(rows, room[: rows.stop - first])

        in_parts(go_through, field.shape[-2], threads, multiple=self.LINES, smallest=self.LINES)

    @classmethod
    def _shares(cls, lines: int, threads: int) -> list[tuple[slice, int]]:
        """Slices of the lines, with the number of threads for each."""
        if threads == 1:
            return [(slice(0, lines), 1)]
        shared = lines - lines % cls.LINES
        return [(slice(shared), threads)] * (shared > 0) + [(slice(shared, lines), 1)] * (shared < lines)


class PyfftwEngine:
    """Transforms by FFTW, through pyFFTW.

    A plan of FFTW holds for arrays of one shape, distance of rows and alignment in memory; its own threads
    change the plan. Here a plan transforms a block of `LINES` lines, in aligned memory of its own, by one
    thread: lines are copied there, transformed and copied back. Several threads share the blocks. The bits of
    the result depend neither on the number of threads nor on the address of an array.
    """

    LINES = 16

    def __init__(self) -> None:
        self._of_thread = threading.local()
        self._planner = threading.Lock()  # FFTW makes one plan at a time

    @property
    def description(self) -> str:
        import pyfftw

        return f"pyfftw {version('pyfftw')}, FFTW {pyfftw.fftw_version}"

    def forward(self, values: Array, out: Array, threads: int = 1) -> None:
        (rows, nx), ny = values.shape, len(out)
        self._transform("r2c", values, out[:rows], nx, threads, values.dtype.type(1 / (nx * ny)))
        out[rows:] = 0
        self._transform("forward", out.T, out.T, ny, threads)

    def inverse_along_y(self, coefficients: Array, out: Array, threads: int = 1) -> None:
        for source, target in zip(_planes(coefficients), _planes(out), strict=True):
            self._transform("inverse", source.T, target.T, len(target), threads)

    def inverse_along_x(self, coefficients: Array, out: Array, threads: int = 1) -> None:
        for source, target in zip(_planes(coefficients), _planes(out), strict=True):
            self._transform("c2r", source, target, target.shape[1], threads)

    def cosines(
        self, values: Array, out: Array, axis: int, odd: bool, forward: bool, threads: int = 1
    ) -> None:
        source, target = (values, out) if axis == 1 else (values.T, out.T)
        length = source.shape[1]
        kind = f"FFTW_R{'O' if odd else 'E'}DFT{'10' if forward else '01'}"
        factor = values.dtype.type(0.5 / length) if forward else None
        self._transform(kind, source, target, length, threads, factor)

    def _transform(
        self, kind: str, source: Array, target: Array, length: int, threads: int, factor: Any = None
    ) -> None:
        """Transform the lines of an array, (lines, ...), after multiplication by a factor."""
        precision = source.real.dtype.name
        key = f"{kind} {length} {precision}"

        def transform(part: slice) -> None:
            plans = vars(self._of_thread)  # each thread has plans of its own
            if key not in plans:
                plans[key] = self._plan(kind, length, precision)
            before, after, execute = plans[key]
            for start in range(part.start, part.stop, self.LINES):
                lines = slice(start, min(start + self.LINES, part.stop))
                count = lines.stop - start
                before[:count] = source[lines]
                if factor is not None:
                    before[:count] *= factor
                execute()
                target[lines] = after[:count]

        in_parts(transform, len(source), threads, multiple=self.LINES, smallest=4 * self.LINES)

    def _plan(self, kind: str, length: int, precision: str) -> tuple[Array, Array, Callable[[], None]]:
        """A plan from the wisdom of earlier runs, or a measured one whose wisdom is kept for later runs.

        The file of wisdom in the user's cache is replaced as a whole: of processes that measure plans at
        once, the last one keeps its own. Where the cache cannot be written, plans are measured in every run.
        """
        import pyfftw

        complex_type = np.result_type(precision, np.complex64)
        real = pyfftw.zeros_aligned((self.LINES, length), precision, n=64)
        half = pyfftw.zeros_aligned((self.LINES, length // 2 + 1), complex_type, n=64)
        whole = pyfftw.zeros_aligned((self.LINES, length), complex_type, n=64)
        before, after = {"r2c": (real, half), "c2r": (half, real)}.get(kind, (whole, whole))
        direction = "FFTW_FORWARD" if kind in ("r2c", "forward") else "FFTW_BACKWARD"
        if kind.startswith("FFTW"):
            before, after, direction = real, real, kind
        flags = "FFTW_MEASURE", "FFTW_DESTROY_INPUT"
        folder = Path(os.environ.get("XDG_CACHE_HOME") or os.path.expanduser("~/.cache")) / "asperity"
        path = folder / f"fftw_wisdom_{version('pyfftw')}.json"
        with self._planner:
            with suppress(OSError, ValueError, IndexError):
                pyfftw.import_wisdom([text.encode() for text in json.loads(path.read_text())])
            known = pyfftw.export_wisdom()
            plan = pyfftw.FFTW(before, after, (1,), direction, flags, threads=1)
            if (wisdom := pyfftw.export_wisdom()) != known:
                with suppress(OSError):
                    folder.mkdir(parents=True, exist_ok=True)
                    with NamedTemporaryFile("w", dir=folder, delete=False) as file:
                        json.dump([text.decode() for text in wisdom], file)
                    os.replace(file.name, path)
        return before, after, plan.execute


class ScipyEngine:
    """Transforms by pocketfft in SciPy, in blocks that stay in the processor's cache.

    The last block alone may leave lines over for a vector register, whatever the number of threads.
    """

    LINES = Ducc0Engine.LINES

    @property
    def description(self) -> str:
        return f"scipy {version('scipy')}"

    def forward(self, values: Array, out: Array, threads: int = 1) -> None:
        rows = len(values)
        self._transform(scipy.fft.rfft, values, out[:rows], threads)
        out[rows:] = 0
        self._transform(scipy.fft.fft, out.T, out.T, threads, overwrite_x=True)

    def inverse_along_y(self, coefficients: Array, out: Array, threads: int = 1) -> None:
        out[...] = coefficients
        for plane in _planes(out):
            self._transform(scipy.fft.ifft, plane.T, plane.T, threads, overwrite_x=True)

    def inverse_along_x(self, coefficients: Array, out: Array, threads: int = 1) -> None:
        for source, target in zip(_planes(coefficients), _planes(out), strict=True):
            self._transform(scipy.fft.irfft, source, target, threads, n=target.shape[1])

    def cosines(
        self, values: Array, out: Array, axis: int, odd: bool, forward: bool, threads: int = 1
    ) -> None:
        source, target = (values, out) if axis == 1 else (values.T, out.T)
        kind = ("dst" if odd else "dct") if forward else ("idst" if odd else "idct")
        self._transform(getattr(scipy.fft, kind), source, target, threads)

    def _transform(
        self, function: Callable[..., Array], source: Array, target: Array, threads: int, **settings: Any
    ) -> None:
        def transform(part: slice) -> None:
            for start in range(part.start, part.stop, self.LINES):
                lines = slice(start, min(start + self.LINES, part.stop))
                target[lines] = function(source[lines], norm="forward", **settings)

        in_parts(transform, len(source), threads, multiple=self.LINES, smallest=self.LINES)


def _rows_back(coefficients: Array, out: Array, threads: int) -> None:
    """Transform rows of coefficients, which may be overwritten, to rows of a field."""
    import ducc0

    ducc0.fft.c2r(
        coefficients,
        axes=(out.ndim - 1,),
        lastsize=out.shape[-1],
        forward=False,
        out=out,
        nthreads=threads,
        allow_overwriting_input=True,
    )


def _planes(values: Array) -> Array:
    return values[None] if values.ndim == 2 else values


Engine = Ducc0Engine | PyfftwEngine | ScipyEngine

_ENGINES: dict[str, Engine] = dict(zip(ENGINES, (Ducc0Engine(), PyfftwEngine(), ScipyEngine()), strict=True))
