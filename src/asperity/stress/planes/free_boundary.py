"""Planes of the stress under an isolated pressure on a half-space (``boundary = "free"``).

The pressure is uniform on every pixel of the map, as in the contact over a free boundary, and zero outside.
Its stress is the convolution with the stress of a loaded pixel in closed form
(`asperity.stress.planes.rectangle`), computed by fast Fourier transforms on a cell padded with zeros. This
is exact: no pixel meets an image of another (R. W. Hockney, Methods Comput. Phys. 9 (1970) 135; S. Liu, Q.
Wang, G. Liu, Wear 243 (2000) 101, DOI 10.1016/S0043-1648(00)00427-0). There is no mean (q = 0) mode:
the solid is free to spread.

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
from asperity.elasticity.loaded_rectangle import padded_grid
from asperity.elasticity.loaded_solid import LoadedSolid
from asperity.fourier.grid import Fourier, Grid, Work, resample
from asperity.stress.planes.fields import BasisField, Visit, bands_of, strips_of
from asperity.stress.planes.rectangle import rectangle_stress
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
        # The cell of a plane on the grid of the map is twice as long, that of a coarse one three times.
        coarse = [
            other
            for other in coarser_grids(grid)[1:]
            if min(other.shape) >= MIN_NODES and PADDING**2 * other.size < 4 * grid.size
        ]
        if tolerance == 0 or not coarse:
            self.choose: Callable[[float], PlaneGrid] = lambda _: PlaneGrid(grid, 0.0, 0.0, 0)
            return
        own = {_repeated(each): each for each in (grid, *coarse)}
        modes, sliding = self._repeated_modes[0], self._repeated_modes[-1]
        truncation = Truncation(modes, list(own), solid.layer, tolerance, envelope, ALIASES, sliding)

        def choose(depth: float) -> PlaneGrid:
            found = truncation.choose(depth, all_columns=True)
            return PlaneGrid(own[found.grid], found.bound, 0.0, 0)

        self.choose = choose

    @cached_property
    def _repeated_modes(self) -> list[Array]:
        """Coefficients of the pressures in the cell of coarse planes."""
        return self._forward(_repeated(self._grid))

    @cached_property
    def _padded(self) -> tuple[Grid, list[Array]]:
        """Cell in which the map is convolved on its own grid, and the coefficients of the pressures there."""
        cell = padded_grid(self._grid)
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
        cell, source = _repeated(grid), _repeated(self._grid)
        modes = [resample(own, source, cell) for own in self._repeated_modes]
        for axis, wavenumber in ((0, cell.qy[:, None]), (1, cell.qx[None, :])):
            fine, coarse = (np.sinc(wavenumber * own.spacing[axis] / (2 * np.pi)) for own in (source, cell))
            for each in modes:
                each *= fine / coarse
        return cell, modes, np.outer(_taper(cell, grid, 0), _taper(cell, grid, 1))

    def _influence(
        self, field: BasisField, depth: float, cell: Grid, load: tuple[float, float, float]
    ) -> Array:
        """The basis field around one loaded pixel, in the order of a cyclic convolution."""
        y, x = (step * np.arange(n // 2 + 1) for step, n in zip(cell.spacing, cell.shape, strict=True))
        total = np.zeros(cell.shape)
        for loaded, share in zip("zxy", load, strict=True):
            if share:
                a, b = rectangle_stress(field.component, loaded, y, x, float(depth), cell.spacing)
                # Reversing y or x changes the sign once for each such letter in component and load.
                sign_y, sign_x = ((-1.0) ** (field.component + loaded).count(letter) for letter in "yx")
                quarter = share * (field.constant * a + field.slope * b)
                half = np.concatenate([quarter, sign_y * quarter[(cell.shape[0] - 1) // 2 : 0 : -1]], axis=0)
                right = sign_x * half[:, (cell.shape[1] - 1) // 2 : 0 : -1]
                total += np.concatenate([half, right], axis=1)
        return total


def _repeated(grid: Grid) -> Grid:
    """The cell of coarse planes with the spacing of a grid of the map."""
    return Grid(
        (PADDING * grid.shape[0], PADDING * grid.shape[1]),
        (PADDING * grid.length[0], PADDING * grid.length[1]),
    )


def _taper(cell: Grid, grid: Grid, axis: int) -> Array:
    """Factor of the influence along one axis: 1 up to the length of the map, then falling to 0."""
    nodes, length = cell.shape[axis], grid.length[axis]
    place = np.arange(nodes)
    distance = np.minimum(place, nodes - place) * cell.spacing[axis]
    width = (PADDING / 2 - 1) * length
    fall = 0.5 * scipy.special.erfc(TAPER_STEEPNESS * (2 * (distance - length) / width - 1))
    return np.where(distance <= length, 1.0, fall)
