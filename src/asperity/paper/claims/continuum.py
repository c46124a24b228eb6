"""Extrapolation of the numbers of claims to vanishing grid spacing, from the same surfaces on finer grids."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np
import xarray as xr

from asperity.core.types import Array
from asperity.paper.claims.numbers import Evidence, Fixed, Measure, MissingEvidenceError

ORDERS = (0.5, 2.0)
"""Smallest and largest order of convergence with which a limit is extrapolated."""


class Limit(NamedTuple):
    """A number at vanishing grid spacing.

    Parameters
    ----------
    values : array
        Mean over seeds on each grid, coarse to fine.
    limit : float
    error : float
        Of the limit: that of the extrapolation, and the standard error over seeds of what the extrapolation
        adds to the finest value.
    """

    values: Array
    limit: float
    error: float


def extrapolate(nodes: Sequence[float], values: Array) -> Limit:
    """Limit of a number as the grid is refined, by Richardson's extrapolation.

    The order is the one that the last three values show, limited to `ORDERS`; it is one with two values, or
    where the changes do not shrink. The error of the extrapolation is what it adds to the finest value.

    Parameters
    ----------
    nodes : (grids,) rising numbers
        Nodes on the shortest wavelength, each twice the one before.
    values : (seeds, grids) array
    """
    if len(nodes) < 2 or not np.allclose(np.diff(np.log2(nodes)), 1):
        raise ValueError(
            f"nodes = {list(nodes)!r}: two or more numbers, each twice the one before, are needed"
        )
    mean = values.mean(axis=0)
    last = mean[-1] - mean[-2]
    order = 1.0
    before = mean[-2] - mean[-3] if mean.size > 2 else 0.0
    if before and 0 < last / before < 1:
        order = float(np.clip(-np.log2(last / before), *ORDERS))
    gain = 1 / (2**order - 1)
    limit = mean[-1] + gain * last
    spread = 0.0
    if len(values) > 1:
        spread = float((values[:, -1] - values[:, -2]).std(ddof=1) / np.sqrt(len(values)) * gain)
    return Limit(mean, float(limit), float(np.hypot(gain * last, spread)))


def continuum(measure: Measure, finer: Mapping[float, Evidence]) -> Limit:
    """Number of a claim at vanishing grid spacing, over the seeds that all grids have.

    Parameters
    ----------
    measure : callable
        As of a `Claim`.
    finer : mapping
        Nodes on the shortest wavelength → evidence of the same surfaces on that grid
        (`asperity.paper.claims.sources.resolutions`).

    Raises
    ------
    MissingEvidenceError
        If the number needs other surfaces, or does not depend on random ones.
    """
    nodes = sorted(finer)
    if len(nodes) < 2:
        raise MissingEvidenceError("no surfaces that differ in their nodes alone")
    found = [measure(finer[n]) for n in nodes]
    random = [one for one in found if not isinstance(one, Fixed) and np.all(np.isfinite(one))]
    if len(random) < len(nodes):
        raise MissingEvidenceError("nothing that the grid changes")
    return extrapolate(nodes, np.stack(xr.align(*random, join="inner"), axis=1))
