"""Fourier transforms: `grid` states the convention of the package, `engine` chooses the library."""

from asperity.fourier.engine import DEFAULT, ENGINES, Engine, current_engine, fft_engine

__all__ = ["DEFAULT", "ENGINES", "Engine", "current_engine", "fft_engine"]
