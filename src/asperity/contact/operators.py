"""The compliance on the contact nodes to a per cent, and its approximate inverse, for inner solves.

An inner solve computes a correction, and the outer loop evaluates the gap anew: its displacement need not be
more accurate than a per cent.

**Compliance.** The convolution with the compliance G is divided into

    G ≈ near + P far Pᵀ,

where P interpolates linearly from the nodes of a coarser grid, each in the middle of two nodes along both
axes, `far` is a convolution on those nodes, and `near` is a stencil on all nodes. The far field takes one
pair of transforms of a quarter of the nodes, in single precision. It is G, divided by the square of the
transform of P, cos³(q × spacing / 2) along each axis, and smoothly cut off towards the shortest wave of the
coarser grid. The stencil is the missing part of G within its radius. Since coarse-grid nodes lie behind even
nodes and before odd ones, the stencils of both are mirror images. The division into a near field and a
coarser grid is due to Brandt & Lubrecht (1990, 10.1016/0021-9991(90)90171-V), and a stencil that corrects the
near field of the coarser grid is known from Phillips & White (1997, 10.1109/43.662670).

**Inverse.** The inverse of a half-space's compliance is E* |q| / 2, whose kernel in real space decays as r⁻³.
Cut off at a few nodes and restricted to the contact nodes it is a sparse matrix S that is cheap to apply. It
is related to the FFT-based preconditioner of Vollebregt (J. Comput. Phys. 257 (2014) 333). S lacks the
elastic interaction of distant contacts: it removes a uniform residual by the pressure w = S 1, as if every
contact patch stood alone. For residuals that vary over lengths much longer than the patches that pressure is
too large.

New here is the correction of these long waves on a coarse grid. There a contact acts only by its sum over a
cell. Let σ be the sum of w in each cell divided by the cell's area, V the operator that distributes a value
of each cell over its contact nodes in proportion to w, and G the compliance on the coarse grid. The pressure
of a long wave obeys (1/σ + G) p = r, where S assumes p = σ r. With Woodbury's identity,

    (1/σ + G)⁻¹ = σ − σ (σ + 1/G)⁻¹ σ,      the preconditioner becomes      M = S − V (σ + 1/G)⁻¹ Vᵀ.

S is the sum of diag(w) and a graph Laplacian, so that M is positive definite for every G ≥ 0. In full contact
with a half-space, where S has the eigenvalue σ for long waves, M has σ q / (σ + q), which tends to q. The
system of the coarse grid is solved by a few conjugate gradients, preconditioned by the same operator with the
mean of σ.
"""

import math
from dataclasses import replace
from functools import cached_property, lru_cache
from typing import Any

import numpy as np

from asperity.contact.contact_nodes import (
    RADIUS,
    StencilProduct,
    add_multiple,
    add_prolongated,
    added,
    coarse_indices,
    dot,
    field_of,
    restrict,
    row_plus_column,
    whole_stencil,
)
from asperity.contact.response import Response, multiply, multiply_rows
from asperity.contact.sparse_inverse import SparseInverse, influence
from asperity.core.compiled import compiled, vectorised_sums
from asperity.core.parallel import in_parts, in_strips, sum_parts
from asperity.core.types import Array
from asperity.elasticity.two_bodies import Solids
from asperity.fourier.engine import Engine
from asperity.fourier.grid import Fourier, Grid

# The far field is multiplied by exp(−(|q_y| / q_c)^n − (|q_x| / q_c)^n) with this n and the shortest wave q_c
# of the coarser grid. The displacement under random pressures on the contact of a rough surface of 256² nodes
# is then wrong by 0.9 %, with n = 2.5 or 4 by 1.4 and 1.5 %.
CUTOFF_POWER = 3.0

# Grids with fewer nodes on an axis are not divided: their transforms take hardly any time.
MIN_POINTS = 128

# The spacings of a grid that is divided differ at most by this factor: the stencil has the same radius, in
# nodes, on both axes.
MAX_SPACING_RATIO = 1.5

# Largest factor by which q G falls to a quarter of a wavelength: under a coating that is stiff and as thin
# as the spacing the error of the division exceeds the displacement of the shortest waves.
MAX_STEEPNESS = 2.0

