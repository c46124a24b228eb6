"""Extreme values of fields of the stress, between nodes and planes, with the whole stress tensor there.

While planes pass, the extreme value of each field at the nodes is found, and nodes under other contacts whose
von Mises stress is nearly as high: between nodes it may be higher there. Around each of these nodes the six
components are then interpolated, by splines in the plane and by a polynomial through five planes along the
depth, and the extreme value of the field of the interpolated tensor is sought. Every field is compared at the
points of all of them. Inequalities between fields at one point therefore hold for their extreme values, too:
the von Mises stress is from √3 to 2 times the maximum shear stress (Tresca).

Where the pressure reaches a hardness, extreme values are those at the nodes: interpolation overshoots
plateaus.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import NamedTuple

import numpy as np

from asperity.core.types import Array
from asperity.elasticity.loaded_solid import LoadedSolid
from asperity.elasticity.solid import COMPONENTS, Solid
from asperity.fourier.grid import BOUNDARIES, Grid
from asperity.stress.planes.fields import lagrange_weights
from asperity.stress.planes.stream import LinearPlane, PlaneStream

DIRECTION = {"von_mises": 1, "maximum_shear": 1, "principal_1": 1, "principal_3": -1, "hydrostatic": -1}
"""Field → 1 if its largest value is sought, −1 if its smallest is; of others the largest magnitude."""

OF_MATERIALS = ("von_mises", "principal_1")
"""Fields whose extreme values count in each material of a layered body."""

BOUNDS = {"maximum_shear": (3**-0.5, 0.0), "principal_1": (2 / 3, 1.0), "principal_3": (2 / 3, -1.0)}
"""Field → factors of the von Mises and the hydrostatic stress in an upper bound of it, or of its negative.

