"""Local maxima in a plane and in a stream of planes, refined between the nodes.

Neighbours
----------
A node of a plane has the 8 nodes around it, and in each of the two adjacent planes the 9 values at the same
lateral positions: 26 in all. If an adjacent plane has another grid, the values there are interpolated (six
nodes along each axis). A peak is larger than all its neighbours. Of adjacent nodes of a plane with the same
value, such as the two that face each other across the mirror of a mirrored map, the upper and then the left
one counts as larger: which of them is the peak, or whether one is, does not hang on rounding. In the surface,
the plane at depth 0, there are no neighbours above. Any other first plane and the last plane have no peaks.
Over a periodic boundary, a node at an edge has neighbours at the opposite edge. Over a free boundary it has
none across its edge.

Where the grid changes between two planes, each plane compares on its own nodes, so that both or neither could
claim a peak between them. There, two maxima that face each other (within a spacing of the coarser grid) are
decided between themselves: the one with the larger refined in-plane value is kept.

A quadratic through the 27 values gives position and value of the peak between the nodes (in the surface,
through the 9 values of the plane). Peaks of a signed field are those of its magnitude; the value keeps the
sign.
"""

from __future__ import annotations

from collections.abc import Iterable

from asperity.arguments import finite_array
from asperity.finite import require_finite
from asperity.spectral import Grid
from asperity.stress.arguments import (
    BOUNDARIES,
    checked_field,
    checked_floor,
    checked_name,
    checked_nodes,
    checked_ratio,
)
from asperity.stress.peak_finder import PeakFinder
from asperity.stress.plane_maxima import SearchedPlane, plane_maxima
from asperity.stress.planes import StressPlane
from asperity.stress.refinement import Neighbourhoods, Peaks, peaks_of
from asperity.types import Array


def plane_peaks(field: Array, grid: Grid, floor: float = 0.0, boundary: str = "periodic") -> Peaks:
    """Maxima of |field| above their 8 neighbours in a plane; of equal neighbours the first one counts.

    Parameters
    ----------
    field : (ny, nx) array
    grid : Grid
        With at least three nodes on each axis.
    floor : float
        Maxima of a magnitude at or below it are left out.
    boundary : "periodic" | "free"
        The plane repeats sideways, or has no neighbours across its edges.

    Returns
    -------
    Peaks
        At depth 0, refined in the plane.

    Raises
    ------
    ValueError
        If the field does not have the shape of the grid or is not finite, or `floor` is negative.

    Examples
    --------
    >>> grid = asp.Grid((32, 32))
    >>> y, x = grid.coordinates()
    >>> wave = np.cos(2 * np.pi * (x - 0.3)) * np.cos(2 * np.pi * (y[:, None] - 0.4))
    >>> peaks = asp.plane_peaks(wave, grid)
    >>> for value, y, x in zip(peaks.value, peaks.y, peaks.x):
    ...     print(f"{value:+.2f} at y = {y:.2f}, x = {x:.2f}")
    +1.00 at y = 0.40, x = 0.30
    -1.00 at y = 0.40, x = 0.80
    -1.00 at y = 0.90, x = 0.30
    +1.00 at y = 0.90, x = 0.80
    """
    checked_nodes(grid)
    field = checked_field("field", finite_array("field", field), grid)
    periodic = checked_name("boundary", boundary, BOUNDARIES) == "periodic"
    plane = SearchedPlane.of_field(0.0, grid, field, periodic)
    maxima = plane_maxima(plane, checked_floor(floor))
    here = maxima.here
    plane_found = Neighbourhoods(maxima.field, maxima.nodes, here, here, here, None, 0.0, grid)
    found = peaks_of([plane_found], periodic)
    require_finite("plane_peaks", vars(found))
    return found


def find_peaks(
    planes: Iterable[StressPlane],
    name: str,
    poisson: float | None = None,
    floor: float = 0.0,
    boundary: str = "periodic",
) -> Peaks:
    """Maxima of |field| above their 26 neighbours in a stream of planes.

    Parameters
    ----------
    planes : iterable of StressPlane
        Rising in depth, on any grids of one cell. Peaks in the surface are found if the first is at depth 0.
    name : str
        Name of a field of the planes.
    poisson : float, optional
        One of the Poisson's ratios of the planes, needed if they have several.
    floor : float
        Maxima of a magnitude at or below it are left out.
    boundary : "periodic" | "free"
        That of the contact.

    Raises
    ------
    ValueError
        If the planes do not have the field or the Poisson's ratio, do not rise in depth, or are not finite.

    Examples
    --------
    >>> height = asp.self_affine((64, 64), 0.8, 0.5, 0.125, rms_height=1e-3, seed=1)
    >>> contact = asp.solve(height, asp.Layer(young=1.0, poisson=0.3), area_fraction=0.1)
    >>> planes = asp.stress_planes(contact, np.linspace(0, 0.1, 21), fields=("largest_shear",))
    >>> peaks = asp.find_peaks(planes, "largest_shear", floor=0.1 * contact.max_pressure)
    >>> highest = peaks.value.argmax()
    >>> bool(0.25 < peaks.value[highest] / contact.max_pressure < 0.35)  # 0.31 under a ball
    True
    """
    finder = PeakFinder(checked_name("boundary", boundary, BOUNDARIES))
    floor = checked_floor(floor)
    for plane in planes:
        fields = plane.fields[checked_name("name", name, list(plane.fields))]
        ratio = plane.poisson.index(checked_ratio(poisson, plane.poisson))
        checked_nodes(plane.grid)
        finder.add(plane.depth, plane.grid, checked_field("field", fields[ratio], plane.grid), floor)
    found = finder.peaks()
    require_finite("find_peaks", vars(found))
    return found