# Nodes on the edge of the small map on which the stencils are computed.
_TILE = 64

# The inverse compliance of a layered solid is used as a stencil if it is positive definite, the sum of its
# positive weights outside the middle is at most this fraction of the middle, and q G of the longest wave at
# most so many times that of the shortest. Otherwise, as under stiff films, a sparse inverse is made for every
# contact, which takes fewer iterations but more time on large contacts.
MAX_OUTWARD, MAX_SOFTNESS = 0.5, 30.0

# Nodes on the edge of a cell of the coarse grid. Found by trial on rough surfaces of 512² nodes: with 32
# nodes a solution takes 7 % more transforms, with 8 as many, but the coarse grid is four times larger.
CELL_NODES = 16

# The coarse system is solved until the preconditioned norm of its residual has dropped by this factor, or,
# with more than 200 cells on an edge, by 6 / (cells on an edge): the more cells, the more S overestimates
# the longest waves.
COARSE_RESIDUAL_DROP = 0.03

# Nodes of a cell, and drop, under layers, where S is less accurate, and where q G of the longest wave is more
# than so many times that of the shortest. Found by trial on rough surfaces of 512² and 1024² nodes under
# coatings of 0.01 to 30 times the modulus: with 4 nodes and a drop of 0.005 a contact takes 10 to 20 % longer
# where that factor is below 10; with 8 nodes and 0.02 up to twice as long where it is above.
LAYERED_COARSE_GRID, STIFF_COARSE_GRID, STIFF_SOFTNESS = (8, 0.02), (4, 0.005), 10.0
MAX_COARSE_ITERATIONS = 50


class Operators:
    """The approximate compliance G and its approximate inverse M on the contact nodes.

    Displacements are in units of `Response.nodal_compliance`, and so have the unit of a pressure.

    Attributes
    ----------
    nodes : (count,) array of unsigned integers
        Sorted indices of the contact nodes in the flattened grid.
    response : InnerResponse
    precondition : NodePreconditioner
    uniform : (count,) array
        Pressures M 1 that remove a uniform residual.
    uniform_sum : float
        Their sum.
    """

    def __init__(self, nodes: Array, response: "InnerResponse", whole: "Preconditioner") -> None:
        self.nodes, self.response = nodes, response
        in_map = response.in_map(nodes)
        self.precondition: NodePreconditioner | SparseInverse
        if whole.influence is not None:
            self.precondition = SparseInverse(whole.influence, whole.grid.shape, in_map, whole.threads)
        else:
            self.precondition = NodePreconditioner(whole, in_map)
        self.uniform = self.precondition.uniform
        self.uniform_sum = sum_parts(added, whole.threads, self.uniform)

    @cached_property
    def _indices(self) -> Any:
        return self.response.indices(self.nodes)

    def displacement(self, pressure: Array, at: Array | None = None) -> Array:
        """Displacement under pressures on the contact nodes, at these or at others given by their indices."""
        return self.response.displacement(pressure, self.nodes, self._indices, at)


