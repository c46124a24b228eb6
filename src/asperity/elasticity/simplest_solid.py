"""The half-space in place of a layer: the difference of the two, and the choice between them.

A half-space is cheaper to compute than a layer and serves every Poisson's ratio at once. The field of a
pressure mode decays as e^(−q depth), so a layer that is tall against the longest wave differs little from the
half-space. The difference comes from the bottom: that of the stress is about e^(−q height) times a polynomial
of q height, that of the surface compliance the square of it, and both fall with q once q height is above 2.
Lower layers differ by more than any tolerance allows.

The mean (q = 0) mode is left out: its stress is the same in both solids, and its displacement only shifts
the approach.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from asperity.core.arguments import magnitude, number
from asperity.elasticity.layer import Layer

WAVENUMBERS, DEPTHS = np.geomspace(1, 8, 25)[:, None], np.linspace(0, 1, 41)
"""Wavenumbers over the smallest one, and depths over the height, at which the solids are compared."""


@dataclass(frozen=True)
class SolidChoice:
    """The simplest solid that a tolerance allows, and the reason for it.

    Attributes
    ----------
    layer : Layer
        The layer asked about, or the half-space of the same material.
    difference : float
        Largest relative difference between the surface compliances of layer and half-space, or between any
        stress component of both at any depth, relative to the pressure amplitude of the mode, if that is
        larger; 0 for a half-space.
    reason : str
        One sentence for the record of a result.
    """

    layer: Layer
    difference: float
    reason: str


def simplest_solid(layer: Layer, q_min: float, tolerance: float) -> SolidChoice:
    """The half-space if it differs from the layer by at most the tolerance for all q ≥ q_min; else the layer.

    Parameters
    ----------
    layer : Layer
    q_min : float
        Smallest wavenumber of the pressure: 2π over the longer edge of the cell.
    tolerance : float
        Largest accepted difference.

    Returns
    -------
    SolidChoice
        A coating, and a layer with a free bottom, is always kept.

    Raises
    ------
    TypeError, ValueError
        If q_min is not from 1e-75 to 1e75, or the tolerance is not a finite number ≥ 0.
    """
    q_min = magnitude("q_min", q_min)
    tolerance = number("tolerance", tolerance, "a finite number ≥ 0", lambda size: size >= 0)
    if layer.height is None:
        return SolidChoice(layer, 0.0, "the half-space was asked for")
    if layer.base is not None:
        return SolidChoice(layer, np.inf, "a coating was asked for")
    if layer.bottom == "free":
        return SolidChoice(layer, np.inf, "a free layer has no support")
    half_space, q = replace(layer, height=None), q_min * WAVENUMBERS
    compliance = float(np.abs(layer.surface_compliance(q) / half_space.surface_compliance(q) - 1).max())
    ours, theirs = (solid.kernels(q, DEPTHS * layer.height) for solid in (layer, half_space))
    normal, along, shear = (np.abs(a - b) for a, b in zip(ours[:3], theirs[:3], strict=True))
    across = layer.poisson * (ours.normal + ours.longitudinal - theirs.normal - theirs.longitudinal)
    stress = float(np.max([normal, along, shear, np.abs(across)]))
    differ = (
        f"for q·height ≥ {q_min * layer.height:.4g} the surface compliance of the layer and of the half-space"
        f" differ by at most {compliance:.2g} of its value, the stress by at most {stress:.2g} of a mode's"
        " pressure"
    )
    difference = max(compliance, stress)
    if difference > tolerance:
        return SolidChoice(layer, difference, f"layer: {differ}, beyond the tolerance {tolerance:g}")
    reason = f"half-space: {differ}, within the tolerance {tolerance:g}"
    return SolidChoice(half_space, difference, reason)
