"""Checks of arguments.

Each function returns the argument in one type, or raises a message of one line that names the argument, shows
its value and says what is accepted: TypeError if it is of the wrong kind, ValueError if it is out of range.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from numbers import Real
from typing import Any, cast

import numpy as np

from asperity.errors import shown
from asperity.types import REAL_TYPES, Array

SMALLEST, LARGEST = 1e-75, 1e75
"""Range of lengths, wavenumbers, heights and moduli: their fourth powers stay within double precision."""


def number(name: str, value: Any, accepted: str, accepts: Callable[[float], bool]) -> float:
    """A real number.

    Parameters
    ----------
    name : str
        Name of the argument.
    value : any
    accepted : str
        Description of the accepted numbers for the message.
    accepts : callable
        True for accepted numbers; never called with infinities or NaN.
    """
    if not isinstance(value, Real) or isinstance(value, bool):
        raise TypeError(f"{name} = {shown(value)}: {accepted} is needed")
    try:
        converted = float(value)
    except OverflowError:
        converted = np.inf
    if not (np.isfinite(converted) and accepts(converted)):
        raise ValueError(f"{name} = {shown(value)}: {accepted} is needed")
    return converted


def magnitude(name: str, value: Any, alternative: str = "") -> float:
    """A number from `SMALLEST` to `LARGEST`; the message may name an `alternative`."""
    accepted = f"a number > 0, from {SMALLEST:g} to {LARGEST:g}{alternative},"
    return number(name, value, accepted, lambda size: SMALLEST <= size <= LARGEST)


def whole_number(name: str, value: Any, accepted: str, accepts: Callable[[int], bool]) -> int:
    """A whole number, given as an integer or as a float without a fraction; arguments as for `number`."""
    if not isinstance(value, Real) or isinstance(value, bool):
        raise TypeError(f"{name} = {shown(value)}: {accepted} is needed")
    try:
        converted = int(cast(Any, value))
    except (OverflowError, ValueError) as error:  # infinity, NaN
        raise ValueError(f"{name} = {shown(value)}: {accepted} is needed") from error
    if converted != value or not accepts(converted):
        raise ValueError(f"{name} = {shown(value)}: {accepted} is needed")
    return converted


def pair(name: str, value: Any, accepted: str) -> tuple[Any, Any]:
    """The two elements of a tuple, list or array of one dimension."""
    is_sequence = isinstance(value, (tuple, list)) or (isinstance(value, np.ndarray) and value.ndim == 1)
    if not is_sequence or len(value) != 2:
        raise ValueError(f"{name} = {shown(value)}: {accepted} is needed")
    first, second = value
    return first, second


def choice(name: str, value: Any, known: Sequence[str]) -> str:
    """One of the known words."""
    if not isinstance(value, str) or value not in known:
        raise ValueError(f"{name} = {shown(value)}: one of {', '.join(known)} is needed")
    return value


def real_array(name: str, values: Any) -> Array:
    """An array of real numbers; float32 and float64 are kept, everything else becomes float64.

    Complex numbers, truth values, text, and masked arrays with masked elements are refused. Elements may be
    infinite or NaN.
    """
    if np.ma.is_masked(values):
        raise ValueError(f"{name}: an array without masked elements is needed")
    try:
        array = np.asarray(values)
    except (TypeError, ValueError):  # rows of unequal length
        array = np.empty(0, object)
    if array.dtype.kind not in "iuf":
        raise TypeError(f"{name} = {shown(values)}: real numbers are needed")
    return array if array.dtype in REAL_TYPES else array.astype(np.float64)


def finite_array(name: str, values: Any) -> Array:
    """An array as `real_array` returns it, of numbers whose magnitude is at most `LARGEST`."""
    array = real_array(name, values)
    # The extremes of an array with NaN are NaN.
    if array.size and not -LARGEST <= float(array.min()) <= float(array.max()) <= LARGEST:
        bad = int(np.count_nonzero(~np.isfinite(array)))
        if bad:
            raise ValueError(f"{name}: {bad} of {array.size} nodes are not finite; all must be")
        raise ValueError(f"{name}: numbers from {-LARGEST:g} to {LARGEST:g} are needed")
    return array
