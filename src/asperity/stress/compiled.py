"""Decorators of the compiled loops of the stress.

None of the loops makes an array. They are therefore compiled without counting the references to arrays, which
took a tenth of the time of an analysis.
"""

from __future__ import annotations

from functools import partial

from numba import njit

_loop = partial(njit, cache=True, error_model="numpy", nogil=True, _nrt=False)

compiled = _loop()
contracted = _loop(fastmath={"contract"})
inlined = _loop(forceinline=True)
contracted_inlined = _loop(fastmath={"contract"}, forceinline=True)

# Numbers may be added in any order, and none is NaN: only then loops that sum or compare are vectorised.
reduction = _loop(fastmath={"reassoc", "nnan", "nsz", "contract"})
