"""Compilation at the first use of the library, with a line and a bar, before a command computes."""

from __future__ import annotations

import sys
import threading
from typing import Any

import numpy as np
from numba.core.registry import CPUDispatcher

from asperity.contact import kernels as contact_kernels
from asperity.engineering import Body, run
from asperity.runtime.progress import ProgressBar
from asperity.stress import kernels as stress_kernels
from asperity.surface.height_map import HeightMap

POLL_SECONDS = 0.2
"""Time between two looks at how many functions are compiled."""

USED_SHARE = 0.95
"""Share of the compiled functions of the imported modules that one run uses."""

_MARKS = (contact_kernels.residual, stress_kernels.von_mises)
"""Functions of the two parts that every run calls."""


def compile_visibly(body: Body) -> None:
    """Compile what a run needs, unless an earlier one has; says so on stderr.

    Parameters
    ----------
    body : Body
        The half-space or layer of the run.
    """
    if all(_is_stored(function) for function in _MARKS):
        return
    if not sys.stderr.isatty():
        print("asperity: compiling, at the first use only, about 30 s", file=sys.stderr, flush=True)
    with ProgressBar("compiling, at the first use only") as progress:
        ended = threading.Event()
        watch = threading.Thread(target=_report, args=(progress, ended), daemon=True)
        watch.start()
        try:
            _run_small(body)
        finally:
            ended.set()
            watch.join()


def _is_stored(function: Any) -> bool:
    """True if the machine code of a function is stored by an earlier process."""
    try:
        return bool(function._cache._cache_file._load_index())
    except AttributeError:  # another version of numba: nothing is said about compiling
        return True


def _report(progress: ProgressBar, ended: threading.Event) -> None:
    """Report the share of compiled functions until the end."""
    functions = _functions()
    while not ended.wait(POLL_SECONDS):
        compiled = sum(bool(function.signatures) for function in functions)
        progress(min(compiled / (USED_SHARE * len(functions)), 0.99), 1.0)


def _functions() -> list[Any]:
    """Compiled functions of the physics."""
    parts = ("asperity.contact", "asperity.elasticity", "asperity.stress")
    modules = [module for name, module in list(sys.modules.items()) if name.startswith(parts)]
    found = {
        id(value): value
        for module in modules
        for value in list(vars(module).values())
        if isinstance(value, CPUDispatcher)
    }
    return list(found.values())


def _run_small(body: Body) -> None:
    """A run on a small surface, with the types of a large one."""
    edge = body.height or 1e-3
    height = np.random.default_rng(1).normal(size=(16, 16)) * 1e-3 * edge
    limited = Body(body.young, body.poisson, 1e-3 * body.young, body.height, body.bottom)
    run(HeightMap(height, (edge, edge)), limited, area_fraction=0.2)
