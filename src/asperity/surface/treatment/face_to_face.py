"""Two measured maps pressed face to face, combined into the single rough face that the contact needs.

Both maps were measured with their peaks upward. The lower one lies as it was measured. The upper one is
turned over about an axis through the middle of its map, so that its peaks point down, and is laid on the
lower one, middle on middle, moved by a shift. The gap before the first touch is the height of the upper face
over the lower one: as the slopes are small, it depends on the sum of both reliefs alone,

    h(y, x) = −z_lower(y, x) − z_upper(y', x'),

the lower face of an indenter as `asperity.solve_contact` takes it. Turned about the axis y, y' runs along y
and x' against x. A map that holds a lower face already faces down and is not turned.
"""

from dataclasses import replace
from typing import NamedTuple

import numpy as np

from asperity.core.arguments import choice, number, pair, require_finite
from asperity.core.types import Array
from asperity.surface.form import AXES
from asperity.surface.reading.height_map import LOWER_FACE, PEAKS_UP, HeightMap, MapError

ON_A_NODE = 1e-6
"""A position nearer to a node than this fraction of a pixel is on it."""

FEWEST_NODES = 4
"""Fewest nodes on an edge of the common area."""


class FacedMaps(NamedTuple):
    """Two maps face to face.

    Parameters
    ----------
    map : HeightMap
        The combined lower face, on the pixels of the lower map that both maps cover. It is periodic if both
        maps are; these then need the same edges.
    origin : (y, x)
        Corner of the common area on the lower map.
    whole : bool
        True if the common area is all of the lower map.
    done : tuple of str
        The steps, a sentence for each.
    upper : HeightMap
        The part of the map that is the upper body's lower face.
    """

    map: HeightMap
    origin: tuple[float, float]
    whole: bool
    done: tuple[str, ...]
    upper: HeightMap


def face_to_face(
    lower: HeightMap,
    upper: HeightMap,
    turned_about: str = "y",
    shift: tuple[float, float] = (0.0, 0.0),
) -> FacedMaps:
    """The rough face that is equivalent to two measured maps pressed against each other.

    Parameters
    ----------
    lower, upper : HeightMap
        Levelled and without missing points; see `asperity.prepare_map`.
    turned_about : "y" | "x"
        Axis about which the upper map is turned over.
    shift : (y, x)
        Position of the middle of the upper map, from the middle of the lower one, in the unit of the maps.

    Returns
    -------
    FacedMaps
        With the composite `map`, (ny, nx), and what was cut off.

    Raises
    ------
    MapError, TypeError, ValueError
        If an argument is out of range, a map has non-measured points or no orientation, the unit of one map
        alone is known, two periodic maps have different edges, or the maps have fewer than `FEWEST_NODES`
        nodes on an edge in common.

    Examples
    --------
    Two ground faces whose lays cross; the solver takes the sum as one indenter:

    >>> length = (1e-4, 1e-4)
    >>> waves = 1e-7 * np.cos(2 * np.pi * np.arange(64) / 16) * np.ones((64, 1))
    >>> lower = asp.HeightMap(waves, length, periodic=True, unit="m", orientation="peaks up")
    >>> upper = asp.HeightMap(waves.T, length, periodic=True, unit="m", orientation="peaks up")
    >>> faced = asp.surface.face_to_face(lower, upper)
    >>> float(round(np.ptp(faced.map.height) / np.ptp(waves), 6))
    2.0

    Turned over about y, a peak at the left of the upper map touches the right of the lower one:

    >>> peak = np.zeros((64, 64))
    >>> peak[20, 3] = 1e-7
    >>> faced = asp.surface.face_to_face(asp.HeightMap(0 * peak, length), asp.HeightMap(peak, length))
    >>> np.argwhere(faced.map.height == faced.map.height.min()).tolist()
    [[20, 60]]
    """
    choice("turned_about", turned_about, AXES)
    accepted = "a pair (y, x) of finite numbers"
    shift_y, shift_x = (
        number("shift", value, accepted, np.isfinite) for value in pair("shift", shift, accepted)
    )
    for name, surface in (("lower", lower), ("upper", upper)):
        if surface.missing:
            raise MapError(surface.name, [f"{name}: {surface.missing} points have no data; fill them first"])
    if (lower.unit is None) != (upper.unit is None):
        raise MapError(upper.name, ["the unit of one map is known and of the other is not; give it"])
    equal = np.allclose(lower.length, upper.length, rtol=ON_A_NODE, atol=0)
    if lower.periodic and upper.periodic and not equal:
        mine, its = (" x ".join(f"{edge:.6g}" for edge in surface.length) for surface in (lower, upper))
        raise MapError(upper.name, [f"periodic maps of equal edges are needed, not {mine} and {its}"])
    turned = upper.orientation == PEAKS_UP
    face = upper.as_indenter()
    if turned:
        face = face[:, ::-1] if turned_about == "y" else face[::-1]
    parts, indices, on_nodes = zip(
        *(_common_nodes(lower, upper, axis, (shift_y, shift_x)[axis]) for axis in (0, 1)), strict=True
    )
    if all(on_nodes):
        rows, columns = (np.rint(index).astype(int) % n for index, n in zip(indices, face.shape, strict=True))
        found = face[np.ix_(rows, columns)]
    else:
        along_y, along_x = (_interpolation(lower, upper, axis, indices[axis]) for axis in (0, 1))
        found = along_y @ face @ along_x.T
    height = lower.as_indenter()[parts] + found
    require_finite("face_to_face", {"height": height})
    pixel = lower.spacing
    combined = replace(
        lower,
        height=height - height.mean(),
        length=(height.shape[0] * pixel[0], height.shape[1] * pixel[1]),
        periodic=lower.periodic and upper.periodic,
        orientation=LOWER_FACE,
        channel="",
    )
    origin = parts[0].start * pixel[0], parts[1].start * pixel[1]
    whole = height.shape == lower.height.shape

    how = f"turned over about the axis {turned_about}"
    how = how if turned else "not turned: it holds a lower face"
    moved = f" with a shift of {lower.shown_length(shift_y, shift_x, digits=4)}"
    done = [f"counter map {how}, and laid on the map{moved if shift_y or shift_x else ''}"]
    if not whole:
        size = lower.shown_length(*combined.length, digits=4)
        y, x = (lower.shown_length(corner, digits=4) for corner in origin)
        done.append(
            f"the maps have {size} in common; positions are measured from the corner of this area, "
            f"y = {y} and x = {x} of the map"
        )
    if not all(on_nodes):
        done.append("counter map interpolated to the pixels of the map")
    return FacedMaps(combined, origin, whole, tuple(done), replace(combined, height=found - found.mean()))


