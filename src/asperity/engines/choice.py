"""The choice of an engine, for a block of a program or for a whole process."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from functools import cache

from asperity.engines.interface import Engine
from asperity.errors import shown
from asperity.packages import require

ENGINES = ("ducc0", "pyfftw")
"""Names of the engines."""

DEFAULT = "ducc0"
"""Engine where none is chosen; docs/tradeoff.md has the measurement behind it."""

VARIABLE = "ASPERITY_FFT_ENGINE"
"""Environment variable with the engine of a process in which none is chosen."""

_chosen: ContextVar[Engine | None] = ContextVar("asperity_fft_engine", default=None)


@contextmanager
def fft_engine(name: str, wisdom: str | os.PathLike[str] | None = None) -> Iterator[Engine]:
    """Compute all Fourier transforms within a ``with`` block by one engine.

    The choice holds in the thread that enters the block; a thread that is started inside makes its own.
    Results carry the engine in their attribute ``fft_engine``.

    Parameters
    ----------
    name : "ducc0" or "pyfftw"
        pyFFTW is installed by ``pip install "asperity[fftw]"``.
    wisdom : path, optional
        File with measured plans of pyFFTW, as written by `measure_wisdom`. Grids that it lacks, or all
        without it, are transformed by plans that FFTW estimates. Both repeat their bits from run to run;
        measured plans are faster.

    Yields
    ------
    Engine

    Raises
    ------
    ValueError
        If there is no engine of this name, ducc0 is given a wisdom, or the file is no wisdom for the FFTW
        and the processor in use.
    MissingPackageError
        If the engine is not installed.

    Examples
    --------
    >>> height = asp.self_affine((64, 64), 0.8, 0.5, 0.125, rms_height=1e-3, seed=1)
    >>> with asp.fft_engine("ducc0"):
    ...     contact = asp.solve(height, asp.Layer(young=1.0, poisson=0.3), area_fraction=0.1)
    >>> contact.fft_engine
    'ducc0 ...'
    """
    with use(engine_of(name, wisdom)) as engine:
        yield engine


@contextmanager
def use(engine: Engine) -> Iterator[Engine]:
    """Compute all Fourier transforms within a ``with`` block by this engine."""
    token = _chosen.set(engine)
    try:
        yield engine
    finally:
        _chosen.reset(token)


def current_engine() -> Engine:
    """The engine in use: that of the block, else that of the environment variable, else the default."""
    if (chosen := _chosen.get()) is not None:
        return chosen
    name = default_engine()
    if name != DEFAULT:
        require((name,))
    return _engine(name)


def default_engine() -> str:
    """Name of the engine outside all blocks: that in the environment variable, else the default."""
    return _known(VARIABLE, os.environ.get(VARIABLE) or DEFAULT)


def engine_of(name: str, wisdom: str | os.PathLike[str] | None = None, option: str = "wisdom") -> Engine:
    """The engine of this name, with the plans of a file.

    Parameters and errors are those of `fft_engine`; `option` is the name of the file in messages.
    """
    known = _known("fft_engine", name)
    require((known,))
    if wisdom is None:
        return _engine(known)
    if known != "pyfftw":
        raise ValueError(
            f"{option} = {shown(os.fspath(wisdom))}: accepted with the engine pyfftw only, not with {known}"
        )
    from asperity.engines.pyfftw_engine import PyfftwEngine
    from asperity.engines.wisdom import read_wisdom

    return PyfftwEngine(read_wisdom(wisdom, option))


def _known(argument: str, name: object) -> str:
    if name not in ENGINES:
        raise ValueError(f"{argument} = {shown(name)}: {' or '.join(ENGINES)} is needed")
    return str(name)


@cache
def _engine(name: str) -> Engine:
    """The engine of a known name; imported when first used."""
    if name == "pyfftw":
        from asperity.engines.pyfftw_engine import PyfftwEngine

        return PyfftwEngine()
    from asperity.engines.ducc0_engine import Ducc0Engine

    return Ducc0Engine()
