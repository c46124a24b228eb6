"""Decorators of the loops that numba compiles to machine code.

All of them keep the machine code for later runs, release the interpreter's lock, and divide by zero as NumPy
does. A loop that makes no array is compiled without counting references to arrays, which takes time in loops
over the rows of a plane. A line on stderr says when the first of them is compiled.
"""

from __future__ import annotations

import sys
from functools import partial

from numba import config, njit
from numba.core import event
from tqdm import tqdm

NOTICE = "asperity: compiling, once after it is installed, about 20 s"

if config.DISABLE_JIT:  # type: ignore[attr-defined]
    raise ImportError("NUMBA_DISABLE_JIT is set: asperity needs compiled loops; unset the variable")


class _Notice(event.Listener):
    """Says once that functions of asperity are compiled."""

    said = False

    def on_start(self, event: event.Event) -> None:
        if not self.said and event.data["dispatcher"].py_func.__module__.startswith("asperity."):
            self.said = True
            tqdm.write(NOTICE, file=sys.stderr)

    def on_end(self, event: event.Event) -> None:
        pass


event.register("numba:compile", _Notice())

_kept = partial(njit, cache=True, error_model="numpy", nogil=True)
_loop = partial(_kept, _nrt=False)

compiled = _loop()
compiled_with_arrays = _kept()

# Inlined into the calling loop, which can then be turned into operations on vectors.
inlined = _loop(forceinline=True)

# A product and a sum may be rounded once instead of twice; infinities and NaN keep their meaning.
fused = _loop(fastmath={"contract"})
fused_inlined = _loop(fastmath={"contract"}, forceinline=True)

# Numbers may be added in any order, as operations on vectors need: it depends on the processor, but not on
# the number of threads.
vectorised_sums = _loop(fastmath={"reassoc", "contract", "nsz"})

# None of the numbers is NaN: only then some loops that sum or compare are turned into operations on vectors.
vectorised_sums_without_nan = _loop(fastmath={"reassoc", "nnan", "nsz", "contract"})
