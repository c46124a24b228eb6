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

import numpy as np

from asperity.core.types import Array


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
    constant, slope = (_under_pressure if loaded == "z" else _under_traction)(
        component, corner_y, corner_x, depth
    )
    return _alternating(constant), _alternating(slope)


def _under_pressure(component: str, y: Array, x: Array, z: float) -> tuple[Array, Array]:
    """Primitives of A and B under a pressure."""
    rho = np.sqrt(x**2 + y**2 + z**2)
    none = np.zeros((2, 2))
    if component in ("yy", "yz"):
        return _under_pressure(component.replace("y", "x"), x, y, z)
    v_xx, v_yy = (-x * y / (rho * (side**2 + z**2)) for side in (x, y))
    v_z = -np.arctan2(x * y, z * rho)
    if component == "zz":
        return v_z + z * (v_xx + v_yy), none
    if component == "xz":
        return -(z**2) * y / (rho * (x**2 + z**2)), none
    if component == "xy":
        chi_xy = np.log(z + rho)
        return -z / rho - chi_xy, 2 * chi_xy
    chi_xx = np.arctan2(x * y * (rho - z), x**2 * rho + y**2 * z)
    return -z * v_xx - chi_xx, 2 * v_z + 2 * chi_xx


def _under_traction(component: str, y: Array, x: Array, z: float) -> tuple[Array, Array]:
    """Primitives of A and B under a traction along x."""
    rho = np.sqrt(x**2 + y**2 + z**2)
    none = np.zeros((2, 2))
    if component == "yz":
        return z / rho, none
    if component == "xz":
        return np.arctan2(x * y, z * rho) - z * x * y / (rho * (x**2 + z**2)), none
    v_xz = -z * y / (rho * (x**2 + z**2))
    if component == "zz":
        return -z * v_xz, none
    v_x, v_y = (np.arcsinh(t / np.sqrt(s**2 + z**2)) for s, t in ((x, y), (y, x)))
    chi_xxy, chi_xyy = (s / (rho * (rho + z)) for s in (x, y))
    phi_xxy, phi_xyy = (-s / (z + rho) for s in (x, y))
    if component == "xy":
        return v_y - z * chi_xxy, 2 * phi_xxy
    if component == "yy":
        return -z * chi_xyy, 2 * v_x + 2 * phi_xyy
    return 2 * v_x + z * (chi_xyy + v_xz), 2 * v_x - 2 * (phi_xyy + v_x)


def _alternating(corners: Array) -> Array:
    """Sum over the four corners of each rectangle, over 2π."""
    rows = corners[1:] - corners[:-1]
    return (rows[:, 1:] - rows[:, :-1]) / (2 * np.pi)