def _common_nodes(lower: HeightMap, upper: HeightMap, axis: int, shift: float) -> tuple[slice, Array, bool]:
    """Nodes of the lower map that the upper one covers, their indices in it, and if these are its nodes.

    Nodes are the middles of pixels, and an index is in pixels of the upper map from its first node.
    """
    nodes, step = lower.height.shape[axis], lower.spacing[axis]
    count, pixel = upper.height.shape[axis], upper.spacing[axis]
    position = (np.arange(nodes) + 0.5) * step - lower.length[axis] / 2 - shift
    index = (position + upper.length[axis] / 2) / pixel - 0.5
    inside = np.arange(nodes)
    if not (lower.periodic and upper.periodic):
        inside = np.flatnonzero((index > -0.5 - ON_A_NODE) & (index < count - 0.5 + ON_A_NODE))
    if inside.size < FEWEST_NODES:
        common = f"the maps have {inside.size} nodes in common, at least {FEWEST_NODES} are needed"
        raise MapError(upper.name, [f"shift along {AXES[axis]} = {shift:.6g}: {common}"])
    index = index[inside]
    equal_pixels = abs(step / pixel - 1) * nodes < ON_A_NODE
    on_nodes = equal_pixels and bool(np.abs(index - np.rint(index)).max() < ON_A_NODE)
    return slice(int(inside[0]), int(inside[-1]) + 1), index, on_nodes


def _interpolation(lower: HeightMap, upper: HeightMap, axis: int, index: Array) -> Array:
    """Matrix from values at the nodes of the upper map, along an axis, to values at fractional indices.

    It sums the Fourier series of a period, or of a map continued by its mirror images, without waves that
    the lower map cannot hold.
    """
    from scipy.special import diric

    nodes = upper.height.shape[axis]
    if lower.periodic and upper.periodic:
        waves = 2 * ((min(nodes, lower.height.shape[axis]) - 1) // 2) + 1
        return waves / nodes * diric(2 * np.pi / nodes * (index[:, None] - np.arange(nodes)), waves)
    order = np.arange(nodes)
    weight = np.where(order == 0, 1 / nodes, 2 / nodes)
    # A mode of order k has a wavelength of 2 · length / k.
    weight[order * lower.spacing[axis] > upper.length[axis]] = 0.0
    there, here = (np.cos(np.pi / nodes * np.outer(each + 0.5, order)) for each in (index, np.arange(nodes)))
    return (weight * there) @ here.T
