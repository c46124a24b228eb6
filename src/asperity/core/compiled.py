"""Decorators of the loops that numba compiles to machine code.

All of them keep the machine code for later runs, release the interpreter's lock, and divide by zero as NumPy
does. A loop that makes no array is compiled without counting references to arrays, which takes time in loops
over the rows of a plane.
"""

from __future__ import annotations

from functools import partial

from numba import config, njit

if config.DISABLE_JIT:  # type: ignore[attr-defined]
    raise ImportError("NUMBA_DISABLE_JIT is set: asperity needs compiled loops; unset the variable")

_kept = partial(njit, cache=True, error_model="numpy", nogil=True)
_loop = partial(_kept, _nrt=False)

compiled = _loop()
makes_arrays = _kept()

# Inlined into the calling loop, which can then be turned into operations on vectors.
inlined = _loop(forceinline=True)

# A product and a sum may be rounded once instead of twice; infinities and NaN keep their meaning.
fused = _loop(fastmath={"contract"})
fused_inlined = _loop(fastmath={"contract"}, forceinline=True)

# Numbers may be added in any order, as operations on vectors need: it depends on the processor, but not on
# the number of threads.
sums = _loop(fastmath={"reassoc", "contract", "nsz"})

# None of the numbers is NaN: only then some loops that sum or compare are turned into operations on vectors.
sums_without_nan = _loop(fastmath={"reassoc", "nnan", "nsz", "contract"})
