"""One Fourier mode of an elastic layer to any number of digits, from equilibrium and Hooke's law alone.

Equilibrium and Hooke's law of a mode exp(i (qx x + qy y)) are a first-order system in z,

    y' = A y,    y = (u_x, u_y, u_z, σ_xz, σ_yz, σ_zz),

whose matrix is finite for every −1 < ν ≤ 1/2. Its eigenvalues are +q and −q, three times each, and (A² −
q²)² = 0. The general solution is therefore a part that decays downward from the top and a part that decays
upward from the bottom, each an exponential times a linear function of z; six boundary conditions determine
both. Nothing is shared with `asperity.elasticity.layer`: no kernel, no compliance and no closed form.

Conventions are those of the package. Numbers are `mpmath` numbers; `digits` is the working precision, of
which a thin layer loses about four times the decimal logarithm of 1/(q · height).
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import mpmath as mp

_TRACTIONS = (3, 4, 5)


@dataclass
class StateSpace:
    """One Fourier mode of a layer or half-space under a unit pressure mode.

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

    qx: Any
    qy: Any
    young: Any
    poisson: Any
    height: Any = None
    bottom: str = "bonded"
    digits: int = 80
    _amplitudes: Any = field(init=False, repr=False)

    def __post_init__(self) -> None:
        with mp.workdps(self.digits):
            self.qx, self.qy = mp.mpf(self.qx), mp.mpf(self.qy)
            self.young, self.poisson = mp.mpf(self.young), mp.mpf(self.poisson)
            self.q = mp.sqrt(self.qx**2 + self.qy**2)
            self.system = self._system()
            self._bases = {sign: self._basis(sign) for sign in (1, -1)}
            if self.height is not None:
                self.height = mp.mpf(self.height)
            self._amplitudes = self.solve([0, 0, -1])

    def _system(self) -> Any:
        """Matrix A of y' = A y."""
        nu = self.poisson
        shear = self.young / (2 * (1 + nu))
        ratio = nu / (1 - nu)
        plane = self.young / (1 - nu**2)
        x, y = 1j * self.qx, 1j * self.qy
        matrix = mp.zeros(6)
        # Hooke's law gives the derivatives of the displacements.
        matrix[0, 2], matrix[0, 3] = -x, 1 / shear
        matrix[1, 2], matrix[1, 4] = -y, 1 / shear
        matrix[2, 0], matrix[2, 1] = -ratio * x, -ratio * y
        matrix[2, 5] = (1 + nu) * (1 - 2 * nu) / (self.young * (1 - nu))
        # Equilibrium, σ_xz' = −∂x σ_xx − ∂y σ_xy and so on, with σ_xx, σ_yy and σ_xy by Hooke's law.
        matrix[3, 0] = -(x * x * plane + y * y * shear)
        matrix[3, 1] = -(x * y * (plane * nu + shear))
        matrix[3, 5] = -ratio * x
        matrix[4, 0] = matrix[3, 1]
        matrix[4, 1] = -(y * y * plane + x * x * shear)
        matrix[4, 5] = -ratio * y
        matrix[5, 3], matrix[5, 4] = -x, -y
        return matrix

    def _basis(self, sign: int) -> Any:
        """Three independent states (6, 3) that vary as e^(sign q z) times a linear function of z."""
        eigenvalue = sign * self.q
        one = mp.eye(6)
        up = self.system + eigenvalue * one
        down = self.system - eigenvalue * one
        projector = up * up * (one / (4 * eigenvalue**2) - down / (4 * eigenvalue**3))
        # The projection has rank three. The projections of these three states are independent for every q.
        along = mp.matrix([self.qx, self.qy]) / self.q
        states = mp.zeros(6, 3)
        states[0, 0], states[1, 0] = along[0], along[1]
        states[0, 1], states[1, 1] = -along[1], along[0]
        states[2, 2] = 1
        return projector * states

    def _propagate(self, sign: int, distance: Any) -> Any:
        """States of the basis, (6, 3), at a distance along z from the face where they equal the basis."""
        eigenvalue = sign * self.q
        basis = self._bases[sign]
        linear = basis + distance * (self.system * basis - eigenvalue * basis)
        return mp.exp(eigenvalue * distance) * linear

    def _states(self, depth: Any) -> Any:
        """General solution at a depth as columns: three that decay downward, three that decay upward."""
        depth = mp.mpf(depth)
        downward = self._propagate(1, -depth)
        if self.height is None:
            return downward
        upward = self._propagate(-1, self.height - depth)
        states = mp.zeros(6)
        states[:, 0:3], states[:, 3:6] = downward, upward
        return states

    def solve(self, top: Any, lower: Any = (0, 0, 0)) -> Any:
        """Amplitudes of the general solution under boundary conditions.

        Parameters
        ----------
        top : three numbers
            σ_xz, σ_yz, σ_zz at the top.
        lower : three numbers
            Values of what the bottom prescribes: u_x, u_y, u_z if bonded; σ_xz, σ_yz, u_z if frictionless;
            σ_xz, σ_yz, σ_zz if free.

        Returns
        -------
        (6,) or, for the half-space, (3,) matrix
        """
        with mp.workdps(self.digits):
            rows, values = self._rows(self._states(0), _TRACTIONS), list(top)
            if self.height is not None:
                prescribed = {"bonded": (0, 1, 2), "frictionless": (3, 4, 2), "free": _TRACTIONS}[self.bottom]
                bottom = self._rows(self._states(self.height), prescribed)
                whole = mp.zeros(6)
                whole[0:3, :], whole[3:6, :] = rows, bottom
                rows, values = whole, values + list(lower)
            return mp.lu_solve(rows, mp.matrix(values))

    @staticmethod
    def _rows(states: Any, numbers: tuple[int, ...]) -> Any:
        """Components `numbers` of states in columns."""
        chosen = mp.zeros(len(numbers), states.cols)
        for row, number in enumerate(numbers):
            chosen[row, :] = states[number, :]
        return chosen

    def state(self, depth: Any, amplitudes: Any = None) -> Any:
        """State y = (u_x, u_y, u_z, σ_xz, σ_yz, σ_zz) at a depth; by default under a unit pressure mode."""
        with mp.workdps(self.digits):
            return self._states(depth) * (self._amplitudes if amplitudes is None else amplitudes)

    def displacement(self, depth: Any) -> list[Any]:
        """u_x, u_y, u_z at a depth under a unit pressure mode."""
        return list(self.state(depth)[0:3])

    def stress(self, depth: Any) -> list[Any]:
        """σ_xx, σ_yy, σ_zz, σ_yz, σ_xz, σ_xy at a depth under a unit pressure mode."""
        with mp.workdps(self.digits):
            return self.stress_of(self.state(depth))

    def stress_of(self, state: Any) -> list[Any]:
        """σ_xx, σ_yy, σ_zz, σ_yz, σ_xz, σ_xy of a state, by Hooke's law."""
        nu = self.poisson
        plane = self.young / (1 - nu**2)
        ux, uy, _, xz, yz, zz = state
        strain_x, strain_y = 1j * self.qx * ux, 1j * self.qy * uy
        confined = nu / (1 - nu) * zz
        shear = self.young / (2 * (1 + nu)) * 1j * (self.qx * uy + self.qy * ux)
        return [
            plane * (strain_x + nu * strain_y) + confined,
            plane * (strain_y + nu * strain_x) + confined,
            zz,
            yz,
            xz,
            shear,
        ]

    def compliance(self) -> Any:
        """Compliance of a free layer, (6, 6): displacements of both faces per traction on both faces.

        Order: top x, y, z, bottom x, y, z. Tractions are t = σ·n with the outward normal n.

        Raises
        ------
        ValueError
            If the bottom is not free.
        """
        if self.height is None or self.bottom != "free":
            raise ValueError(f"bottom = {self.bottom!r}: the compliance of two faces needs a free layer")
        with mp.workdps(self.digits):
            top, bottom = self._states(0), self._states(self.height)
            tractions, displacements = mp.zeros(6), mp.zeros(6)
            tractions[0:3, :] = self._rows(top, _TRACTIONS)
            tractions[3:6, :] = -self._rows(bottom, _TRACTIONS)
            displacements[0:3, :] = self._rows(top, (0, 1, 2))
            displacements[3:6, :] = self._rows(bottom, (0, 1, 2))
            return displacements * tractions**-1
