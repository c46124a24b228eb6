"""The paper's equations of the elastic layer, as printed and corrected.

They serve to show which printed equations do not hold (`paper/supplement/method.md`) and how rounding
affects the corrected ones (`rounding.py`); the tensor that is right for every height is the library's,
`asperity.Solid.green_tensor`. ``corrected``: False gives the printed text literally, True the nearest form
that holds.

``lib`` is the arithmetic: ``mpmath.mp`` for any number of digits, ``numpy`` for floating point in the
precision of the arguments. Equations are numbered as in the paper. z is measured upward from the bottom.
"""

from collections.abc import Mapping
from typing import Any


def elastic_constants(young: Any, poisson: Any) -> tuple[Any, Any, Any]:
    """C11, C12 and C44 of an isotropic solid; C11 and C12 are infinite at ν = 1/2."""
    factor = young / ((1 + poisson) * (1 - 2 * poisson))
    return factor * (1 - poisson), factor * poisson, young / (2 * (1 + poisson))


def basis(lib: Any, qx: Any, qy: Any, z: Any, s: Any, corrected: bool = True) -> tuple[Any, Any]:
    """Matrix f of Eqs. 5 and 6, and its derivative along z, each as 3 rows of 6; s = C44/C11.

    The element f34 is not printed and counts as 0; it must equal f26.
    """
    q = lib.sqrt(qx * qx + qy * qy)
    sinh, cosh = lib.sinh(z * q), lib.cosh(z * q)
    r = (s - 1) / (s + 1)
    sinh_z, cosh_z = z * sinh, z * q * cosh
    sinh_slope, cosh_slope = sinh + cosh_z, q * cosh + z * q * q * sinh

    def of_component(along: Any, across: Any) -> list[tuple[Any, Any]]:
        """f11, f12, f15 and f16 with their derivatives; with x and y exchanged f23, f24, f25 and f26."""
        even = 2 * s / (s + 1) * cosh - r * along**2 * sinh_z / q
        even_slope = 2 * s / (s + 1) * q * sinh - r * along**2 * sinh_slope / q
        scale = (s + 1) * q**3
        odd = along**2 * ((s + 1) * sinh - (s - 1) * cosh_z) + 2 * across**2 * sinh
        odd_slope = along**2 * ((s + 1) * q * cosh - (s - 1) * cosh_slope) + 2 * across**2 * q * cosh
        lift = 1j * r * along
        upward = [(lift * (cosh_z - sinh) / q, lift * q * sinh_z), (lift * sinh_z / q, lift * sinh_slope / q)]
        return [(even, even_slope), (odd / scale, odd_slope / scale), *upward]

    f11, f12, f15, f16 = of_component(qx, qy)
    f23, f24, f25, f26 = of_component(qy, qx)
    f13 = -r * qx * qy * sinh_z / q, -r * qx * qy * sinh_slope / q
    f14 = r * qx * qy * (sinh - cosh_z) / q**3, -r * qx * qy * sinh_z / q
    f34 = f26 if corrected else (0 * f26[0], 0 * f26[1])
    f35 = r * q * sinh_z + 2 * cosh / (s + 1), r * q * sinh_slope + 2 * q * sinh / (s + 1)
    f36 = r * z * cosh + sinh / q, r * (cosh + z * q * sinh) + cosh
    rows = [[f11, f12, f13, f14, f15, f16], [f13, f14, f23, f24, f25, f26], [f15, f16, f25, f34, f35, f36]]
    values, slopes = ([[element[order] for element in row] for row in rows] for order in (0, 1))
    return values, slopes


def stress_rows(
    values: Any, slopes: Any, qx: Any, qy: Any, young: Any, poisson: Any, corrected: bool = True
) -> list[list[Any]]:
    """σ_zz, σ_yz and σ_zx of the six columns of `basis` by Eq. 7, as 3 rows of 6.

    In print the rows of σ_yz and σ_zx are exchanged.
    """
    c11, c12, c44 = elastic_constants(young, poisson)
    x, y = 1j * qx, 1j * qy
    zz, zx, yz = [], [], []
    for ux, uy, uz, ux1, uy1, uz1 in zip(*values, *slopes, strict=True):
        zz.append(c12 * (x * ux + y * uy) + c11 * uz1)
        zx.append(c44 * (ux1 + x * uz))
        yz.append(c44 * (uy1 + y * uz))
    return [zz, yz, zx] if corrected else [zz, zx, yz]


