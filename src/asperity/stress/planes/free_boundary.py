"""Planes of the stress under a pressure that ends along one axis or both (``boundary = "free"`` and others).

The pressure is uniform on every pixel of the map, as in the contact over a free boundary, and zero outside;
along an axis that repeats every pixel has images, and nothing is padded.
Its stress is the convolution with the stress of a loaded pixel, computed by fast Fourier transforms on a cell
padded with zeros. This is exact: no pixel meets an image of another (R. W. Hockney, Methods Comput. Phys. 9
(1970) 135; S. Liu, Q. Wang, G. Liu, Wear 243 (2000) 101, DOI 10.1016/S0043-1648(00)00427-0). There is no mean
(q = 0) mode: the solid is free to spread.

Loaded pixel
------------
The stress under a uniform pressure or shear traction on a rectangle is known in closed form.
Source: A. E. H. Love, Phil. Trans. R. Soc. A 228 (1929) 377, DOI 10.1098/rsta.1929.0009, for the pressure;
for the traction, Cerruti's solution (K. L. Johnson, Contact Mechanics, Cambridge University Press, 1985,
section 3.2), integrated in the same way. With z the depth, ρ = √(X² + Y² + z²), and X, Y the distances to a
corner, every component is a sum over the four corners, with alternating signs, of primitives F(X, Y). The
potentials V = ∫∫ dS/ρ, χ = ∫∫ ln(z + ρ) dS and φ2 = ∫∫ (z ln(z + ρ) − ρ) dS have the primitives

    V,z    −atan(X Y/(z ρ))          V,xx   −X Y/(ρ (X² + z²))       V,xz   −z Y/(ρ (X² + z²))
    V,xy   1/ρ                       V,x    asinh(Y/√(X² + z²))      χ,xx   atan(X Y (ρ − z)/(X² ρ + Y² z))
    χ,xy   ln(z + ρ)                 χ,xxy  X/(ρ (ρ + z))            φ2,xxy −X/(ρ + z)

and those with x and y exchanged; functions of X or Y alone, which the alternating sum removes, are left out
so that nothing cancels at corners far away. The potentials are harmonic, which gives the rest:
V,zz = −V,xx − V,yy, χ,xxx = −χ,xyy − V,xz, φ2,xxx = −φ2,xyy − V,x.

Coarse planes
-------------
A deep plane is smooth, and is computed on a coarser grid. The pressure, in a cell three times as long as the
map, keeps the modes that the coarse grid holds; they are divided by the transform of a coarse pixel and
multiplied by the transform of a fine one, because the influence belongs to a coarse pixel. The influence is
exact up to the distance of two nodes of the map. Beyond, it falls smoothly to zero over half a map's length,
so that its transform has no slow tail. The error has two parts, both bounded from the spectrum of the
pressure as in `asperity.stress.planes.truncation`: the modes dropped, and the short waves of the influence
that appear as long ones at the coarse nodes (aliasing).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cached_property, partial

import numpy as np
import scipy  # whose parts are loaded when they are first used

from asperity.core.parallel import run_tasks
from asperity.core.types import Array
from asperity.elasticity.loaded_rectangle import padded_grid, with_images
from asperity.elasticity.loaded_solid import LoadedSolid
from asperity.fourier.grid import BOUNDARIES, Fourier, Grid, Work, resample
from asperity.stress.planes.fields import BasisField, Visit, bands_of, strips_of
from asperity.stress.planes.truncation import PlaneGrid, Truncation, coarser_grids

PADDING = 3
"""Length of the padded cell of coarse planes over the length of the map: the influence falls to zero and
rises again between the map and its image."""

TAPER_STEEPNESS = 4.0
"""The influence falls as the error function from −4 to 4, whose ends differ from 1 and 0 by 8e-9."""

MIN_NODES = 48
"""Fewest nodes on an edge of a coarse plane: the modes of the falling influence that the grid drops are then
below 3e-10 of it."""

ALIASES = 4.0
"""See `Truncation`."""

_NOTHING = np.zeros((1, 1))


class FreePlanes:
    """Transforms of basis fields of the stress under a pressure on an isolated map.

    Parameters and attributes as for `asperity.stress.planes.periodic.PeriodicPlanes`; each node of the grid
    is the centre of a pixel. The tolerance of coarse planes refers to the root mean square of σ_zz in the
    padded cell. Without coarse planes there is no such error.
    """

    mean_pressure = 0.0
    dtype = np.dtype(float)

    def __init__(
        self,
        solid: LoadedSolid,
        tolerance: float,
        envelope: Callable[[float], float],
        traction: tuple[float, float],
        threads: int,
        work: Work,
    ) -> None:
        grid = self._grid = solid.grid
        self._threads, self._work = threads, work
        # Load along z, x and y over a pressure, and the pressure.
        self._loads = [((1.0, *traction), solid.pressure)]
        if solid.sticking_pressure is not None and any(traction):
            self._loads = [((1.0, 0.0, 0.0), solid.pressure), ((0.0, *traction), solid.sliding_pressure)]
        self._free = free = BOUNDARIES[solid.boundary]
        # Where the map ends the cell of a plane on its grid is twice as long, of a coarse one three times.
        coarse = [
            other
            for other in coarser_grids(grid)[1:]
            if min(other.shape) >= MIN_NODES
            and PADDING ** sum(free) * other.size < 2 ** sum(free) * grid.size
        ]
        if tolerance == 0 or not coarse:
            self.choose: Callable[[float], PlaneGrid] = lambda _: PlaneGrid(grid, 0.0, 0.0, 0)
            return
        own = {self._coarse_cell(each): each for each in (grid, *coarse)}
        modes, sliding = self._repeated_modes[0], self._repeated_modes[-1]
        truncation = Truncation(modes, list(own), solid.layer, tolerance, envelope, ALIASES, sliding)

        def choose(depth: float) -> PlaneGrid:
            found = truncation.choose(depth, all_columns=True)
            return PlaneGrid(own[found.grid], found.bound, 0.0, 0)

        self.choose = choose

    @cached_property
    def _repeated_modes(self) -> list[Array]:
        """Coefficients of the pressures in the cell of coarse planes."""
        return self._forward(self._coarse_cell(self._grid))

    @cached_property
    def _padded(self) -> tuple[Grid, list[Array]]:
        """Cell in which the map is convolved on its own grid, and the coefficients of the pressures there."""
        cell = padded_grid(self._grid, self._free)
        return cell, self._forward(cell)

    def _forward(self, cell: Grid) -> list[Array]:
        """Coefficients in a cell of the pressures, which are zero beside the map."""
        field, found = np.zeros(cell.shape), []
        for _, pressure in self._loads:
            field[: self._grid.shape[0], : self._grid.shape[1]] = pressure
            found.append(Fourier(cell, threads=self._threads, work=self._work).forward(field))
        return found

    @staticmethod
    def row_length(grid: Grid) -> int:
        """Numbers in a row of the array that is filled."""
        return grid.shape[1]

    def compute(
        self,
        depth: float,
        own: PlaneGrid,
        fields: Sequence[BasisField],
        values: Array,
        visit: Visit | None = None,
    ) -> None:
        """Compute the basis fields of one plane; arguments as for `PeriodicPlanes`."""
        cell, modes, taper = self._cell(own.grid)
        ny, nx = own.grid.shape

        def transform(field: BasisField, out: Array) -> None:
            fourier, total = Fourier(cell), np.zeros(own.grid.shape)
            for (load, _), own_modes in zip(self._loads, modes, strict=True):
                spectrum = fourier.forward(self._influence(field, depth, cell, load) * taper)
                spectrum *= own_modes
                spectrum *= cell.size
                total += fourier.inverse(spectrum, overwrite=True)[:ny, :nx]
            out[...] = total

        tasks = [partial(transform, field, out) for field, out in zip(fields, values, strict=True)]
        run_tasks(tasks, self._threads)
        self._work.nodes += 2 * len(fields) * len(modes) * cell.size

        def visit_band(number: int, band: tuple[int, int], visit: Visit) -> None:
            for strip in strips_of(band, nx):
                visit(number, *strip)

        if visit is not None:
            bands = [partial(visit_band, *band, visit) for band in enumerate(bands_of(ny))]
            run_tasks(bands, self._threads)

    def _cell(self, grid: Grid) -> tuple[Grid, list[Array], Array | float]:
        """Cell of the convolution, coefficients of the pressures in it, and the taper of the influence."""
        if grid == self._grid:
            return *self._padded, 1.0
        cell, source = self._coarse_cell(grid), self._coarse_cell(self._grid)
        modes = [resample(own, source, cell) for own in self._repeated_modes]
        for axis, wavenumber in ((0, cell.qy[:, None]), (1, cell.qx[None, :])):
            fine, coarse = (np.sinc(wavenumber * own.spacing[axis] / (2 * np.pi)) for own in (source, cell))
            for each in modes:
                each *= fine / coarse
        y, x = (
            _taper(cell, grid, axis) if self._free[axis] else np.ones(cell.shape[axis]) for axis in (0, 1)
        )
        return cell, modes, np.outer(y, x)

    def _coarse_cell(self, grid: Grid) -> Grid:
        """The cell of coarse planes with the spacing of a grid of the map."""
        y, x = (PADDING if ends else 1 for ends in self._free)
        return Grid((y * grid.shape[0], x * grid.shape[1]), (y * grid.length[0], x * grid.length[1]))

    def _influence(
        self, field: BasisField, depth: float, cell: Grid, load: tuple[float, float, float]
    ) -> Array:
        """The basis field around one loaded pixel, in the order of a cyclic convolution."""
        y, x = (step * np.arange(n // 2 + 1) for step, n in zip(cell.spacing, cell.shape, strict=True))
        total = np.zeros(cell.shape)
        for loaded, share in zip("zxy", load, strict=True):
            if share:
                quarter = share * self._pixel(field, loaded, y, x, depth, cell)
                # Reversing y or x changes the sign once for each such letter in component and load.
                sign_y, sign_x = ((-1.0) ** (field.component + loaded).count(letter) for letter in "yx")
                half = np.concatenate([quarter, sign_y * quarter[(cell.shape[0] - 1) // 2 : 0 : -1]], axis=0)
                right = sign_x * half[:, (cell.shape[1] - 1) // 2 : 0 : -1]
                total += np.concatenate([half, right], axis=1)
        return total

    def _pixel(self, field: BasisField, loaded: str, y: Array, x: Array, depth: float, cell: Grid) -> Array:
        """The basis field beside one pixel under a unit load, with its images along an axis that repeats."""

        def influence(y: Array, x: Array, edges: tuple[float, float]) -> Array:
            a, b = rectangle_stress(field.component, loaded, y, x, float(depth), edges)
            return field.constant * a + field.slope * b

        if all(self._free):
            return influence(y, x, cell.spacing)
        return with_images(influence, y, x, cell, self._free, far=float(depth))


def _taper(cell: Grid, grid: Grid, axis: int) -> Array:
    """Factor of the influence along one axis: 1 up to the length of the map, then falling to 0."""
    nodes, length = cell.shape[axis], grid.length[axis]
    place = np.arange(nodes)
    distance = np.minimum(place, nodes - place) * cell.spacing[axis]
    width = (PADDING / 2 - 1) * length
    fall = 0.5 * scipy.special.erfc(TAPER_STEEPNESS * (2 * (distance - length) / width - 1))
    return np.where(distance <= length, 1.0, fall)


def rectangle_stress(
    component: str, loaded: str, y: Array, x: Array, depth: float, edges: tuple[float, float]
) -> tuple[Array, Array]:
    """Basis fields A and B of the stress A + ν B at points of one plane under a unit load on a rectangle.

    Parameters
    ----------
    component : str
        One of `asperity.elasticity.solid.COMPONENTS`; z is upward, depth ≥ 0.
    loaded : "z", "x" or "y"
        Unit pressure (σ_zz = −1 on the rectangle), or unit traction along x or y (σ_xz = 1 or σ_yz = 1).
    y, x : (ny,), (nx,) arrays
        Positions relative to the centre of the rectangle; faster if they are one edge apart.
    depth : float
    edges : (edge_y, edge_x)

    Returns
    -------
    constant, slope : (ny, nx) arrays
    """
    if loaded == "y":
        swapped = component.translate(str.maketrans("xy", "yx"))
        swapped = "xy" if swapped == "yx" else swapped
        constant, slope = rectangle_stress(swapped, "x", x, y, depth, edges[::-1])
        return constant.T, slope.T
    (corner_y, step_y), (corner_x, step_x) = _corners(y, edges[0]), _corners(x, edges[1])
    constant, slope = (_under_pressure if loaded == "z" else _under_traction)(
        component, corner_y[:, None], corner_x[None, :], depth
    )
    constant = _alternating(constant, step_y, step_x)
    return constant, slope if slope is _NOTHING else _alternating(slope, step_y, step_x)


def _corners(places: Array, edge: float) -> tuple[Array, int]:
    """Distances to both ends of an edge: the first end of each place, and so many places on the other one."""
    if np.allclose(np.diff(places), edge, rtol=1e-9, atol=0.0):
        return np.append(places - 0.5 * edge, places[-1] + 0.5 * edge), 1
    return np.concatenate([places - 0.5 * edge, places + 0.5 * edge]), places.size


def _under_pressure(component: str, y: Array, x: Array, z: float) -> tuple[Array, Array]:
    """Primitives of A and B under a pressure."""
    rho = np.sqrt(x**2 + y**2 + z**2)
    if component in ("yy", "yz"):
        return _under_pressure(component.replace("y", "x"), x, y, z)
    v_xx, v_yy = (-x * y / (rho * (side**2 + z**2)) for side in (x, y))
    v_z = -np.arctan2(x * y, z * rho)
    if component == "zz":
        return v_z + z * (v_xx + v_yy), _NOTHING
    if component == "xz":
        return -(z**2) * y / (rho * (x**2 + z**2)), _NOTHING
    if component == "xy":
        chi_xy = np.log(z + rho)
        return -z / rho - chi_xy, 2 * chi_xy
    chi_xx = np.arctan2(x * y * (rho - z), x**2 * rho + y**2 * z)
    return -z * v_xx - chi_xx, 2 * v_z + 2 * chi_xx


def _under_traction(component: str, y: Array, x: Array, z: float) -> tuple[Array, Array]:
    """Primitives of A and B under a traction along x."""
    rho = np.sqrt(x**2 + y**2 + z**2)
    if component == "yz":
        return z / rho, _NOTHING
    if component == "xz":
        return np.arctan2(x * y, z * rho) - z * x * y / (rho * (x**2 + z**2)), _NOTHING
    v_xz = -z * y / (rho * (x**2 + z**2))
    if component == "zz":
        return -z * v_xz, _NOTHING
    v_x, v_y = (np.arcsinh(t / np.sqrt(s**2 + z**2)) for s, t in ((x, y), (y, x)))
    chi_xxy, chi_xyy = (s / (rho * (rho + z)) for s in (x, y))
    phi_xxy, phi_xyy = (-s / (z + rho) for s in (x, y))
    if component == "xy":
        return v_y - z * chi_xxy, 2 * phi_xxy
    if component == "yy":
        return -z * chi_xyy, 2 * v_x + 2 * phi_xyy
    return 2 * v_x + z * (chi_xyy + v_xz), 2 * v_x - 2 * (phi_xyy + v_x)


def _alternating(corners: Array, step_y: int, step_x: int) -> Array:
    """Sum over the four corners of each rectangle, over 2π."""
    rows = corners[step_y:] - corners[:-step_y]
    return (rows[:, step_x:] - rows[:, :-step_x]) / (2 * np.pi)
