"""Engines, the libraries that compute Fourier transforms, and the choice between them.

An `Engine` transforms fields; everything else about transforms stands in `asperity.spectral`. There are two:
ducc0, the default, and pyFFTW. `fft_engine` chooses one for a ``with`` block, in the thread that enters it.
Outside such blocks the environment variable ``ASPERITY_FFT_ENGINE`` names the engine, and without it the
engine is `DEFAULT`.

The results of the two differ by rounding errors. The results of one have the same bits in every run and for
any number of threads; with measured plans of pyFFTW, in runs that share them (`asperity.engines.wisdom`).
"""

from asperity.engines.choice import DEFAULT as DEFAULT
from asperity.engines.choice import ENGINES as ENGINES
from asperity.engines.choice import current_engine as current_engine
from asperity.engines.choice import fft_engine as fft_engine
from asperity.engines.interface import Engine as Engine