Principal stresses are computed only where the bound exceeds the extreme value so far: `run` takes a quarter
of the time at 512²."""

BOUND_ERROR = 1e-5
"""Uncertainty of these bounds by rounding in single precision, relative to the highest of a plane."""

RIVAL, MOST_RIVALS = 0.9, 4
"""Least von Mises stress at further nodes, over the highest, and most of these nodes."""

MOST_HIGH = 20_000
"""Most such nodes of a plane; if there are more, as in full contact, the highest alone is kept."""

PATCH = 8
"""Nodes on each side of a node through which splines pass: the edge of the patch changes them by 1e-4."""

OFFSETS = np.linspace(-1, 1, 9)
"""Places along each axis where the field is compared, over the reach, which starts at the neighbours."""

ZOOMS = 4
"""Times that the reach falls to a quarter, around the extreme value: the last places are 1/256 apart."""


class Extreme(NamedTuple):
    """Extreme value of a field of the stress, its place on the map, and the stress tensor there.

    On a mirrored map under friction `on_image` is True where the place lies on a mirror image that slides in
    another direction than the map.
    """

    value: float
    depth: float
    y: float
    x: float
    stress: tuple[float, ...] = (np.nan,) * 6
    on_image: bool = False


class Interface(NamedTuple):
    """Stress on an interface between two materials.

    `along` is σ_xx of the largest magnitude above and below it. `shear`, √(σ_xz² + σ_yz²), and `tension`,
    σ_zz, are the largest values at the nodes; tension is below 0 if the interface is nowhere in tension.
    """

    along: list[float]
    shear: Extreme
    tension: Extreme

    @classmethod
    def of(cls, plane: LinearPlane, poisson: float) -> Interface:
        """The interface from the plane on its upper face; its places lie in the cell of the plane."""
        xz, yz, zz = (plane.field(name, poisson) for name in ("xz", "yz", "zz"))
        found = []
        for values in (np.hypot(xz, yz), zz):
            node = divmod(int(values.argmax()), plane.grid.shape[1])
            place = np.add(plane.first_node, np.multiply(node, plane.grid.spacing)).tolist()
            found.append(Extreme(float(values.max()), plane.depth, *place))
        return cls([], *found)

    def on_map(self, grid: Grid) -> Interface:
        """The interface with its places on the map, whose grid may be mirrored."""
        places = ([*map(float, grid.on_map(each.y, each.x))] for each in self[1:])
        shear, tension = (each._replace(y=y, x=x) for each, (y, x) in zip(self[1:], places, strict=True))
        return Interface(self.along, shear, tension)


class _AtNode(NamedTuple):
    """Extreme value at a node: the number of its plane, and the place y, x of the node in the cell."""

    size: float
    plane: int
    spacing: tuple[float, float]
    place: tuple[float, float]


class Extremes:
    """Extreme values of fields from a stream of planes, of each material of a coated body apart.

    Parameters
    ----------
    layer : Solid
    fields : names
        Fields besides those of `DIRECTION`.

    Attributes
    ----------
    interfaces : list of Interface
    """

    def __init__(self, layer: Solid, fields: Sequence[str] = ()) -> None:
        self._layer, self._fields = layer, list(dict.fromkeys((*DIRECTION, *fields)))
        self._depths: list[float] = []
        self._parts: list[dict[str, _AtNode]] = []
        self._starts: list[int] = []
        self._rivals: list[list[_AtNode]] = []
        self.interfaces: list[Interface] = []

    def add(self, plane: LinearPlane) -> None:
        """Add the next plane."""
        poisson = self._layer.poisson
        if not self._depths or plane.depth == np.nextafter(self._depths[-1], np.inf):
            self._parts.append({})
            self._rivals.append([])
            self._starts.append(len(self._depths))
        part = self._parts[-1]
        self._depths.append(plane.depth)
        if plane.depth in self._layer.interfaces:
            self.interfaces.append(Interface.of(plane, poisson))
        if self.interfaces and plane.depth <= np.nextafter(self.interfaces[-1].shear.depth, np.inf):
            xx = plane.field("xx", poisson)
            self.interfaces[-1].along.append(float(xx.flat[np.abs(xx).argmax()]))
        von_mises, hydrostatic = (plane.field(name, poisson) for name in ("von_mises", "hydrostatic"))
        self._rivals[-1] = self._with_rivals(self._rivals[-1], plane, von_mises)
        highest, ends = von_mises.max(), {1.0: hydrostatic.max(), -1.0: hydrostatic.min(), 0.0: 0.0}
        for name in self._fields:
            least = part[name].size if name in part else -np.inf
            if name in BOUNDS:  # only at nodes where the bound exceeds the extreme value so far
                of_von_mises, of_hydrostatic = BOUNDS[name]
                most = of_von_mises * highest + of_hydrostatic * ends[of_hydrostatic]
                if most < least - BOUND_ERROR * abs(most):
                    continue
                bound = (of_von_mises * von_mises + of_hydrostatic * hydrostatic).ravel()
                if name not in part:
                    known = plane.field_at(name, poisson, np.array([bound.argmax()]))
                    least = DIRECTION[name] * float(known[0])
                nodes = np.flatnonzero(bound >= least - BOUND_ERROR * abs(most))
                values = plane.field_at(name, poisson, nodes)
            else:
                field = plane.field(name, poisson)
                nodes = np.array([field.argmax(), field.argmin()])
                values = field.flat[nodes]
            sizes = _size(name, values)
            if not sizes.size or not sizes.max() > (part[name].size if name in part else -np.inf):
                continue
            best = int(sizes.argmax())
            row, column = divmod(int(nodes[best]), plane.grid.shape[1])
            y, x = np.add(plane.first_node, np.multiply((row, column), plane.grid.spacing)).tolist()
            part[name] = _AtNode(float(sizes[best]), len(self._depths) - 1, plane.grid.spacing, (y, x))

    def _with_rivals(self, before: list[_AtNode], plane: LinearPlane, von_mises: Array) -> list[_AtNode]:
        """The nodes of highest von Mises stress under different contacts, of a plane and those before."""
        values, apart = von_mises.ravel(), plane.depth + 2 * max(plane.grid.spacing)
        found, number = [*before], len(self._depths) - 1
        least = RIVAL * max([float(values.max()), *(each.size for each in before)])
        nodes = np.flatnonzero(values >= least)
        if nodes.size > MOST_HIGH:
            nodes = np.array([values.argmax()])
        places = np.stack(np.divmod(nodes, plane.grid.shape[1]), -1) * plane.grid.spacing + plane.first_node
        values = values[nodes]
        for _ in range(MOST_RIVALS):
            if not values.max(initial=0.0) >= least:
                break
            best = int(values.argmax())
            y, x = places[best].tolist()
            found.append(_AtNode(float(values[best]), number, plane.grid.spacing, (y, x)))
            values[np.hypot(*(places - places[best]).T) < apart] = 0.0
        kept: list[_AtNode] = []
        for each in sorted(found, key=lambda each: -each.size):
            reaches = (self._depths[other.plane] + 2 * max(other.spacing) for other in kept)
            distances = (np.hypot(*np.subtract(each.place, other.place)) for other in kept)
            far = all(distance >= reach for distance, reach in zip(distances, reaches, strict=True))
            if far and len(kept) < MOST_RIVALS and each.size >= least:
                kept.append(each)
        return kept

    def refined(
        self,
        loaded: LoadedSolid,
        tolerance: float,
        friction: float = 0.0,
        sliding_direction: str | float = "x",
    ) -> list[dict[str, Extreme]]:
        """Field → its extreme value in each material from the surface down, when all planes passed.

        At most five planes for each node are computed again: of the node, the neighbours, and between them.

        Parameters
        ----------
        loaded, tolerance, friction, sliding_direction
            Of the stream.
        """
        ends = [*self._starts[1:], len(self._depths)]
        found: list[list[tuple[Array, Array]]] = [[] for _ in self._parts]
        sought = []
        for own, first, end, part, rivals in zip(
            found, self._starts, ends, self._parts, self._rivals, strict=True
        ):
            for name, at_node in (*part.items(), *(("von_mises", rival) for rival in rivals)):
                near = [] if loaded.is_plastic else [at_node.plane - 1, at_node.plane + 1]
                depth = self._depths[at_node.plane]
                others = [self._depths[each] for each in near if first <= each < end]
                depths = {depth, *others, *((depth + other) / 2 for other in others)}
                sought.append((own, name, at_node, depth, depths, list[_Patch]()))
        every = sorted({each for *_, depths, _ in sought for each in depths})
        stream = PlaneStream(loaded, every, None, COMPONENTS, tolerance, 1, None, friction, sliding_direction)
        for plane in stream.planes():
            for *_, at_node, _, depths, patches in sought:
                if plane.depth in depths:
                    patches.append(_Patch.of(plane, self._layer.poisson, np.array(at_node.place)))
        for own, name, at_node, depth, _, patches in sought:
            reach = (0.0, 0.0) if loaded.is_plastic else at_node.spacing
            own.append(_refined(name, patches, np.array([depth, *at_node.place]), reach))
        return [
            {name: _largest(name, own, stream) for name in part}
            for part, own in zip(self._parts, found, strict=True)
        ]

    def values(self, parts: Sequence[Mapping[str, Extreme]]) -> dict[str, float]:
        """Extreme values by name: of the fields, of each of several materials, and of the interfaces.

        Materials and interfaces are counted from 0, as in ``von_mises 0``, ``shear 0`` and ``tension 0``.

        Parameters
        ----------
        parts : sequence of dict
            Result of `refined`.
        """
        found = {name: each.value for name, each in largest_of(parts).items()}
        if len(parts) > 1:
            of_parts = ((n, name, part[name]) for n, part in enumerate(parts) for name in OF_MATERIALS)
            found |= {f"{name} {n}": each.value for n, name, each in of_parts}
        for number, face in enumerate(self.interfaces):
            found |= {f"shear {number}": face.shear.value, f"tension {number}": face.tension.value}
        return found


class _Patch(NamedTuple):
    """Components of the stress, (6, rows, columns), in a part of a plane, and places y and x of its nodes."""

    depth: float
    first: Array
    spacing: Array
    values: Array

    @classmethod
    def of(cls, plane: LinearPlane, poisson: float, place: Array) -> _Patch:
        spacing, first = np.array(plane.grid.spacing), np.array(plane.first_node)
        middle, sizes = np.rint((place - first) / spacing).astype(int), np.minimum(PATCH, plane.grid.shape)
        nodes = [np.arange(at - size + 1, at + size) for at, size in zip(middle, sizes, strict=True)]
        values = [plane.field_around(name, poisson, *nodes) for name in COMPONENTS]
        return cls(
            plane.depth, first + spacing * [each[0] for each in nodes], spacing, np.array(values, float)
        )

    def at(self, y: Array, x: Array) -> Array:
        """Components, (6, y, x), on a rectangle of places."""
        from scipy.ndimage import map_coordinates

        places = np.meshgrid(*((np.array([y, x]).T - self.first) / self.spacing).T, indexing="ij")
        return np.array([map_coordinates(each, places, order=5, mode="mirror") for each in self.values])


def _refined(
    name: str, patches: Sequence[_Patch], centre: Array, reach: tuple[float, float]
) -> tuple[Array, Array]:
    """Place (depth, y, x) of the extreme value of a field between planes and nodes, and the tensor there."""
    depths, stress = np.array([patch.depth for patch in patches]), np.zeros(6)
    reaches = np.array([np.ptp(depths), *reach])
    for _ in range(ZOOMS):
        axes = [np.unique(middle + OFFSETS * size) for middle, size in zip(centre, reaches, strict=True)]
        axes[0] = np.unique(np.clip(axes[0], depths[0], depths[-1]))
        in_planes = [patch.at(axes[1], axes[2]) for patch in patches]
        tensors = np.einsum("zp,pcyx->czyx", lagrange_weights(depths, axes[0]), in_planes)
        sizes = _size(name, field_of(name, tensors))
        best = np.unravel_index(sizes.argmax(), sizes.shape)
        centre = np.array([axis[index] for axis, index in zip(axes, best, strict=True)])
        stress, reaches = tensors[(slice(None), *best)], reaches / 4
    return centre, stress


def field_of(name: str, stress: Array) -> Array:
    """A field of stress tensors, given by their components along the first axis."""
    if name in COMPONENTS:
        return stress[COMPONENTS.index(name)]
    xx, yy, zz, yz, xz, xy = stress
    if name == "hydrostatic":
        return (xx + yy + zz) / 3
    if name == "von_mises":
        normal = (xx - yy) ** 2 + (yy - zz) ** 2 + (zz - xx) ** 2
        return np.sqrt(normal / 2 + 3 * (yz**2 + xz**2 + xy**2))
    tensors = np.moveaxis(np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]), (0, 1), (-2, -1))
    third, second, first = np.moveaxis(np.linalg.eigvalsh(tensors), -1, 0)
    if name == "maximum_shear":
        return (first - third) / 2
    return {"principal_1": first, "principal_2": second, "principal_3": third}[name]


def _size(name: str, values: Array) -> Array:
    return DIRECTION[name] * values if name in DIRECTION else np.abs(values)


def _largest(name: str, points: Iterable[tuple[Array, Array]], stream: PlaneStream) -> Extreme:
    """The extreme value of a field among points, with its place on the map."""
    place, stress = max(points, key=lambda point: _size(name, field_of(name, point[1])))
    value, grid, on_image = float(field_of(name, stress)), stream.map_grid, False
    y, x = place[1:]
    if grid.mirrored:
        on_image = bool(stream.images(y, x)[0])
    else:
        axes = zip((y, x), grid.length, BOUNDARIES[stream.solid.boundary], strict=True)
        y, x = (at if ends else np.mod(at, edge) for at, edge, ends in axes)
    y, x = (float(each) for each in grid.on_map(y, x))
    return Extreme(value, float(place[0]), y, x, tuple(stress.tolist()), on_image)


def largest_of(parts: Sequence[Mapping[str, Extreme]]) -> dict[str, Extreme]:
    """Field → its extreme value in all materials together."""
    return {
        name: max((part[name] for part in parts), key=lambda each: float(_size(name, np.array(each.value))))
        for name in parts[0]
    }
