"""Checks of arguments, and of the numbers that a public function returns.

Each check of an argument returns it in one type, or raises a message of one line that names the argument,
shows its value and says what is accepted: TypeError if it is of the wrong kind, ValueError if out of range.
"""

from collections.abc import Callable, Iterable, Mapping, Sequence
from numbers import Real
from typing import Any

import numpy as np

from asperity.core.errors import shown
from asperity.core.types import REAL_TYPES, Array

SMALLEST, LARGEST = 1e-75, 1e75
"""Range of lengths, wavenumbers, heights and moduli: their fourth powers stay within double precision."""

own_errors = np.errstate(divide="warn", over="warn", under="ignore", invalid="warn")
"""Decorator of a public function, in which the error state of the caller's NumPy does not hold."""

QUANTITY = ("magnitude", "to_value")
"""Attributes of quantities of pint, and of astropy and unyt, whose unit NumPy would drop."""


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
    number(name, value, accepted, lambda _: int(value) == value and accepts(int(value)))
    return int(value)


def thread_count(value: Any) -> int:
    """A number of threads, at most 1024."""
    return whole_number(
        "threads", value, "a whole number from 1 to 1024", lambda threads: 1 <= threads <= 1024
    )


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


def choices(name: str, values: Any, known: Sequence[str]) -> tuple[str, ...]:
    """One or more of the known words, each once."""
    words = tuple(values) if isinstance(values, Iterable) and not isinstance(values, str) else ()
    if not words:
        raise ValueError(f"{name} = {shown(values)}: a list of names from {', '.join(known)} is needed")
    for word in words:
        if not isinstance(word, str) or word not in known:
            raise ValueError(f"{name} = {shown(word)}: names from {', '.join(known)} are needed")
        if words.count(word) > 1:
            raise ValueError(f"{name} = {word!r}: given {words.count(word)} times, every name is needed once")
    return words


def real_array(name: str, values: Any) -> Array:
    """An array of real numbers; float32 and float64 are kept, everything else becomes float64.

    A DataArray over axes that `plane_axes` recognises becomes an array [y, x], with rising positions; so
    does a DataFrame whose rows or columns are named by numbers.
    Complex numbers, truth values, text, quantities with a unit, and masked arrays with masked elements are
    refused. Elements may be infinite or NaN.
    """
    if any(hasattr(each, word) for each in (values, getattr(values, "data", None)) for word in QUANTITY):
        raise TypeError(f"{name} = {shown(values)}: real numbers without a unit are needed")
    dims: Sequence[Any] = getattr(values, "dims", ())
    if len(dims) == 2:
        if plane_axes(dims):
            values = rising(values)
        elif name == "height" and not all(str(axis).startswith("dim_") for axis in dims):
            raise ValueError(f"{name} over {dims[0]} and {dims[1]}: an array over the axes y and x is needed")
    elif hasattr(values, "columns") and hasattr(values, "sort_index"):
        import pandas as pd

        for axis, labels in enumerate((values.index, values.columns)):
            places = pd.to_numeric(pd.Series(labels), errors="coerce").to_numpy(dtype=float)
            if np.isfinite(places).all() and not np.all(np.diff(places) > 0):
                if np.unique(places).size < places.size:
                    raise ValueError(f"{name}: a position is given to several {('rows', 'columns')[axis]}")
                values = values.take(np.argsort(places), axis=axis)
    if np.ma.is_masked(values):
        raise ValueError(f"{name}: an array without masked elements is needed")
    try:
        array = np.asarray(values)
    except (TypeError, ValueError):  # rows of unequal length
        array = np.empty(0, object)
    if array.dtype.kind not in "iuf":
        raise TypeError(f"{name} = {shown(values)}: real numbers are needed")
    return array if array.dtype in REAL_TYPES else array.astype(np.float64)


ROW_AXES = frozenset(("y", "row", "rows", "line", "lines", "lat", "latitude", "northing"))
COLUMN_AXES = frozenset(("x", "col", "cols", "column", "columns", "lon", "longitude", "easting"))
"""Names of axes along y and x, in small letters."""


def plane_axes(dims: Sequence[Any]) -> tuple[Any, Any] | None:
    """The axes along y and x of two named axes; None if their names are not known."""
    kinds = [(str(axis).lower() in ROW_AXES) - (str(axis).lower() in COLUMN_AXES) for axis in dims]
    if kinds not in ([1, -1], [-1, 1]):
        return None
    return (dims[0], dims[1]) if kinds == [1, -1] else (dims[1], dims[0])


def rising(values: Any) -> Any:
    """A DataArray over axes that `plane_axes` recognises as [y, x], sorted by its positions."""
    values = values.transpose(*(plane_axes(values.dims) or ()))
    for axis in values.dims:
        place = values.coords[axis].values if axis in values.coords else np.arange(2)
        if place.dtype.kind in "iuf" and not np.all(np.diff(place) > 0):
            values = values.sortby(axis)
    return values


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


def require_positive(**values: float) -> None:
    """Raise `ValueError` naming the first argument that is not positive and finite."""
    for name, value in values.items():
        if not (np.isfinite(value) and value > 0):
            raise ValueError(f"{name} = {value!r}: a positive finite number is needed")


def require_finite(function: str, results: Mapping[Any, Any], *, undefined: bool = False) -> None:
    """Raise `ValueError` unless all results of a function are finite.

    Parameters
    ----------
    function : str
        Its name, for the message.
    results : mapping
        Name → number or array; integers, truth values and text are always finite.
    undefined : bool, optional
        NaN is accepted, for functions that document its meaning.
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
    """True if all elements of an array are finite; NaN is accepted if `undefined`."""
    # A finite sum is proof and takes a fraction of the second test's time, but finite numbers may overflow.
    with np.errstate(over="ignore", invalid="ignore"):
        if np.isfinite(array.sum()):
            return True
    return not np.any(np.isinf(array)) if undefined else bool(np.all(np.isfinite(array)))
