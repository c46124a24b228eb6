"""Removal of machine code that numba kept of functions whose source has changed since."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

from numba.core.registry import CPUDispatcher


def discard_outdated(module: str) -> None:
    """Discard kept machine code older than the functions of other modules that it calls.

    Numba compares the machine code of a function with the file of its own module only, although functions of
    other modules that it calls are compiled into it. To be called at the end of every module whose compiled
    functions call those of another one.

    Parameters
    ----------
    module : str
        Name of a module that is being imported.
    """
    for function in _compiled_functions(module):
        others = {
            source for called in _called_by(function) if (source := _source(called)) != _source(function)
        }
        if not others:
            continue
        newest = max(path.stat().st_mtime_ns for path in others)
        kept = Path(function.stats.cache_path)
        for index in kept.glob(f"{module.rpartition('.')[2]}.{function.__name__}-*.nbi"):
            try:
                if index.stat().st_mtime_ns < newest:
                    index.unlink()
            except FileNotFoundError:  # another process has discarded it
                continue


def calls_other_modules(module: str) -> bool:
    """True if a compiled function of an imported module calls one of another module."""
    return any(
        _source(called) != _source(function)
        for function in _compiled_functions(module)
        for called in _called_by(function)
    )


def _compiled_functions(module: str) -> list[Any]:
    functions = list(vars(sys.modules[module]).values())
    return [one for one in functions if isinstance(one, CPUDispatcher) and one.__module__ == module]


def _called_by(function: Any, found: frozenset[Any] = frozenset()) -> frozenset[Any]:
    """Compiled functions that one calls, and those that these call."""
    for name in function.py_func.__code__.co_names:
        called = function.py_func.__globals__.get(name)
        if isinstance(called, CPUDispatcher) and called not in found:
            found = _called_by(called, found | {called})
    return found


def _source(function: Any) -> Path:
    return Path(function.py_func.__code__.co_filename)
