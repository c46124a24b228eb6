"""Checks of the arguments of `asperity.stress`: each returns the value in one form, or raises one line.

A message names the argument, its value and what is accepted.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from asperity.elasticity.layer import COMPONENTS, Layer
from asperity.errors import one_line, shown
from asperity.spectral import REAL_TYPES, Grid
from asperity.stress.pressed import ContactLike
from asperity.types import Array

MEASURES = ("von_mises", "largest_shear", "principal_1", "principal_2", "principal_3")
"""Names of the fields that need all six components of the stress."""

FIELDS = (*COMPONENTS, *MEASURES, "hydrostatic")
"""Names of the fields of the stress."""

BOUNDARIES = ("periodic", "free")
"""The cell of the contact repeats sideways, or lies alone on a half-space."""

MAX_PLANES = 10_000
"""Most planes of one stream. `depth_grid` makes about sixty; 8192 are half a spacing apart at 4096²."""

MAX_RATIOS = 1000
"""Most Poisson's ratios of one stream: steps of 0.0015 over the whole range from −1 to 0.5."""

_DIRECTIONS = '"x", "y" or an angle in degrees from x towards y'

SAME_RATIO = 1e-9
"""Poisson's ratios that differ by less are the same: room for numbers such as 0.1 + 0.2."""

MAX_THREADS = 1024
"""Most threads: more than any machine has cores, few enough to be started."""

MAX_DEPTH = 1e30
"""Largest depth over the longer edge of the cell. Modes vanish below a depth of 120; nothing overflows."""

MAX_FRICTION = 1000.0
"""Largest coefficient of friction: more than any pair of solids has, and squares of stresses stay finite."""

EDGE_RANGE = (1e-60, 1e60)
"""Edges of the cell that are accepted: squares of wavenumbers stay within double precision."""

PRESSURE_RANGE = (1e-60, 1e60)
"""Largest |pressure| that is accepted: third powers of stresses stay within double precision."""


def checked_number(name: str, value: Any, accepted: str, holds: Callable[[float], bool]) -> float:
    """The value as a float, if it is a finite number for which `holds` is true."""
    if isinstance(value, (bool, str)) or np.ndim(value) != 0:
        raise TypeError(f"{name} = {_told(value)}: {accepted} is needed")
    try:
        number = float(value)
    except (TypeError, ValueError, OverflowError) as error:
        raise TypeError(f"{name} = {_told(value)}: {accepted} is needed") from error
    if not (np.isfinite(number) and holds(number)):
        raise ValueError(f"{name} = {_told(value)}: {accepted} is needed")
    return number


def checked_tolerance(tolerance: Any) -> float:
    """The tolerance of coarse planes."""
    return checked_number("tolerance", tolerance, "a number from 0 to below 1", lambda value: 0 <= value < 1)


def checked_floor(floor: Any) -> float:
    """The magnitude below which maxima are left out."""
    return checked_number("floor", floor, "a finite number ≥ 0", lambda value: value >= 0)


def checked_threads(threads: Any) -> int:
    """The number of threads."""
    if isinstance(threads, bool) or not isinstance(threads, (int, np.integer)):
        raise TypeError(f"threads = {_told(threads)}: a whole number is needed")
    if not 1 <= threads <= MAX_THREADS:
        raise ValueError(f"threads = {threads!r}: a whole number from 1 to {MAX_THREADS} is needed")
    return int(threads)


def checked_contact(contact: ContactLike) -> tuple[Array, float]:
    """The pressure of a contact as an array of real numbers, and its largest magnitude."""
    pressure, grid, layer = (getattr(contact, name, None) for name in ("pressure", "grid", "layer"))
    if pressure is None or not isinstance(grid, Grid) or not isinstance(layer, Layer):
        raise TypeError(
            f"contact = {_told(contact)}: an object with pressure, grid and layer is needed, "
            "such as a Contact or a PressedSolid"
        )
    low, high = EDGE_RANGE
    for edge in grid.length:
        if not low <= edge <= high:
            raise ValueError(f"grid.length = {edge:g}: an edge from {low:g} to {high:g} is needed")
    field = checked_field("pressure", pressure, grid)
    highest = max(abs(float(field.max())), abs(float(field.min())))
    low, high = PRESSURE_RANGE
    if highest and not low <= highest <= high:
        raise ValueError(
            f"pressure: its largest magnitude is {highest:g}; 0 or a value from {low:g} to {high:g} is needed"
        )
    return field, highest


