"""The check with which every public function that computes numbers ends: they are finite."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from asperity.types import Array


def require_finite(function: str, results: Mapping[Any, Any], *, undefined: bool = False) -> None:
    """Raise `ValueError` unless all results of a function are finite.

    Parameters
    ----------
    function : str
        Its name, for the message.
    results : mapping
        Name → number or array; integers, truth values and text are always finite.
    undefined : bool, optional
        NaN is accepted, where the function says what it stands for.
    """
    for name, values in results.items():
        array = np.asarray(values)
        if array.dtype.kind in "fc" and not is_finite(array, undefined):
            bad = np.count_nonzero(~np.isfinite(array))
            raise ValueError(
                f"{function}: {bad} of {array.size} values of {name} are not finite, because an argument is "
                "too large or too small; arguments nearer to one, in other units, are needed"
            )


def is_finite(array: Array, undefined: bool = False) -> bool:
    """True if all elements of an array are finite; NaN counts as finite if it is `undefined`."""
    # The sum of finite numbers is finite unless it overflows, and takes a fraction of the time of the
    # second test.
    with np.errstate(over="ignore", invalid="ignore"):
        if np.isfinite(array.sum()):
            return True
    return not np.any(np.isinf(array)) if undefined else bool(np.all(np.isfinite(array)))
