"""Fourier transforms: `grid` states the convention of the package, `engine` chooses the library."""

from asperity.fourier.engine import DEFAULT as DEFAULT
from asperity.fourier.engine import ENGINES as ENGINES
from asperity.fourier.engine import Engine as Engine
from asperity.fourier.engine import current_engine as current_engine
from asperity.fourier.engine import fft_engine as fft_engine