def checked_field(name: str, field: Any, grid: Grid) -> Array:
    """The field of a grid as an array of finite real numbers in single or double precision."""
    array = np.asarray(field)
    if array.dtype.kind not in "fiu":
        raise TypeError(f"{name} has the type {array.dtype}: real numbers are needed")
    if array.shape != grid.shape:
        raise ValueError(f"{name} has the shape {array.shape}: that of its grid, {grid.shape}, is needed")
    if array.dtype not in REAL_TYPES:
        array = array.astype(float)
    bad = int(np.count_nonzero(~np.isfinite(array)))
    if bad:
        raise ValueError(f"{name}: {bad} of {array.size} nodes are not finite numbers; all must be")
    return array


def checked_nodes(grid: Grid) -> None:
    """Raise `ValueError` if the grid is too small for a node to have neighbours on all sides."""
    if min(grid.shape) < 3:
        raise ValueError(f"grid.shape = {grid.shape}: at least three nodes on each axis are needed")


def checked_depths(depths: ArrayLike, contact: ContactLike) -> Array:
    """Rising depths within the solid as an array, a single depth as an array of one."""
    layer, edge = contact.layer, max(contact.grid.length)
    array = _real_array("depths", depths)
    if array.ndim != 1 or not array.size:
        raise ValueError(f"depths has the shape {array.shape}: one depth or a list of depths is needed")
    if array.size > MAX_PLANES:
        raise ValueError(f"depths has {array.size} values: from 1 to {MAX_PLANES} are needed")
    outside = np.flatnonzero(~((array >= 0) & (array <= MAX_DEPTH * edge)))
    if outside.size:
        raise ValueError(
            f"depths[{outside[0]}] = {array[outside[0]]:g}: a depth from 0 to {MAX_DEPTH * edge:g} is needed"
        )
    falling = np.flatnonzero(np.diff(array) <= 0)
    if falling.size:
        here = falling[0] + 1
        raise ValueError(
            f"depths[{here}] = {array[here]:g}: more than depths[{here - 1}] = {array[here - 1]:g} is needed"
        )
    if layer.height is None:
        return array
    if array[-1] > layer.height * (1 + 1e-12):
        raise ValueError(
            f"depths[{array.size - 1}] = {array[-1]:g}: at most {layer.height:g}, the height of the layer, "
            "is needed"
        )
    return np.minimum(array, layer.height)


def checked_ratios(poisson: float | Sequence[float] | None, layer: Layer) -> list[float]:
    """Poisson's ratios that the layer allows, by default its own."""
    if poisson is None:
        return [layer.poisson]
    array = _real_array("poisson", poisson)
    if array.ndim != 1 or not 1 <= array.size <= MAX_RATIOS:
        raise ValueError(
            f"poisson has the shape {array.shape}: one number or a list of 1 to {MAX_RATIOS} is needed"
        )
    ratios = [float(nu) for nu in array]
    for nu in ratios:
        if not -1 < nu <= 0.5:
            raise ValueError(f"poisson = {nu!r}: a number > -1 and ≤ 0.5 is needed")
        if ratios.count(nu) > 1:
            raise ValueError(f"poisson = {nu!r}: given {ratios.count(nu)} times, every ratio is needed once")
    if layer.height is not None and ratios != [layer.poisson]:
        other = next(nu for nu in ratios if nu != layer.poisson)
        raise ValueError(
            f"poisson = {other!r}: {layer.poisson!r}, that of the contact, is needed in a layer of finite "
            "height, because the pressure depends on it"
        )
    return ratios


