"""Estimates at zero grid spacing, from a second solution on half as many nodes.

The formulas are in `asperity.stress.statistics.extrapolation`.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import xarray as xr

from asperity.contact import Contact
from asperity.contact.half_grid import HALF_TOLERANCE, solve_on_half
from asperity.contact.solve import approach_of_full_contact
from asperity.core.types import FIELDS, Progress
from asperity.elasticity.loaded_solid import LoadedSolid
from asperity.stress.analysis import analyse_stress
from asperity.stress.extremes import Extremes
from asperity.stress.planes.planes import depth_grid
from asperity.stress.statistics.extrapolation import OnGrid, extrapolate, reason_against


@dataclass(frozen=True, eq=False)
class HalfGrid:
    """A contact solved again on half of the nodes along both edges, used for the stress in both bodies.

    Parameters
    ----------
    contact : Contact
    lost : float
        Fraction of the squared gradient of the surface that these nodes do not resolve.
    reason : str
        Reason why the grid allows no estimate; empty if it does.
    """

    contact: Contact
    lost: float
    reason: str


def continuum_limit(
    contact: Contact,
    stress: xr.Dataset | None = None,
    *,
    body: str = "lower",
    progress: Progress | None = None,
) -> xr.Dataset:
    """Area, slope, peaks and decay lengths at zero grid spacing, each with the error that remains.

    The contact is solved again on half as many nodes along both edges, under the same load, and its stress is
    analysed, at about a quarter of the cost of the contact and its stress.

    The area is corrected after V. A. Yastrebov, G. Anciaux and J.-F. Molinari (2017), doi
    10.1016/j.triboint.2017.04.023; ``paper/supplement/continuum.md`` describes the other corrections.

    Parameters
    ----------
    contact : Contact
        The limit belongs to the smooth, band-limited surface through its nodes.
    stress : dataset, optional
        Result of `analyse_stress` for this contact, or for one of its bodies. Without it, only numbers of the
        contact are estimated.
    body : "lower" | "upper"
        Body of the stress, if the contact has two.
    progress : callable, optional
        Called as progress(done, total).

    Returns
    -------
    dataset
        Along `kind`, the value ``on_grid`` and ``on_half`` of the nodes, the ``estimate`` at zero
        spacing, and the relative ``error`` of the estimate: ``contact_area_fraction``,
        ``gradient_rms_contact``, and ``proportionality`` κ_r, their product times the effective modulus over
        the mean pressure. With a stress, also along `quantity` and `poisson` the percentiles ``p90`` and
        ``p99`` of the peaks, the ``maximum`` one, and ``mean_depth`` and ``mean_depth_highest``, of all peaks
        and of the highest tenth; along `poisson` the ``decay_length_depth`` and ``decay_length_plane``, NaN
        if `stress` has no covariances. Stresses are in the unit of the contact pressure. Where the grid
        allows no estimate, it is NaN, and the attribute ``reason`` says why, or ``reason_of_stress`` if only
        the peaks have no estimate. ``least_error`` is the least relative error of the maximum von Mises
        stress by the departure of the surface from an isotropic Gaussian one. The attribute
        ``lost_gradient`` is the fraction of the squared gradient of the surface that half of the nodes do not
        resolve: a third or more if the roughness continues below the spacing. ``plastic_area`` is copied from
        the contact: at a hardness errors are larger, and depths and decay lengths have no estimate.

    Raises
    ------
    TypeError, ValueError
        If `contact` is no `Contact`, or `stress` no result of `analyse_stress`.

    Examples
    --------
    The area at eight nodes on the shortest wavelength is too large by a tenth of its value:

    >>> height = asp.self_affine((128, 128), 0.8, 1 / 4, 1 / 16, rms_height=1e-3, seed=1)
    >>> contact = asp.solve_contact(height, asp.Solid(young=1.0, poisson=0.33), contact_area_fraction=0.05)
    >>> area = asp.continuum_limit(contact)["contact_area_fraction"]
    >>> print(f"{float(area.sel(kind='on_grid')):.4f}, better {float(area.sel(kind='estimate')):.4f}")
    0.0500, better 0.0448
    """
    if not isinstance(contact, Contact):
        raise TypeError(f"contact = {type(contact).__name__}: a Contact is needed")
    if stress is not None and "peak_quantity" not in stress:
        raise ValueError("stress: a result of analyse_stress is needed, it has no peaks")
    half = solved_on_half(contact)
    if progress is not None:
        progress(0.2, 1.0)
    found = continuum_on_grids(contact, half, stress, body)
    if progress is not None:
        progress(1.0, 1.0)
    return found


def solved_on_half(contact: Contact) -> HalfGrid:
    """The contact on half of the nodes, under the same load, or with adhesion at the same approach."""
    reason = "the boundary is free, and the estimate is made for periodic cells"
    if contact.boundary == "periodic":
        reason = reason_against(contact.pressure, contact.height, mirrored=bool(contact.grid.mirrored))
    hardness = contact.hardness if math.isfinite(contact.hardness) else None
    given = contact.height, contact.solid, contact.grid, contact.boundary
    load: dict[str, Any] = {"force": contact.force}
    if contact.adhesion is not None:
        reason = "the faces attract each other, and the estimate is made for contacts without adhesion"
        most = approach_of_full_contact(contact.height, contact.solid, contact.boundary)
        if contact.contact_area_fraction < 1 and contact.approach < most:
            load = {"approach": contact.approach}
    half, lost = solve_on_half(*given, **load, hardness=hardness, adhesion=contact.adhesion)
    return HalfGrid(half, lost, reason)


def continuum_on_grids(
    contact: Contact,
    half: HalfGrid,
    stress: xr.Dataset | None,
    body: str,
    loaded: LoadedSolid | None = None,
    extremes: Mapping[str, float] | None = None,
) -> xr.Dataset:
    """The result of `continuum_limit`, given the contact on half of the nodes, and the body under it.

    With the `extremes` of the stress, as of `Extremes.values`, also their ``extreme`` along `field`.
    """
    coarse = on_half = None
    if stress is not None:
        planes, interfaces = stress["plane_depth"].values, contact.in_body(body).layer.interfaces
        # Depths over the spacing are the same on both grids; in a thin coating planes lie closer.
        spacing = 0.5 if interfaces else planes[1] / min(contact.grid.spacing)
        solid = loaded or half.contact.in_body(body)
        sliding = {name: stress.attrs[name] for name in ("friction", "sliding_direction")}
        found = Extremes(solid.layer, [name for name in extremes or () if name in FIELDS])
        coarse = analyse_stress(
            solid,
            depth_grid(half.contact.grid, planes[-1], spacing, spacing / 4, interfaces),
            poisson=stress["poisson"].values.tolist(),
            quantities=[str(name) for name in stress["quantity"].values],
            tolerance=HALF_TOLERANCE,
            observe=None if extremes is None else found.add,
            covariances="covariance_plane" in stress,
            **sliding,
        )
        if extremes is not None:
            on_half = found.values(found.refined(solid, HALF_TOLERANCE, **sliding))
    both = _on_grid(contact, stress, extremes), _on_grid(half.contact, coarse, on_half)
    attributes = {"lost_gradient": half.lost, "plastic_area": contact.plastic_area}
    return extrapolate(*both, half.lost, half.reason).assign_attrs(attributes)


def _on_grid(
    contact: Contact, stress: xr.Dataset | None, extremes: Mapping[str, float] | None = None
) -> OnGrid:
    """Results of a contact and of the analysis of its stress."""
    load = contact.mean_pressure / contact.solid.effective_modulus
    plastic = contact.plastic_area > 0
    numbers = contact.pressure, load, contact.gradient_rms_contact, contact.grid
    return OnGrid(*numbers, stress, plastic, contact.height, extremes)
