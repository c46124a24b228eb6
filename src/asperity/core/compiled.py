"""Decorators of the loops that numba compiles to machine code.

All of them keep the machine code for later runs if a folder is writable, release the GIL, and divide by zero
as NumPy does. A loop that allocates no array is compiled without reference counts, which take time in loops
over the rows of a plane. A line on stderr says when the first of them is compiled. If none is compiled yet,
all that are usually needed are compiled then, in parallel.
"""

import os
import sys
from functools import partial
from pathlib import Path

from tqdm import tqdm

from asperity.core.errors import shown
from asperity.core.system import COMPILING, compile_in_parallel, is_compiled

try:
    from numba import config, njit
    from numba import types as types
    from numba.core import event
    from numba.extending import intrinsic as intrinsic
except ValueError as error:  # which does not name the variable
    count = shown(os.environ.get("NUMBA_NUM_THREADS"))
    raise ImportError(f"NUMBA_NUM_THREADS = {count}: a whole number > 0 is needed") from error

NOTICE = "asperity: compiling, once after it is installed, about 20 s"

UNKEPT = "asperity: compiling, in each process if NUMBA_CACHE_DIR names no folder for the machine code"

if config.DISABLE_JIT:  # type: ignore[attr-defined]
    raise ImportError("NUMBA_DISABLE_JIT is set: asperity needs compiled loops; unset the variable")


class _Notice(event.Listener):
    """Message, printed once, that functions of asperity are compiled; the first time all are."""

    said = COMPILING in os.environ

    def on_start(self, event: event.Event) -> None:
        dispatcher = event.data["dispatcher"]
        if self.said or not dispatcher.py_func.__module__.startswith("asperity."):
            return
        self.said = True
        tqdm.write(NOTICE if IS_KEPT else UNKEPT, file=sys.stderr)
        kept = dispatcher.stats.cache_path  # empty if numba can write nowhere
        if kept and not is_compiled(Path(kept).parent):
            compile_in_parallel()

    def on_end(self, event: event.Event) -> None:
        pass


event.register("numba:compile", _Notice())

try:
    IS_KEPT = bool(njit(cache=True)(lambda: None))
except RuntimeError:  # no folder is writable: not this one, not the user's, and none is named
    IS_KEPT = False

_kept = partial(njit, cache=IS_KEPT, error_model="numpy", nogil=True)
_loop = partial(_kept, _nrt=False)

compiled = _loop()
compiled_with_arrays = _kept()

# Inlined, so that the calling loop can be vectorised.
inlined = _loop(forceinline=True)

# Fused multiply-add is allowed; infinities and NaN keep their meaning.
fused = _loop(fastmath={"contract"})
fused_inlined = _loop(fastmath={"contract"}, forceinline=True)

# Sums may be reordered for vectorisation: the order depends on the processor, not on the number of threads.
vectorised_sums = _loop(fastmath={"reassoc", "contract", "nsz"})

# Assumes that no number is NaN: some loops that sum or compare are vectorised only then.
vectorised_sums_without_nan = _loop(fastmath={"reassoc", "nnan", "nsz", "contract"})