class InnerResponse:
    """Displacements, in units of `Response.nodal_compliance`, under pressures on some nodes.

    Parameters
    ----------
    response : Response
    products : StencilProduct
        For the same grid.
    divided : bool
        False if displacements are to be right to single precision, by transforms of the whole grid.
    """

    def __init__(self, response: Response, products: StencilProduct, divided: bool = True) -> None:
        self._grid, self._unit = response.grid, response.nodal_compliance
        self._products, self._whole = products, response
        self._is_divided = divided and _can_be_divided(response)

    # Made when they are first needed: contacts that touch little do without them.

    @cached_property
    def _far(self) -> "FarField | None":
        return FarField(self._whole, 1 / self._unit) if self._is_divided else None

    @cached_property
    def _stencil(self) -> Array:
        response = self._whole
        kind: Any = type(response)
        return near_stencil(kind, response.solid, _spacing_of_stencils(response), response.fourier.engine)

    @cached_property
    def _response(self) -> Response:
        single = self._whole.fourier.real == np.float32
        return self._whole if single else self._whole.in_precision("float32")

    def in_map(self, nodes: Array) -> Array:
        """Indices of nodes in the flattened map."""
        return nodes

    def indices(self, nodes: Array) -> Array | None:
        """Indices of nodes among the coarse-grid nodes, which `displacement` needs."""
        return None if self._far is None else self._far.indices(nodes)

    def displacement(
        self, pressure: Array, nodes: Array, indices: Array | None, at: Array | None = None
    ) -> Array:
        """Displacements under pressures on nodes, at these nodes or at others.

        Parameters
        ----------
        pressure : (count,) array
        nodes : (count,) array of unsigned integers
            Sorted indices in the flattened map.
        indices : array or None
            From `indices`.
        at : array, optional
        """
        if self._far is None:
            field = field_of(self._grid.shape, nodes, pressure)
            self._response.displacement(field, field)
            return field.reshape(-1)[nodes if at is None else at] * np.float32(1 / self._unit)
        far = self._far
        out = self._products(
            self._stencil, nodes, pressure, at, meanwhile=lambda: far.restrict(pressure, indices)
        )
        far.convolve()
        far.add(out, indices if at is None else far.indices(at))
        return out


