"""Analysis of the stress in the whole solid in one stream of planes: peaks, depth profile, covariances.

A plane is computed, reduced and discarded: its fields are searched for peaks, and its von Mises stress gives
one point of the depth profile and the covariance of Eq. 22 with the reference plane, that of the largest von
Mises stress. The reference plane is known only when the stream has ended. The plane with the largest value so
far is kept, and the few planes above the final reference are computed again.

The condition of the uniform mode (`Layer.lateral`) adds a constant to σ_xx and σ_yy and changes nothing of
the contact. `analyse_lateral_conditions` analyses several conditions in the same stream.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import xarray as xr
from numpy.typing import ArrayLike

from asperity import accessor
from asperity.elasticity.layer import LATERALS
from asperity.engines import current_engine
from asperity.finite import require_finite
from asperity.spectral import Work
from asperity.stress.arguments import (
    FIELDS,
    boundary_of,
    checked_contact,
    checked_depths,
    checked_floor,
    checked_names,
    checked_nodes,
    checked_ratios,
    checked_sliding,
    checked_threads,
    checked_tolerance,
)
from asperity.stress.depths import depth_grid
from asperity.stress.linear_plane import LinearPlane
from asperity.stress.pressed import ContactLike, PressedSolid
from asperity.stress.selection import peak_dataset
from asperity.stress.stream_analysis import Settings, StreamAnalysis
from asperity.types import Progress

accessor.register()

QUANTITIES = ("pressure", *FIELDS)
"""Quantities whose peaks can be sought."""


def analyse_stress(
    contact: ContactLike,
    depths: ArrayLike | None = None,
    poisson: float | Sequence[float] | None = None,
    quantities: Sequence[str] = ("pressure", "von_mises", "xx", "zz", "xz"),
    *,
    tolerance: float = 1e-6,
    floor: float = 0.01,
    threads: int = 1,
    progress: Progress | None = None,
    work: Work | None = None,
    friction: float = 0.0,
    sliding_direction: str | float = "x",
    observe: Callable[[LinearPlane], None] | None = None,
) -> xr.Dataset:
    """Peaks, depth profile and covariances of the stress under a contact.

    Parameters
    ----------
    contact : object with ``pressure``, ``grid`` and ``layer``
        A `Contact`, or a `PressedSolid` with any finite pressure.
    depths : (planes,) array, optional
        Rising from 0, the surface; by default those of `depth_grid`, down to the bottom of the layer.
    poisson, tolerance, threads, work, friction, sliding_direction
        As for `stress_planes`.
    quantities : names
        Quantities whose peaks are sought: any field of `stress_planes`, above its 26 neighbours in the solid,
        and ``pressure``, above its 8 neighbours in the surface.
    floor : float
        Peaks below `floor` times the root mean square of σ_zz of their plane are left out: most of them
        are ripples of the interpolated pressure between the nodes, away from the contacts.
    progress : callable, optional
        Called as progress(done, total).
    observe : callable, optional
        Called with every plane of the stream, a `asperity.stress.linear_plane.LinearPlane`, from the surface
        downward, for numbers that are not in the result. It must not keep the plane.

    Returns
    -------
    dataset
        Stresses in the unit of the contact pressure. Along `peak`, one entry for each peak of each quantity
        and Poisson's ratio: `asperity.peaks` selects from them. Along `plane`, the mean and largest von Mises
        stress, and the covariance with the plane of the largest. Along `lag`, the covariance in that plane.
        The attribute ``effective_modulus`` is E* in the same unit, ``friction`` and ``sliding_direction`` are
        the arguments.

    Raises
    ------
    ValueError, TypeError
        If an argument is out of range.

    Examples
    --------
    >>> height = asp.self_affine((64, 64), 0.8, 0.5, 0.125, rms_height=1e-3, seed=1)
    >>> contact = asp.solve(height, asp.Layer(young=1.0, poisson=0.3), area_fraction=0.1)
    >>> stress = asp.analyse_stress(contact, poisson=[0.0, 0.3, 0.5], quantities=("von_mises", "zz"))
    >>> deepest = stress["largest_von_mises"].sel(poisson=0.3).argmax("plane")
    >>> bool(0 < stress["plane_depth"][deepest] < 0.05)  # the largest stress lies below the surface
    True
    >>> print(*stress["quantity"].values)
    von_mises zz
    """
    own = contact.layer.lateral
    return analyse_lateral_conditions(
        contact,
        (own,),
        depths,
        poisson,
        quantities,
        tolerance=tolerance,
        floor=floor,
        threads=threads,
        progress=progress,
        work=work,
        friction=friction,
        sliding_direction=sliding_direction,
        observe=observe,
    )[own]


def analyse_lateral_conditions(
    contact: ContactLike,
    laterals: Sequence[str],
    depths: ArrayLike | None = None,
    poisson: float | Sequence[float] | None = None,
    quantities: Sequence[str] = ("pressure", "von_mises", "xx", "zz", "xz"),
    *,
    tolerance: float = 1e-6,
    floor: float = 0.01,
    threads: int = 1,
    progress: Progress | None = None,
    work: Work | None = None,
    friction: float = 0.0,
    sliding_direction: str | float = "x",
    observe: Callable[[LinearPlane], None] | None = None,
) -> dict[str, xr.Dataset]:
    """The analysis of `analyse_stress` for several conditions of the uniform mode, in one stream of planes.

    Parameters
    ----------
    laterals : sequence of names
        Conditions as of `Layer.lateral`, among them that of the contact's layer.
    contact, depths, poisson, quantities, tolerance, floor, threads, progress, work
        As for `analyse_stress`.
    friction, sliding_direction, observe
        As for `analyse_stress`.

    Returns
    -------
    dict
        Condition → dataset as of `analyse_stress`.

    Raises
    ------
    ValueError, TypeError
        If an argument is out of range.
    """
    laterals = checked_names("laterals", laterals, LATERALS)
    if contact.layer.lateral not in laterals:
        raise ValueError(
            f"laterals = {list(laterals)!r}: {contact.layer.lateral!r}, the layer's, must be one of them"
        )
    pressure, _ = checked_contact(contact)
    if depths is None:
        depths = depth_grid(contact.grid, contact.layer.height)
    settings = Settings(
        depths=checked_depths(depths, contact),
        ratios=checked_ratios(poisson, contact.layer),
        quantities=checked_names("quantities", quantities, QUANTITIES),
        tolerance=checked_tolerance(tolerance),
        floor=checked_floor(floor),
        threads=checked_threads(threads),
        work=Work() if work is None else work,
        friction=friction,
        sliding_direction=sliding_direction,
    )
    checked_sliding(friction, sliding_direction, contact.layer)
    if settings.depths[0] != 0:
        raise ValueError(f"depths[0] = {settings.depths[0]:g}: 0, the surface, is needed")
    checked_nodes(contact.grid)
    analysis = StreamAnalysis(
        PressedSolid(pressure, contact.grid, contact.layer, boundary_of(contact)), settings, laterals
    )
    analysis.run(progress, observe)
    found = {lateral: _dataset(analysis, lateral) for lateral in laterals}
    for dataset in found.values():
        require_finite("analyse_stress", dataset.data_vars)
    return found


def _dataset(analysis: StreamAnalysis, lateral: str) -> xr.Dataset:
    """The dataset of a finished analysis under one condition of the uniform mode."""
    settings, contact, references = analysis.settings, analysis.contact, analysis.references
    fields = [analysis.field("von_mises", lateral, ratio) for ratio in settings.ratios]
    own = [analysis.von_mises.index(field) for field in fields]
    lag, in_plane = references.in_plane()
    profiles = ("poisson", "plane")
    variables = {
        "plane_points": ("plane", analysis.points),
        "mean_von_mises": (profiles, analysis.mean[own]),
        "largest_von_mises": (profiles, analysis.largest[own]),
        "covariance_depth": (profiles, references.covariance[own]),
        "covariance_plane": (("poisson", "lag"), in_plane[own]),
        "reference_depth": ("poisson", settings.depths[references.number[own]]),
    }
    coordinates = {
        "quantity": list(settings.quantities),
        "poisson": settings.ratios,
        "plane_depth": ("plane", settings.depths),
        "lag": lag,
    }
    found = peak_dataset(analysis.peaks(lateral), contact).assign(variables).assign_coords(coordinates)
    return found.assign_attrs(
        effective_modulus=contact.layer.effective_modulus,
        friction=float(settings.friction),
        sliding_direction=settings.sliding_direction,
        fft_engine=current_engine().description,
    )
