"""Stress in a half-space under a uniform pressure and shear traction on a rectangle, in closed form.

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
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from asperity.core.types import Array

EVEN, ODD = 1.0, -1.0


def parity(component: str, loaded: str) -> tuple[float, float]:
    """Signs with which a stress component changes when y and when x is reversed.

    Parameters
    ----------
    component : str
        One of `asperity.elasticity.layer.COMPONENTS`.
    loaded : "z", "x" or "y"
        Pressure, or traction along x or y.
    """
    letters = component + loaded
    return (
        ODD if letters.count("y") % 2 else EVEN,
        ODD if letters.count("x") % 2 else EVEN,
    )


def rectangle_stress(
    component: str, loaded: str, y: Array, x: Array, depth: float, edges: tuple[float, float]
) -> tuple[Array, Array]:
    """Basis fields A and B of the stress A + ν B at points of one plane under a unit load on a rectangle.

    Parameters
    ----------
    component : str
        One of `asperity.elasticity.layer.COMPONENTS`; z is upward, depth ≥ 0.
    loaded : "z", "x" or "y"
        Unit pressure (σ_zz = −1 on the rectangle), or unit traction along x or y (σ_xz = 1 or σ_yz = 1).
    y, x : (ny,), (nx,) arrays
        Equally spaced positions relative to the centre of the rectangle, one edge apart.
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
    corner_y = np.append(y - 0.5 * edges[0], y[-1] + 0.5 * edges[0])[:, None]
    corner_x = np.append(x - 0.5 * edges[1], x[-1] + 0.5 * edges[1])[None, :]
    corner = _Corner(corner_y, corner_x, depth)
    primitives = _PRESSURE if loaded == "z" else _TRACTION_X
    constant, slope = primitives[component](corner)
    return _alternating(constant), _alternating(slope)


class _Corner:
    """Primitives of the derivatives of the potentials at the corners of all rectangles."""

    def __init__(self, y: Array, x: Array, z: float) -> None:
        self.y, self.x, self.z = y, x, z
        self.rho = np.sqrt(x**2 + y**2 + z**2)

    @property
    def exchanged(self) -> _Corner:
        """The same with x and y exchanged."""
        return _Corner(self.x, self.y, self.z)

    def v_z(self) -> Array:
        return -np.arctan2(self.x * self.y, self.z * self.rho)

    def v_xx(self) -> Array:
        return -self.x * self.y / (self.rho * (self.x**2 + self.z**2))

    def v_xy(self) -> Array:
        return 1 / self.rho

    def v_xz(self) -> Array:
        return -self.z * self.y / (self.rho * (self.x**2 + self.z**2))

    def v_x(self) -> Array:
        return np.arcsinh(self.y / np.sqrt(self.x**2 + self.z**2))

    def chi_xx(self) -> Array:
        return np.arctan2(self.x * self.y * (self.rho - self.z), self.x**2 * self.rho + self.y**2 * self.z)

    def chi_xy(self) -> Array:
        return np.log(self.z + self.rho)

    def chi_xxy(self) -> Array:
        return self.x / (self.rho * (self.rho + self.z))

    def phi_xxy(self) -> Array:
        return -self.x / (self.rho + self.z)


Pair = tuple[Array, Array]
_NONE = np.zeros((1, 1))


def _pressure_xx(c: _Corner) -> Pair:
    return -c.z * c.v_xx() - c.chi_xx(), 2 * c.v_z() + 2 * c.chi_xx()


def _pressure_zz(c: _Corner) -> Pair:
    return c.v_z() + c.z * (c.v_xx() + c.exchanged.v_xx()), _NONE


def _pressure_xy(c: _Corner) -> Pair:
    return -c.z * c.v_xy() - c.chi_xy(), 2 * c.chi_xy()


def _traction_xx(c: _Corner) -> Pair:
    plane, swapped = c.v_x(), c.exchanged
    chi_xyy, phi_xyy = swapped.chi_xxy(), swapped.phi_xxy()
    return 2 * plane + c.z * (chi_xyy + c.v_xz()), 2 * plane - 2 * (phi_xyy + plane)


def _traction_yy(c: _Corner) -> Pair:
    swapped = c.exchanged
    return -c.z * swapped.chi_xxy(), 2 * c.v_x() + 2 * swapped.phi_xxy()


def _traction_xy(c: _Corner) -> Pair:
    return c.exchanged.v_x() - c.z * c.chi_xxy(), 2 * c.phi_xxy()


_PRESSURE: dict[str, Callable[[_Corner], Pair]] = {
    "xx": _pressure_xx,
    "yy": lambda c: _pressure_xx(c.exchanged),
    "zz": _pressure_zz,
    "yz": lambda c: (c.z * c.exchanged.v_xz(), _NONE),
    "xz": lambda c: (c.z * c.v_xz(), _NONE),
    "xy": _pressure_xy,
}
_TRACTION_X: dict[str, Callable[[_Corner], Pair]] = {
    "xx": _traction_xx,
    "yy": _traction_yy,
    "zz": lambda c: (-c.z * c.v_xz(), _NONE),
    "yz": lambda c: (c.z * c.v_xy(), _NONE),
    "xz": lambda c: (-c.v_z() + c.z * c.v_xx(), _NONE),
    "xy": _traction_xy,
}


def _alternating(corners: Array) -> Array:
    """Sum over the four corners of each rectangle, over 2π."""
    if corners is _NONE:
        return _NONE
    rows = corners[1:] - corners[:-1]
    return (rows[:, 1:] - rows[:, :-1]) / (2 * np.pi)