class FarField:
    """Convolution on half of the nodes of each axis of the long waves of a compliance, in its own array.

    Parameters
    ----------
    response : Response
    scale : float
        Factor of the displacements.
    dtype : "float32" or "float64"
    """

    def __init__(self, response: Response, scale: float, dtype: str = "float32") -> None:
        modes = response.mode_grid
        ny, nx = modes.shape
        self._shape = response.grid.shape
        grid = replace(modes, shape=(ny // 2, nx // 2))
        self._fourier = Fourier(grid, dtype, response.fourier.threads, response.fourier.work)
        half = response.half_compliance[: grid.half_shape[0], : grid.half_shape[1]]
        self._half_factors = np.empty(half.shape, self._fourier.real)
        dy, dx = modes.spacing
        angles = 0.5 * dy * np.abs(grid.qy[: len(half)]), 0.5 * dx * grid.qx
        along_y, along_x = (
            np.exp(-((4 / np.pi * angle) ** CUTOFF_POWER)) / np.cos(angle) ** 6 for angle in angles
        )

        def fill(rows: slice) -> None:
            factors = along_y[rows, None] * along_x * (scale / 4)
            self._half_factors[rows] = half[rows].astype(float) * factors

        in_strips(fill, half.shape, response.fourier.threads)
        self._padded = np.zeros((grid.shape[0] + 2, grid.shape[1] + 2), self._fourier.real)
        self._coefficients = np.empty(grid.mode_shape, self._fourier.coefficient_type)

    def indices(self, nodes: Array) -> Array:
        """Indices of nodes of the map among the coarse-grid nodes."""
        return coarse_indices(nodes, self._shape, self._padded.shape[1])

    def restrict(self, pressure: Array, indices: Any) -> None:
        """Write the sums of pressures on nodes over the coarse-grid nodes."""
        restrict(indices, pressure, self._padded.shape[1], self._padded.reshape(-1))

    def convolve(self) -> None:
        """Replace sums over the coarse-grid nodes by displacements there, and in the margin."""
        padded, values = self._padded, self._padded[1:-1, 1:-1]
        first, last = (1, -2) if self._fourier.grid.mirrored else (-2, 1)  # repeated in the margin
        for lines in (padded, padded.T):
            lines[first] += lines[0]
            lines[last] += lines[-1]
        coefficients = self._fourier.forward(values, self._coefficients)
        multiply(coefficients, self._half_factors, self._fourier.threads)
        self._fourier.inverse(coefficients, values, overwrite=True)
        for lines in (padded, padded.T):
            lines[0], lines[-1] = lines[first], lines[last]

    def add(self, out: Array, indices: Any) -> None:
        """Add the displacements at nodes, given by their indices, to values."""
        field, width = self._padded.reshape(-1), self._padded.shape[1]

        def add(part: slice) -> None:
            add_prolongated(field, indices[part], width, out[part])

        in_parts(add, out.size, self._fourier.threads)


@lru_cache(maxsize=16)
def near_stencil(kind: type[Response], solid: Solids, spacing: tuple[float, float], engine: Engine) -> Array:
    """Displacements near one node under pressure that the far field lacks, in units of the nodal compliance.

    Parameters
    ----------
    kind : type
        One of `asperity.contact.response.RESPONSES`.
    solid : Solid or TwoBodies
    spacing : (float, float)
        Along y and x.
    engine : Engine
        Of the transforms.

    Returns
    -------
    array
        A stencil of `asperity.contact.contact_nodes.whole_stencil`.
    """
    radius = RADIUS
    tile = Grid((_TILE, _TILE), (_TILE * spacing[0], _TILE * spacing[1]))
    of_tile = kind(solid, kind.transforms(tile, engine=engine))
    far = FarField(of_tile, 1.0, "float64")
    offsets = np.arange(-radius, radius + 1)
    inside = offsets[:, None] ** 2 + offsets[None, :] ** 2 <= radius * (radius + 1)
    edge = inside & (offsets[:, None] ** 2 + offsets[None, :] ** 2 > radius * (radius - 1))
    place = _TILE // 2
    unit = np.zeros(tile.shape)
    unit[place, place] = 1
    missing = of_tile.displacement(unit)
    far.restrict(np.ones(1), far.indices(np.array([place * _TILE + place], np.uint32)))
    far.convolve()
    far_field = np.zeros(tile.size)
    far.add(far_field, far.indices(np.arange(tile.size, dtype=np.uint32)))
    missing -= far_field.reshape(tile.shape)
    around = slice(place - radius, place + radius + 1)
    weights = np.where(inside, missing[around, around], 0)
    # The remainder beyond the stencil is added to its edge, so that uniform pressures are right.
    weights[edge] += (missing.sum() - weights.sum()) / np.count_nonzero(edge)
    return whole_stencil(weights / of_tile.nodal_compliance)


def _spacing_of_stencils(response: Response) -> tuple[float, float]:
    """Spacing for which the stencils are made: the spacing of the grid, or a multiple with the same stencils.

    A half-space has no length of its own, so that the spacing may be multiplied by a power of two, which
    causes no rounding.
    """
    dy, dx = response.grid.spacing
    if response.solid.height is not None or response.solid.interface is not None:
        return dy, dx
    exponent = -math.frexp(max(dy, dx))[1]
    return math.ldexp(dy, exponent), math.ldexp(dx, exponent)


def _can_be_divided(response: Response) -> bool:
    """True if the grid is large enough, half of its nodes are a grid of its own, and G is smooth."""
    grid, solid = response.grid, response.solid
    if solid.interface is not None:
        q = np.pi / min(grid.spacing) * np.array([0.25, 1.0])
        longer, shortest = q * solid.surface_compliance(q)
        if longer > MAX_STEEPNESS * shortest:
            return False
    even = all(nodes % 2 == 0 for nodes in response.mode_grid.shape)
    ratio = max(grid.spacing) / min(grid.spacing)
    return even and min(grid.shape) >= MIN_POINTS and ratio <= MAX_SPACING_RATIO


class Preconditioner:
    """Approximate inverse of the compliance of one grid.

    Parameters
    ----------
    response : Response
    products : StencilProduct
        For the same grid.

    Attributes
    ----------
    nodal_stiffness : float
        Pressure that removes a unit residual of a node that alone is in contact.
    coarse_drop : float
        Factor by which the residual of the coarse system drops.
    influence : array or None
        Of `asperity.contact.sparse_inverse`, under layers.
    """

    def __init__(self, response: Response, products: StencilProduct) -> None:
        self.grid, self.products, self.threads = response.grid, products, response.fourier.threads
        grid, is_layered = response.grid, response.solid.interface is not None
        radius = max(0, min(RADIUS, (min(grid.whole_cell.shape) - 1) // 2))
        weights, suffices = inverse_stencil(
            response.solid, _spacing_of_stencils(response), radius, response.fourier.engine
        )
        q = 2 * np.pi / np.array([max(grid.period), 2 * min(grid.spacing)])
        longest, shortest = q * response.solid.surface_compliance(q) if is_layered else (1.0, 1.0)
        self.influence = None
        if not suffices or longest > MAX_SOFTNESS * shortest:
            self.influence = influence(response)
            self.nodal_stiffness = 1 / float(self.influence[0, 0])
            return
        self.nodal_stiffness = float(weights[RADIUS, RADIUS])
        self.stencil = whole_stencil(weights)
        # Where one spacing is more than twice the other, cells are about square.
        nodes, drop = LAYERED_COARSE_GRID if is_layered else (CELL_NODES, COARSE_RESIDUAL_DROP)
        if longest > STIFF_SOFTNESS * shortest:
            nodes, drop = STIFF_COARSE_GRID
        sides = (max(1, int(nodes * min(1, 2 * min(grid.spacing) / step))) for step in grid.spacing)
        shape = tuple(max(1, n // side) for n, side in zip(grid.shape, sides, strict=True))
        self.cells = Grid(shape, grid.length, grid.mirrored)  # type: ignore[arg-type]
        self.coarse, compliance = response.on_cells(self.cells)
        self.coarse_drop = min(drop, 6.0 / max(self.coarse.grid.whole_cell.shape))
        self.compliance = compliance / response.nodal_compliance

    def on_coarse_grid(self, of_cells: Array) -> Array:
        """Field of the cells in single precision, on the grid of the coarse transforms, zero elsewhere."""
        ny, nx = self.cells.shape
        out = np.zeros(self.coarse.grid.shape, np.float32)
        out[:ny, :nx] = of_cells.reshape(ny, nx)
        return out


class NodePreconditioner:
    """A preconditioner restricted to contact nodes.

    It maps residuals, displacements in units of `Response.nodal_compliance`, to the pressures that remove
    them.

    Parameters
    ----------
    whole : Preconditioner
    nodes : (count,) array of unsigned integers
        Sorted indices in the flattened map.

    Attributes
    ----------
    uniform : (count,) array
        Pressures M 1 that approximately remove a residual of one on every contact node.
    """

    def __init__(self, whole: Preconditioner, nodes: Array) -> None:
        self._whole, self._nodes = whole, nodes
        grid, cells = whole.grid, whole.cells
        row, column = (np.arange(n) * m // n for n, m in zip(grid.shape, cells.shape, strict=True))
        of_row, of_column = (row * cells.shape[1]).astype(np.uint32), column.astype(np.uint32)
        self._cell = row_plus_column(nodes, of_row, of_column)
        ones = np.ones(nodes.size, np.float32)
        self._weight = whole.products(whole.stencil, nodes, ones)
        cell_weight = self._sums_in_cells(ones)
        sigma = cell_weight * (cells.size / grid.size)
        mean = float(sigma.mean())
        self._sigma, self._mean_sigma = whole.on_coarse_grid(sigma), np.float32(mean)
        self._inverse_for_mean = (whole.compliance / (1 + mean * whole.compliance)).astype(np.float32)
        self.uniform = self._weight.copy()
        self._subtract_far_field(self._displacement(cell_weight), self.uniform)

    def __call__(self, residual: Array) -> Array:
        """Pressures M r that approximately remove a residual r on the contact nodes."""
        found: list[Array] = []

        def solve_coarse() -> None:
            found.append(self._displacement(self._sums_in_cells(residual)))

        # The coarse system is too small for several threads: the others apply the stencil.
        whole = self._whole
        out = whole.products(whole.stencil, self._nodes, residual, meanwhile=solve_coarse)
        self._subtract_far_field(found[0], out)
        return out

    def _subtract_far_field(self, displacement: Array, out: Array) -> None:
        """Subtract V y, given the displacement y of the cells."""

        def subtract(part: slice) -> None:
            _subtract_in_cells(self._cell[part], self._weight[part], displacement, out[part])

        in_parts(subtract, out.size, self._whole.threads)

    def _sums_in_cells(self, values: Array) -> Array:
        """Sums of w × value over the contact nodes of each cell."""
        out = np.zeros(self._whole.cells.size)
        _add_weighted_in_cells(self._cell, self._weight, values, out)
        return out

    def _displacement(self, cell_sums: Array) -> Array:
        """Displacement (σ + 1/G)⁻¹ Vᵀ r of the cells, given the sums of w r over them."""
        whole, fourier = self._whole, self._whole.coarse
        residual = whole.on_coarse_grid(cell_sums * (whole.cells.size / whole.grid.size))
        y, direction, image, response, z = np.zeros((5, *residual.shape), np.float32)
        fields = [field.reshape(-1) for field in (residual, z, self._sigma, direction, image, response)]
        coefficients = np.empty(fourier.grid.mode_shape, fourier.coefficient_type)
        first = previous = 0.0
        for iteration in range(MAX_COARSE_ITERATIONS):
            fourier.forward(residual, coefficients)
            multiply_rows(coefficients, self._inverse_for_mean)
            fourier.inverse(coefficients, z, overwrite=True)
            product = dot(fields[0], fields[1])
            first = first or product
            if not product > whole.coarse_drop**2 * first:
                break
            ratio = np.float32(product / previous) if iteration else np.float32(0)
            previous = product
            curvature = _next_direction(ratio, self._mean_sigma, *fields)
            if not curvature > 0:
                break
            length = np.float32(product / curvature)
            add_multiple(y.reshape(-1), direction.reshape(-1), length)
            add_multiple(residual.reshape(-1), response.reshape(-1), -length)
        ny, nx = whole.cells.shape
        return y[:ny, :nx].reshape(-1)


@lru_cache(maxsize=16)
def inverse_stencil(
    solid: Solids, spacing: tuple[float, float], radius: int, engine: Engine
) -> tuple[Array, bool]:
    """The inverse of the compliance in real space, (2 RADIUS + 1, 2 RADIUS + 1), and whether it may be used.

    In units of the nodal compliance; it is zero beyond a radius in nodes, and the same for all nodes. On a
    half-space, and in one layer, it is E* |q| / 2, under more layers one over the compliance.
    """
    tile = Grid((_TILE, _TILE), (_TILE * spacing[0], _TILE * spacing[1]))
    fourier, suffices = Fourier(tile, engine=engine), True
    row, column = (np.minimum(places, _TILE - places) for places in np.ogrid[:_TILE, :_TILE])
    modes = 0.5 * tile.wavenumber() * min(spacing)
    if solid.interface is not None:
        compliance = solid.surface_compliance(tile.wavenumber()) * (solid.effective_modulus / min(spacing))
        modes = np.divide(1, compliance, where=compliance > 0, out=0 * modes)
    near = row**2 + column**2 <= radius * (radius + 1)
    weights = np.where(near, fourier.inverse(modes / tile.size + 0j), 0)
    if solid.interface is not None:
        outward = np.maximum(weights, 0).sum() - weights[0, 0]
        suffices = bool(fourier.forward(weights).real.min() > 0 and outward < MAX_OUTWARD * weights[0, 0])
    off = np.abs(np.arange(-RADIUS, RADIUS + 1))
    return weights[off[:, None], off].astype(np.float32), suffices


@compiled
def _add_weighted_in_cells(cell: Any, weight: Any, values: Any, sums: Any) -> None:
    """Add weight × value to the sums of their cells."""
    for k in range(cell.size):
        sums[cell[k]] += weight[k] * values[k]


@compiled
def _subtract_in_cells(cell: Any, weight: Any, displacement: Any, out: Any) -> None:
    """Subtract weight × displacement of its cell from every contact node."""
    for k in range(cell.size):
        out[k] -= weight[k] * displacement[cell[k]]


@vectorised_sums
def _next_direction(
    ratio: Any, mean_sigma: Any, residual: Any, z: Any, sigma: Any, direction: Any, image: Any, response: Any
) -> float:
    """Update direction and response of the coarse system, and return the curvature along the direction.

    `image` is (mean σ + 1/G) × direction. As (mean σ + 1/G) z is the residual, no division by a compliance
    that may be zero is needed.
    """
    curvature = 0.0
    for k in range(z.size):
        direction[k] = ratio * direction[k] + z[k]
        image[k] = ratio * image[k] + (residual[k] - mean_sigma * z[k])
        response[k] = sigma[k] * direction[k] + image[k]
        curvature += np.float64(direction[k]) * np.float64(response[k])
    return curvature