def compliance_elements(
    lib: Any, qx: Any, qy: Any, height: Any, young: Any, poisson: Any, corrected: bool = True
) -> dict[str, Any]:
    """The twelve elements of Eq. A.3 by their indices, ``"11"`` for G11.

    In print G11, G12 and G22 have (1 + e^2h)³ instead of (−1 + e^2h)³, the first bracket of G11 has q_r³
    instead of q_y² q_r, and the brackets of G33, G36, G16 and G26 stand under the root.
    """
    q = lib.sqrt(qx * qx + qy * qy)
    nu, zm, h = poisson, height, q * height
    sinh, cosh, double_sinh = lib.sinh(h), lib.cosh(h), lib.sinh(2 * h)
    coth, cosech = 1 / lib.tanh(h), 1 / sinh
    depth = zm * zm * q * q - sinh * sinh
    below = young * q**4 * depth
    cube = (lib.exp(2 * h) - 1) ** 3 if corrected else (lib.exp(2 * h) + 1) ** 3
    exponential = 8 * lib.exp(3 * h) * (1 + nu) / cube
    first = qy * qy if corrected else q * q

    def rooted(bracket: Any) -> Any:
        """Denominator q [bracket]; in print the bracket stands under the root."""
        return q * bracket if corrected else lib.sqrt(q * q * bracket)

    g11 = first * q * (-2 * qy * qy * zm * zm * coth + double_sinh)
    g11 = g11 + 2 * qx * qx * qy * qy * zm * (-1 + nu - q * zm * coth)
    g11 = g11 + 2 * (nu - 1) * zm * qx**4 + qx * qx * (1 - nu) * q * double_sinh
    g12 = coth * 2 * nu * sinh * sinh * q - coth * 2 * zm * zm * q**3 - 2 * zm * (nu - 1) * q * q
    g22 = -2 * zm * (nu - 1) * q * q * qy * qy + double_sinh * ((nu - 1) * qy * qy - qx * qx) * q
    g22 = g22 + 2 * zm * zm * coth * qx * qx * q**3
    g14 = 2 * q * (zm * zm * qy**4 - sinh * sinh * qy * qy)
    g14 = g14 + 2 * q * qx * qx * ((nu - 1) * sinh * sinh + zm * zm * qy * qy)
    g14 = g14 - zm * (nu - 1) * double_sinh * qx * qx * q * q
    g15 = -zm * (nu - 1) * double_sinh * q * q - 2 * (zm * zm * q * q - nu * sinh * sinh) * q
    g25 = -zm * (nu - 1) * coth * qy * qy * q + (zm * zm * cosech * cosech * q * q - 1) * qx * qx
    g25 = g25 + (nu - 1) * qy * qy
    elements = {
        "11": -exponential * sinh * g11 / (young * q**4 * (-1 + q * q * zm * zm * cosech * cosech)),
        "12": exponential * sinh**3 * qx * qy * g12 / below,
        "22": exponential * sinh**3 * g22 / below,
        "33": (nu * nu - 1) * (double_sinh + 2 * h) / (young * rooted(depth)),
        "14": lib.exp(h) * (nu + 1) * (coth - 1) * g14 / below,
        "15": lib.exp(-h) * (nu + 1) * (coth + 1) * qx * qy * g15 / below,
        "25": 2 * (nu + 1) * sinh * g25 / (young * q**3 * depth),
        "36": 2 * (nu * nu - 1) * (sinh + zm * cosh * q) / (young * rooted(depth)),
    }
    even = (2 * nu - 1) * sinh * sinh - zm * zm * q * q
    bracket = -2 * zm * zm * q * q + lib.cosh(2 * h) - 1
    for name, component in (("1", qx), ("2", qy)):
        elements[name + "3"] = -(nu + 1) * component * even / (young * q * q * depth)
        elements[name + "6"] = 4 * zm * (nu * nu - 1) * sinh * component / (young * rooted(bracket))
    return elements


def compliance(elements: Mapping[str, Any]) -> list[list[Any]]:
    """Rows of the 6 × 6 compliance of Eq. A.2, as printed, from its elements.

    Tractions are t = σ·n with the outward normal n on both faces. The entries (5, 4), (6, 4) and (6, 5) are
    misprints: `asperity.Solid.green_tensor` has G12, i G13 and i G23 there.
    """
    g = elements
    return [
        [g["11"], g["12"], 1j * g["13"], g["14"], g["15"], 1j * g["16"]],
        [g["12"], g["22"], 1j * g["23"], g["15"], g["25"], 1j * g["26"]],
        [-1j * g["13"], -1j * g["23"], g["33"], 1j * g["16"], 1j * g["26"], g["36"]],
        [g["14"], g["15"], -1j * g["16"], g["11"], g["12"], -1j * g["13"]],
        [g["15"], g["25"], -1j * g["26"], g["15"], g["22"], -1j * g["23"]],
        [-1j * g["16"], -1j * g["26"], g["36"], 1j * g["16"], 1j * g["26"], g["33"]],
    ]