def boundary_of(contact: ContactLike) -> str:
    """The boundary of a contact, "periodic" if it does not say."""
    boundary = getattr(contact, "boundary", "periodic")
    if not isinstance(boundary, str) or boundary not in BOUNDARIES:
        raise ValueError(f"contact.boundary = {_told(boundary)}: one of {', '.join(BOUNDARIES)} is needed")
    if boundary == "free" and contact.layer.height is not None:
        raise ValueError("contact.boundary = 'free': a half-space is needed, the solid is a layer")
    return str(boundary)


def checked_sliding(friction: Any, direction: Any, layer: Layer) -> tuple[float, float]:
    """Shear traction over pressure along x and y."""
    accepted = f"a number from 0 to {MAX_FRICTION:g}"
    friction = checked_number("friction", friction, accepted, lambda value: 0 <= value <= MAX_FRICTION)
    if isinstance(direction, str):
        degrees = {"x": 0.0, "y": 90.0}.get(direction)
        if degrees is None:
            raise ValueError(f"sliding_direction = {_told(direction)}: {_DIRECTIONS} is needed")
    else:
        degrees = checked_number("sliding_direction", direction, _DIRECTIONS, lambda value: True)
    if friction and layer.height is not None and layer.bottom != "bonded":
        raise ValueError(
            f"friction = {friction:g}: 0 is needed in a layer with a {layer.bottom} bottom, which bears no "
            "shear"
        )
    if degrees % 90 == 0:  # exact zeros
        cosine, sine = ((1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0))[int(degrees % 360) // 90]
    else:
        cosine, sine = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    return float(friction * cosine), float(friction * sine)


def checked_ratio(poisson: float | None, known: Sequence[float]) -> float:
    """The one of the known Poisson's ratios that is meant; it may be left out if there is only one."""
    listed = ", ".join(f"{nu:g}" for nu in known)
    if poisson is None:
        if len(known) > 1:
            raise ValueError(f"poisson: one of {listed} is needed, there are several")
        return known[0]
    accepted = f"one of {listed}"
    number = checked_number("poisson", poisson, accepted, lambda value: True)
    nearest = min(known, key=lambda nu: abs(nu - number))
    if abs(nearest - number) > SAME_RATIO:
        raise ValueError(f"poisson = {poisson!r}: {accepted} is needed")
    return nearest


def checked_name(argument: str, name: Any, known: Sequence[str]) -> str:
    """The name, if it is known."""
    if not isinstance(name, str) or name not in known:
        raise ValueError(f"{argument} = {_told(name)}: one of {', '.join(known)} is needed")
    return str(name)


def checked_names(argument: str, names: Sequence[str], known: Sequence[str]) -> tuple[str, ...]:
    """Names of which each is known and given once, at least one."""
    listed = tuple(names) if isinstance(names, Iterable) and not isinstance(names, str) else ()
    if not listed:
        raise ValueError(f"{argument} = {_told(names)}: a list of names from {', '.join(known)} is needed")
    for name in listed:
        if not isinstance(name, str) or name not in known:
            raise ValueError(f"{argument} = {_told(name)}: names from {', '.join(known)} are needed")
        if listed.count(name) > 1:
            raise ValueError(
                f"{argument} = {name!r}: given {listed.count(name)} times, every name is needed once"
            )
    return listed


def _real_array(name: str, values: Any) -> Array:
    """The values as an array of floats, a single one as an array of one."""
    try:
        array = np.atleast_1d(np.asarray(values))
    except ValueError as error:  # lists of unequal length
        raise TypeError(f"{name} = {_told(values)}: real numbers are needed") from error
    if array.size and array.dtype.kind not in "fiu":
        raise TypeError(f"{name} = {_told(values)}: real numbers are needed")
    return array.astype(float)


def _told(value: Any) -> str:
    """A value as it stands in a message of one line."""
    return one_line(shown(value))
