"""Form of an indenter: a sphere or a cylinder under the roughness."""

from asperity.core.arguments import choice, magnitude, require_finite
from asperity.core.types import Array, ArrayLike
from asperity.fourier.grid import Grid
from asperity.surface.roughness import checked_heights

AXES = ("y", "x")


def add_sphere(
    height: ArrayLike,
    length: Grid | float | tuple[float, float],
    radius: float,
    *,
    radius_y: float | None = None,
) -> Array:
    """Height of a rough sphere: the paraboloid r²/(2R) is added to the lower face of the indenter.

    With `radius_y` it is the elliptic paraboloid x²/(2R) + y²/(2R_y). Its lowest
    point is in the middle between the first and the last node, on both axes.

    As in Hertz's theory the sphere is approximated by a paraboloid. The sphere itself is higher by about
    r⁴/(8R³): by 0.25 % of r²/(2R) at a distance of a tenth of the radius from its lowest point.

    Parameters
    ----------
    height : (ny, nx) array
        Roughness as a lower face measured upward, as `asperity.solve_contact` takes it; zeros for a smooth
        sphere.
    length : Grid, float or (length_y, length_x)
        Edges of the map, in the unit of the heights, or the grid that has them.
    radius : float
        Radius of curvature R.
    radius_y : float, optional
        Radius of curvature along y, if it differs from `radius`.

    Returns
    -------
    height : (ny, nx) array

    Raises
    ------
    TypeError, ValueError
        If an argument is of the wrong kind or out of range.

    Examples
    --------
    >>> ball = asp.surface.add_sphere(np.zeros((3, 3)), 3e-3, radius=0.05)  # 3 x 3 nodes, 1 mm apart
    >>> np.round(ball * 1e6, 3)  # µm
    array([[20., 10., 20.],
           [10.,  0., 10.],
           [20., 10., 20.]])
    """
    y, x = _from_middle(height, length)
    ratio = 1.0 if radius_y is None else magnitude("radius", radius) / magnitude("radius_y", radius_y)
    return _added("add_sphere", height, ratio * y[:, None] ** 2 + x**2, radius)


def add_cylinder(
    height: ArrayLike,
    length: Grid | float | tuple[float, float],
    radius: float,
    *,
    axis: str = "y",
) -> Array:
    """Height of a rough cylinder: the parabola s²/(2R) is added to the lower face of the indenter.

    s is the distance from the axis of the cylinder, which lies along y or x through the middle. Parameters,
    result and errors are otherwise as for `add_sphere`.

    Parameters
    ----------
    axis : "y" | "x"
        Direction of the axis, along which the cylinder does not curve.

    Returns
    -------
    (ny, nx) array
        Height of the lower face, in the unit of `height`.

    Examples
    --------
    >>> roller = asp.surface.add_cylinder(np.zeros((3, 5)), (2e-3, 4e-3), radius=0.1, axis="y")
    >>> np.round(roller * 1e6, 3)  # µm
    array([[12.8,  3.2,  0. ,  3.2, 12.8],
           [12.8,  3.2,  0. ,  3.2, 12.8],
           [12.8,  3.2,  0. ,  3.2, 12.8]])
    """
    choice("axis", axis, AXES)
    y, x = _from_middle(height, length)
    return _added("add_cylinder", height, (x if axis == "y" else y[:, None]) ** 2, radius)


def _added(function: str, height: ArrayLike, square: Array, radius: float) -> Array:
    """Add a parabola of a radius to the heights; `square` is the squared distance from its lowest point."""
    found = checked_heights(height) + square / (2 * magnitude("radius", radius))
    require_finite(function, {"height": found})
    return found


def _from_middle(height: ArrayLike, length: Grid | float | tuple[float, float]) -> tuple[Array, Array]:
    """Distances of the rows and columns of nodes from the middle."""
    y, x = Grid(checked_heights(height).shape, length).coordinates()  # type: ignore[arg-type]
    return y - 0.5 * y[-1], x - 0.5 * x[-1]
