"""One Fourier mode of an elastic layer to any number of digits, from equilibrium and Hooke's law alone.

Equilibrium and Hooke's law of a mode exp(i (qx x + qy y)) are a first-order system in z,

    y' = A y,    y = (u_x, u_y, u_z, σ_xz, σ_yz, σ_zz),

whose matrix is finite for every −1 < ν ≤ 1/2. Its eigenvalues are +q and −q, three times each, and (A² −
q²)² = 0. The general solution is therefore a part that decays downward from the top and a part that decays
upward from the bottom, each an exponential times a linear function of z; six boundary conditions determine
both. Nothing is shared with `asperity.elasticity.solid`: no kernel, no compliance and no closed form.

Conventions of the package hold. Numbers are `mpmath` numbers; `digits` is the working precision, of
which a thin layer loses about four times the decimal logarithm of 1/(q · height).
"""

from typing import Any

import mpmath as mp
import numpy as np

from asperity.core.types import Array

_DISPLACEMENTS, _TRACTIONS = [0, 1, 2], [3, 4, 5]
_HELD = {"bonded": _DISPLACEMENTS, "frictionless": [3, 4, 2], "free": _TRACTIONS}
"""Components that each bottom prescribes."""


class StateSpace:
    """One Fourier mode of a layer or half-space; unless said otherwise under a unit pressure mode.

    All results are arrays of `mpmath` numbers.

    Parameters
    ----------
    qx, qy : float
        Components of the wavevector, not both zero.
    young, poisson : float
        Stresses are in the unit of `young`.
    height : float, optional
        Height of the layer; None for the half-space.
    bottom : "bonded" | "frictionless" | "free"
        No displacement; no normal displacement and no shear; no traction. Ignored for the half-space.
    digits : int
        Decimal digits of the arithmetic.
    """

    def __init__(
        self,
        qx: Any,
        qy: Any,
        young: Any,
        poisson: Any,
        height: Any = None,
        bottom: str = "bonded",
        digits: int = 80,
    ) -> None:
        self.bottom, self.digits = bottom, digits
        with mp.workdps(digits):
            self.qx, self.qy, self.young, self.poisson = map(mp.mpf, (qx, qy, young, poisson))
            self.height = None if height is None else mp.mpf(height)
            self.q = mp.sqrt(self.qx**2 + self.qy**2)
            self.system = self._system()
            self._bases = {sign: self._basis(sign) for sign in (1, -1)}
        self._amplitudes = self.solve([0, 0, -1])

    def _system(self) -> Array:
        """Matrix A of y' = A y."""
        nu = self.poisson
        shear = self.young / (2 * (1 + nu))
        ratio = nu / (1 - nu)
        plane = self.young / (1 - nu**2)
        x, y = 1j * self.qx, 1j * self.qy
        squeezed = (1 + nu) * (1 - 2 * nu) / (self.young * (1 - nu))
        mixed = -(x * y * (plane * nu + shear))
        along_x, along_y = -(x * x * plane + y * y * shear), -(y * y * plane + x * x * shear)
        # Hooke's law gives the derivatives of the displacements, equilibrium the derivatives of the
        # tractions: σ_xz' = −∂x σ_xx − ∂y σ_xy and so on, with σ_xx, σ_yy and σ_xy by Hooke's law.
        rows = [
            [0, 0, -x, 1 / shear, 0, 0],
            [0, 0, -y, 0, 1 / shear, 0],
            [-ratio * x, -ratio * y, 0, 0, 0, squeezed],
            [along_x, mixed, 0, 0, 0, -ratio * x],
            [mixed, along_y, 0, 0, 0, -ratio * y],
            [0, 0, 0, -x, -y, 0],
        ]
        return np.array(rows, object)

    def _basis(self, sign: int) -> Array:
        """Three independent states (6, 3) that vary as e^(sign q z) times a linear function of z."""
        eigenvalue = sign * self.q
        # Arrays are the left factors of products: a number of mpmath on the left converts the array to text.
        one = np.eye(6, dtype=object)
        up, down = self.system + one * eigenvalue, self.system - one * eigenvalue
        projector = up @ up @ (one / (4 * eigenvalue**2) - down / (4 * eigenvalue**3))
        # The projection has rank three. The projections of these three states are independent for every q.
        cosine, sine = self.qx / self.q, self.qy / self.q
        return projector[:, :3] @ np.array([[cosine, -sine, 0], [sine, cosine, 0], [0, 0, 1]], object)

    def _states(self, depth: Any) -> Array:
        """General solution at a depth as columns: three that decay downward, three that decay upward."""
        distances = {1: -mp.mpf(depth)}
        if self.height is not None:
            distances[-1] = self.height - mp.mpf(depth)
        columns = []
        for sign, distance in distances.items():
            eigenvalue, basis = sign * self.q, self._bases[sign]
            linear = basis + (self.system @ basis - basis * eigenvalue) * distance
            columns.append(linear * mp.exp(eigenvalue * distance))
        return np.hstack(columns)

    def solve(self, top: Any) -> Array:
        """Amplitudes of the general solution, (6,) or, for the half-space, (3,).

        Parameters
        ----------
        top : three numbers
            σ_xz, σ_yz, σ_zz at the top. The components that the bottom prescribes are zero.
        """
        with mp.workdps(self.digits):
            rows, values = self._states(0)[_TRACTIONS], list(top)
            if self.height is not None:
                rows = np.vstack([rows, self._states(self.height)[_HELD[self.bottom]]])
                values += [0, 0, 0]
            return np.array(list(mp.lu_solve(mp.matrix(rows.tolist()), mp.matrix(values))), object)

    def state(self, depth: Any, amplitudes: Array | None = None) -> Array:
        """State y = (u_x, u_y, u_z, σ_xz, σ_yz, σ_zz) at a depth, for the amplitudes of `solve`."""
        with mp.workdps(self.digits):
            return self._states(depth) @ (self._amplitudes if amplitudes is None else amplitudes)

    def displacement(self, depth: Any) -> Array:
        """u_x, u_y, u_z at a depth."""
        return self.state(depth)[_DISPLACEMENTS]

    def stress(self, depth: Any, amplitudes: Array | None = None) -> Array:
        """σ_xx, σ_yy, σ_zz, σ_yz, σ_xz, σ_xy at a depth, by Hooke's law, for the amplitudes of `solve`."""
        with mp.workdps(self.digits):
            ux, uy, _, xz, yz, zz = self.state(depth, amplitudes)
            nu = self.poisson
            plane, shear = self.young / (1 - nu**2), self.young / (2 * (1 + nu))
            strain_x, strain_y = 1j * self.qx * ux, 1j * self.qy * uy
            confined = nu / (1 - nu) * zz
            xx = plane * (strain_x + nu * strain_y) + confined
            yy = plane * (strain_y + nu * strain_x) + confined
            xy = shear * 1j * (self.qx * uy + self.qy * ux)
            return np.array([xx, yy, zz, yz, xz, xy], object)

    def compliance(self) -> Array:
        """Compliance of a layer with free faces, (6, 6): displacements of both faces per traction on both.

        Order: top x, y, z, bottom x, y, z. Tractions are t = σ·n with the outward normal n.
        """
        with mp.workdps(self.digits):
            top, bottom = self._states(0), self._states(self.height)
            tractions = np.vstack([top[_TRACTIONS], -bottom[_TRACTIONS]])
            inverse = mp.matrix(tractions.tolist()) ** -1
            displacements = np.vstack([top[_DISPLACEMENTS], bottom[_DISPLACEMENTS]])
            return displacements @ np.array(inverse.tolist(), object)
