"""Partial slip: a tangential force below the friction limit on two bodies that are pressed together.

Coulomb's law lets the faces slip where the shear traction is μ p, and they stick elsewhere. If the tangential
compliance is everywhere the same multiple r of the normal one, the traction under a force Q that has grown
under a constant load P is the difference of two pressures without friction,

    q = μ (p(P) − p(P − Q/μ)),    Δ = μ r (δ(P) − δ(P − Q/μ)),

with the tangential displacement Δ of the bodies and the approach δ (M. Ciavarella, J. Mech. Phys. Solids 46
(1998) 2349, DOI 10.1016/S0022-5096(98)00024-X; J. Jäger, Arch. Appl. Mech. 68 (1998) 493): the faces stick
where they touch under the smaller load. The slip is μ r times the gap g* under that load. In a cycle between
−Q and Q every node slips there and back by twice this slip against μ p: the energy lost in a cycle is
therefore 4 μ² r ∫ p g* dA, without the difference of large numbers that gives the area of the loop.

What is neglected
-----------------
The compliance of a half-space for a traction along its wave equals the compliance for a pressure, and for a
traction across its wave is 1/(1 − ν) times as large. The superposition is exact for waves all along or all
across the force (a line contact), for ν = 0, and in the stick zone of circles and ellipses; r is the energy
of the pressure distribution applied as a shear traction, over the energy of the pressure itself; for a circle
it is Mindlin's (2 − ν)/(2 − 2ν). In other contacts the displacements of the nodes that stick should be equal
but are not, and `PartialSlip.deviation` measures the difference. The change of the pressure by the shear
traction is neglected as in gross sliding, see `asperity.elasticity.two_bodies.sliding_coupling`.

Mirrored maps
-------------
The traction has the same direction on a mirrored map and on its mirror images, so that displacements along
it and across it are not even. They are computed on the whole cell of four images, and averaged over it.
Pressure, traction, slip and energy are even, and given on the map.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
import xarray as xr

from asperity.contact.contact_nodes import dot
from asperity.contact.solution import Contact
from asperity.contact.solve import solve_contact
from asperity.core.arguments import magnitude, number, whole_number
from asperity.core.errors import shown
from asperity.core.types import Array
from asperity.elasticity.loaded_rectangle import PaddedFourier, shear_modes
from asperity.elasticity.loaded_solid import LoadedSolid, degrees_of
from asperity.elasticity.two_bodies import TwoBodies
from asperity.fourier.grid import BOUNDARIES, Fourier, with_mirror_images

ALL_SLIPS = "where all slips"
"""End of the message on a tangential displacement beyond which the bodies slide."""


@dataclass(frozen=True, eq=False, repr=False)
class PartialSlip:
    """Two bodies under a constant load and a tangential force that has grown once from zero.

    Attributes
    ----------
    contact : Contact
        Under the load.
    sticking : Contact
        Under the part of the load that is above the tangential force over the friction: its nodes stick.
    friction : float
        Coefficient μ.
    sliding_direction : "x", "y" or float
        Direction of the force on the lower body; a number is an angle in degrees from x towards y.
    """

    contact: Contact
    sticking: Contact
    friction: float
    sliding_direction: str | float = "x"

    def __repr__(self) -> str:
        share = self.tangential_force / (self.friction * self.contact.force) if self.contact.force else 0.0
        return (
            f"<PartialSlip: {100 * share:.2g} % of the limit, sticking {self.sticking_area:.4g} of the "
            f"contact, displacement {self.displacement:.4g}>"
        )

    @property
    def traction(self) -> Array:
        """Shear traction [y, x] in the direction of the force."""
        return self.friction * (self.contact.pressure - self.sticking.pressure)

    @property
    def tangential_force(self) -> float:
        """Tangential force on the map."""
        return self.friction * (self.contact.force - self.sticking.force)

    @property
    def sticking_area(self) -> float:
        """Fraction of the real contact that sticks; NaN without contact."""
        area = self.contact.contact_area_fraction
        return self.sticking.contact_area_fraction / area if area else float("nan")

    @property
    def slip(self) -> Array:
        """Distance [y, x] by which the faces have slipped, zero where they stick or are not in contact."""
        slips = (self.contact.pressure > 0) & (self.sticking.pressure == 0)
        gap = np.maximum(self.sticking.gap, 0)
        return self.friction * self.compliance_ratio * np.where(slips, gap, 0)

    @cached_property
    def compliance_ratio(self) -> float:
        """Ratio r of the tangential to the normal compliance of the contact, without its uniform part."""
        contact = self.contact
        normal = contact.displacement - contact.solid.uniform_compliance() * contact.mean_pressure
        pressure, normal = (with_mirror_images(field, contact.grid) for field in (contact.pressure, normal))
        along, _ = _displaced(contact, pressure, self.sliding_direction)
        energy = dot(pressure.ravel(), normal.ravel())
        return dot(pressure.ravel(), along.ravel()) / energy if energy else float("nan")

    @property
    def _uniform(self) -> float:
        """Tangential displacement by the mean traction, beyond its part in the compliance ratio."""
        compliance = sum(float(body.tangential_compliance(0.0)[0]) for body in _bodies(self.contact))
        return compliance - self.compliance_ratio * self.contact.solid.uniform_compliance()

    @property
    def displacement(self) -> float:
        """Tangential displacement of the bodies, measured as the approach is."""
        pressure = self.contact.mean_pressure - self.sticking.mean_pressure
        approach = self.contact.approach - self.sticking.approach
        return self.friction * (self.compliance_ratio * approach + self._uniform * pressure)

    @property
    def stiffness(self) -> float:
        """Mean traction per tangential displacement as the force grows further, in stress per length."""
        return self._stiffness_of(self.sticking)

    @property
    def initial_stiffness(self) -> float:
        """The stiffness at the first tangential force, where all of the contact sticks."""
        return self._stiffness_of(self.contact)

    def _stiffness_of(self, contact: Contact) -> float:
        if not contact.stiffness:
            return 0.0
        compliance = self.compliance_ratio / contact.stiffness + self._uniform
        return 1 / compliance if compliance > 0 else np.inf

    @property
    def lost_energy_density(self) -> Array:
        """Energy per area [y, x] that a cycle between the force and its opposite turns into heat and wear."""
        return 4 * self.friction * self.contact.pressure * self.slip

    @property
    def lost_energy(self) -> float:
        """Energy that the map loses in a cycle between the tangential force and its opposite."""
        return float(self.lost_energy_density.mean(dtype=float)) * self.contact.grid.area

    @cached_property
    def deviation(self) -> float:
        """Root mean square deviation of the displacements of the sticking nodes from a common value.

        It is relative to the tangential displacement: the error of the superposition. NaN if none sticks.
        """
        grid, displacement = self.contact.grid, self.displacement
        sticks = with_mirror_images(self.sticking.pressure > 0, grid)
        if not sticks.any() or not displacement > 0:
            return float("nan")
        traction = with_mirror_images(self.traction, grid)
        along, across = _displaced(self.contact, traction, self.sliding_direction)
        uniform = sum(float(body.tangential_compliance(0.0)[0]) for body in _bodies(self.contact))
        along = along + uniform * traction.mean(dtype=float) - displacement
        return float(np.sqrt(np.mean(along[sticks] ** 2 + across[sticks] ** 2, dtype=float))) / displacement

    def cycle(self, steps: int = 8) -> xr.Dataset:
        """Tangential force and displacement in a cycle between the force and its opposite (G. Masing, 1926).

        Reversed loading follows the curve of first loading at twice its size, from the other end. Each
        step but the last solves one more contact.

        Parameters
        ----------
        steps : int
            Number of forces of the first loading.

        Returns
        -------
        dataset
            Along `state`, from the force to its opposite and back: ``tangential_force`` and
            ``tangential_displacement``; along `step`, of first loading, ``first_force`` and
            ``first_displacement``.
        """
        steps = whole_number("steps", steps, "a whole number ≥ 1", lambda count: count >= 1)
        loads = np.linspace(self.contact.mean_pressure, self.sticking.mean_pressure, steps + 1)
        between = [_under(self.contact, float(load)) for load in loads[1:-1]]
        states = [replace(self, sticking=each) for each in (self.contact, *between, self.sticking)]
        for state in states:  # one ratio, which is computed once
            state.__dict__["compliance_ratio"] = self.compliance_ratio
        first = np.array([(state.tangential_force, state.displacement) for state in states]).T
        back = first[:, -1:] - 2 * first
        closed = np.concatenate([back, -back[:, 1:]], axis=1)
        names = "tangential_force", "tangential_displacement", "first_force", "first_displacement"
        dimensions = "state", "state", "step", "step"
        values = zip(names, dimensions, (*closed, *first), strict=True)
        return xr.Dataset({name: (dimension, value) for name, dimension, value in values})

    def in_body(self, body: str) -> LoadedSolid:
        """One body under pressure and shear traction, for the stress inside it.

        It is computed with the friction, and in the lower body with the direction of this object; the
        traction on the upper body has the opposite direction: see
        `asperity.elasticity.loaded_solid.traction_direction`.

        Parameters
        ----------
        body : "lower" | "upper"

        Raises
        ------
        ValueError
            If there is no such body.
        """
        return replace(self.contact.in_body(body), sticking_pressure=self.sticking.pressure)


def partial_slip(
    contact: Contact,
    friction: float,
    *,
    tangential_force: float | None = None,
    tangential_displacement: float | None = None,
    sliding_direction: str | float = "x",
) -> PartialSlip:
    """Apply a tangential force to a contact with friction, by the solution of one more contact.

    The superposition of M. Ciavarella, J. Mech. Phys. Solids 46 (1998) 2349, and J. Jäger, Arch. Appl. Mech.
    68 (1998) 493.

    Parameters
    ----------
    contact : Contact
        Elastic. Its pressure stays.
    friction : float
        Coefficient μ of friction, from above 0 to 1000.
    tangential_force : float
        On the map, from 0 to μ times `asperity.Contact.force`, where all of it slips.
    tangential_displacement : float
        Displacement of the bodies instead of a force, on half-spaces. The displacement of periodic
        half-spaces is measured from the mean of their surfaces, as the approach is.
    sliding_direction : "x", "y" or float
        Direction of the force on the lower body; a number is an angle in degrees from x towards y.

    Returns
    -------
    PartialSlip
        With ``traction``, ``slip``, ``sticking_area``, ``displacement``, ``tangential_force``, ``stiffness``,
        ``lost_energy``, the error ``deviation``, the loop of a ``cycle()``, and ``in_body()`` for the stress.

    Raises
    ------
    ValueError, TypeError
        If an argument is out of range, the contact is plastic, or a layer bears no shear.
    ConvergenceError
        If the second contact does not converge.

    Examples
    --------
    A ball under half of the force at which it slides, which sticks within 0.5^(1/3) of its contact radius:

    >>> ball = asp.surface.add_sphere(np.zeros((64, 64)), 1.0, radius=10.0)
    >>> contact = asp.solve_contact(ball, asp.Solid(1.0, 0.3), force=2e-3, boundary="free")
    >>> slip = asp.contact.partial_slip(contact, friction=0.4, tangential_force=0.2 * contact.force)
    >>> print(f"{slip.sticking_area:.2f} of the contact sticks, exactly {0.5 ** (2 / 3):.2f}")
    0.64 of the contact sticks, exactly 0.63
    >>> round(slip.compliance_ratio, 4), round((2 - 0.3) / (2 - 0.6), 4)  # Mindlin's
    (1.2143, 1.2143)
    >>> stress = asp.analyse_stress(slip.in_body("lower"), friction=slip.friction, sliding_direction="x")
    """
    if not isinstance(contact, Contact):
        raise TypeError(f"contact = {shown(contact)}: a Contact is needed")
    friction = number("friction", friction, "a number above 0, at most 1000,", lambda mu: 0 < mu <= 1000)
    degrees_of(sliding_direction)
    for body in _bodies(contact):
        body.shear_kernels(1.0, 0.0)  # an error for a layer on a frictionless bottom, which has none
    if contact.adhesion is not None:
        raise ValueError("adhesion: a contact without adhesion is needed for partial slip")
    if contact.plastic_area:
        raise ValueError(
            f"hardness = {contact.hardness:.6g}: partial slip needs a contact without a hardness"
        )
    if (tangential_force is None) == (tangential_displacement is None):
        raise ValueError("exactly one of tangential_force and tangential_displacement is needed")
    slip = PartialSlip(contact, contact, friction, sliding_direction)
    if tangential_force is not None:
        limit = friction * contact.force
        accepted = f"a number from 0 to {limit:.6g}, friction times load,"
        force = number("tangential_force", tangential_force, accepted, lambda size: 0 <= size <= limit)
        pressure = contact.mean_pressure - force / friction / contact.grid.area
        sticks = pressure > contact.rtol * contact.mean_pressure  # beyond the error of the solver
        return replace(slip, sticking=_under(contact, pressure if sticks else 0.0))
    if contact.solid.uniform_compliance():
        raise ValueError(
            f"tangential_displacement = {shown(tangential_displacement)}: half-spaces are needed, "
            "tangential_force is accepted on layers"
        )
    displacement = magnitude("tangential_displacement", tangential_displacement)
    sticking = contact.approach - displacement / (friction * slip.compliance_ratio)
    lowest = float(contact.height.min())
    if not sticking >= lowest:
        limit = friction * slip.compliance_ratio * (contact.approach - lowest)
        raise ValueError(
            f"tangential_displacement = {displacement:.6g}: at most {limit:.6g} is needed, {ALL_SLIPS}"
        )
    return replace(slip, sticking=_under(contact, approach=sticking))


def _under(contact: Contact, mean_pressure: float | None = None, approach: float | None = None) -> Contact:
    """The contact under a smaller load."""
    if mean_pressure == contact.mean_pressure:
        return contact
    return solve_contact(
        contact.height,
        contact.solid,
        contact.grid,
        mean_pressure=mean_pressure,
        approach=approach,
        boundary=contact.boundary,
        rtol=contact.rtol,
        dtype=contact.height.dtype,
        initial=contact,
    )


def _bodies(contact: Contact) -> tuple:
    solid = contact.solid
    return (solid.lower, solid.upper) if isinstance(solid, TwoBodies) else (solid,)


def _displaced(contact: Contact, traction: Array, sliding_direction: str | float) -> tuple[Array, Array]:
    """Tangential displacement of the bodies by a shear traction, along it and across, without its mean.

    Traction and displacements are fields on the whole cell.
    """
    degrees, grid, traction = degrees_of(sliding_direction), contact.grid.whole_cell, traction.astype(float)
    if contact.boundary != "periodic":
        free = BOUNDARIES[contact.boundary]
        padded = PaddedFourier(grid, free=free)
        modes = padded.forward(traction)
        along, across = shear_modes(grid, _bodies(contact), degrees, free)
        return padded.inverse(along * modes), padded.inverse(across * modes)
    fourier, q = Fourier(grid), grid.half_wavenumber()[np.abs(grid.ky)]
    in_wave, beside = sum(body.tangential_compliance(q) for body in _bodies(contact))
    square = np.where(q > 0, q, 1.0) ** 2
    cosine, sine = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    yy, xx = grid.qy[:, None] ** 2 / square, grid.qx**2 / square
    yx = grid.odd_qy[:, None] * grid.odd_qx / square
    part = cosine**2 * xx + sine**2 * yy + 2 * sine * cosine * yx
    turned = sine * cosine * (xx - yy) + (sine**2 - cosine**2) * yx
    modes = fourier.forward(traction)
    modes[0, 0] = 0
    along = (part * in_wave + (1 - part) * beside) * modes
    return fourier.inverse(along), fourier.inverse((beside - in_wave) * turned * modes)
