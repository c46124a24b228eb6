"""Numbers of the claims: statistics of random surfaces, and numbers from closed forms and finite elements.

The number of a statement of `paper.yaml` is a `Number` of random surfaces, one for each seed, or the function
of this module with the name of the statement. Numbers of random surfaces are the estimates at zero grid
spacing where there are such; two surfaces are compared seed by seed. The paper leaves choices open; an
*interpretation* takes one option of each (`asperity.paper.claims.sources.CHOICES`).
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, NamedTuple

import numpy as np
import xarray as xr

from asperity.elasticity.solid import Solid
from asperity.paper.claims.sources import SKEWED, role_of_delta

RESOLVED = 10
"""Smallest resolved radius of a circle of contact, in grid spacings."""

COARSE_GRID = 32
"""Nodes on an edge of the grid that suffice according to the paper."""

Options = Mapping[str, Any]
"""One interpretation of the paper: name of a choice → the option that is taken."""

_OF_MEAN_MODE = ("von_mises", "xx")
"""Quantities that the condition of the mean (q = 0) mode changes."""

_OF_STRESS = ("peak", "mean_depth", "depth_patch", "maximum", "decay")
"""Beginnings of the variables that describe a stress; without a quantity, the von Mises stress."""


class MissingEvidenceError(LookupError):
    """The configuration has no surface, or the study no dataset, for a claim."""


class FixedNumber(NamedTuple):
    """A number that does not depend on a random surface, and its numerical uncertainty."""

    value: float
    uncertainty: float = 0.0


class SeedNumbers(NamedTuple):
    """A number of each seed, along `seed`.

    Parameters
    ----------
    values : data array
        Estimates at zero grid spacing, or values on the grid where no correction is known.
    grid_errors : data array
        Absolute errors of the grid that remain after its correction; zero where no correction is known.
    on_grid : data array
        Values on the grid.
    """

    values: xr.DataArray
    grid_errors: xr.DataArray
    on_grid: xr.DataArray


@dataclass(frozen=True)
class Evidence:
    """Datasets from which the numbers of the claims are taken.

    Parameters
    ----------
    surfaces : mapping
        Role of a surface (`asperity.paper.claims.sources.roles`) → result of stage statistics.
    validation : mapping
        Name → dataset of stage validation.
    options : mapping
        The interpretation under which numbers are taken; choices that are left out have the study's own.
    """

    surfaces: Mapping[str, xr.Dataset]
    validation: Mapping[str, xr.Dataset] = field(default_factory=dict)
    options: Options = field(default_factory=dict)

    def under(self, options: Options) -> "Evidence":
        """The same evidence under an interpretation."""
        return replace(self, options=options)

    def statistics(self, role: str) -> xr.Dataset:
        """Statistics of the surface that has a role, under the interpretation's mean mode and δ."""
        delta = self.options.get("delta")
        if role in SKEWED and delta is not None:
            role = role_of_delta(role, delta)
        if role not in self.surfaces:
            raise MissingEvidenceError(f"no surface as {role}")
        found = self.surfaces[role]
        own = found.attrs["uniform_mode"].removeprefix("laterally ")
        lateral = self.options.get("lateral", own)
        if lateral not in (found["lateral"].values if "lateral" in found.dims else [own]):
            raise MissingEvidenceError(f"no stress under {role}, laterally {lateral}")
        return found.sel(lateral=lateral) if "lateral" in found.dims else found

    def dataset(self, name: str) -> xr.Dataset:
        """A dataset of the validation."""
        if name not in self.validation:
            raise MissingEvidenceError(f"no dataset {name}")
        return self.validation[name]


@dataclass(frozen=True)
class Number:
    """A variable of the statistics of one surface, or two of them compared.

    If `of`, `quantity` or `poisson` has two entries, the number is the value of the first over the value of
    the second. If it has no level, quantiles of peaks are compared by their Kolmogorov distance.

    Parameters
    ----------
    variable : str
        Of stage statistics, along `seed`, without ``seed_`` or ``continuum_`` before it.
    of : sequence of str
        Roles of surfaces.
    quantity : sequence of str
        Quantities whose peaks are counted.
    poisson : sequence of str
        ``"contact"``, ``"smallest"`` or ``"largest"``: the Poisson's ratios at which it is taken.
    level : float, optional
        Fraction of the peaks below a quantile.
    unscaled : bool
        Multiply by ḡ_r, the rms gradient over the real contact: stresses are then in units of E*.
    factor : float
    depends_on : sequence of str
        Choices of the interpretation on which the number depends besides ``lateral`` and ``delta``.
    """

    variable: str
    of: Sequence[str]
    quantity: Sequence[str] = ()
    poisson: Sequence[str] = ("contact",)
    level: float | None = None
    unscaled: bool = False
    factor: float = 1.0
    depends_on: Sequence[str] = ()

    @property
    def choices(self) -> tuple[str, ...]:
        """Choices on which the number depends."""
        stress = self.variable.startswith(_OF_STRESS)
        lateral = stress and (not self.quantity or set(self.quantity) & {*_OF_MEAN_MODE})
        skewed = set(self.of) & {*SKEWED}
        return (*(("lateral",) if lateral else ()), *self.depends_on, *(("delta",) if skewed else ()))

    def __call__(self, evidence: Evidence) -> SeedNumbers:
        """The number of each seed; the remaining errors of the grid in its terms are taken as independent."""
        count = max(len(self.of), len(self.quantity), len(self.poisson))
        on_grid, best, errors = zip(*(self._term(evidence, number) for number in range(count)), strict=True)
        values = self._combined(best)
        squares = xr.zeros_like(values)
        same = count == 2 and best[0].identical(best[1])
        for number, error in enumerate(() if same else errors):
            up, down = (
                abs(self._combined([*best[:number], best[number] * factor, *best[number + 1 :]]) - values)
                for factor in (1 + error, 1 - error)
            )
            squares += np.maximum(up, down) ** 2
        return SeedNumbers(values, squares**0.5, self._combined(on_grid))

    def _combined(self, terms: Sequence[xr.DataArray]) -> xr.DataArray:
        """The number of each seed from its first term, and its second if it has one."""
        if len(terms) == 1:
            return self.factor * terms[0]
        if "level" in terms[0].dims:
            return _kolmogorov(*terms)
        return self.factor * terms[0] / terms[1]

    def _term(self, evidence: Evidence, number: int) -> tuple[xr.DataArray, xr.DataArray, xr.DataArray]:
        """The first or the second term: on the grid, its best value, and the relative error of the latter."""
        options = {name: evidence.options[name] for name in self.depends_on if name in evidence.options}
        statistics = evidence.statistics(self.of[number % len(self.of)])
        variable, chosen = self.variable, {}
        if (patches := options.get("patches", "every_peak")) != "every_peak":
            variable, chosen["patches"] = "patch_correlation", patches
        if self.quantity:
            quantity = self.quantity[number % len(self.quantity)]
            quantity = options.get("shear", quantity) if quantity == "xz" else quantity
            if quantity not in statistics["quantity"].values:
                raise MissingEvidenceError(f"no peaks of quantity = {quantity}")
            chosen["quantity"] = quantity
        if self.level is not None:
            chosen["level"] = self.level
        if "poisson" in statistics[f"seed_{variable}"].dims:
            ratios = statistics["poisson"].values
            ends = {"smallest": ratios.min(), "largest": ratios.max()}
            ends["contact"] = statistics.attrs["poisson_contact"]
            chosen["poisson"] = ends[self.poisson[number % len(self.poisson)]]
        on_grid, best, error = _kinds(statistics, variable, chosen)
        if self.unscaled or options.get("scaling") == "absolute":
            gradient, best_gradient, _ = _kinds(statistics, "gradient_rms_contact", {})
            on_grid, best = on_grid * gradient, best * best_gradient
        return on_grid, best, error


def _kinds(
    statistics: xr.Dataset, variable: str, chosen: Mapping[str, Any]
) -> tuple[xr.DataArray, xr.DataArray, xr.DataArray]:
    """A variable on the grid, its estimate at zero spacing, and the relative error of the estimate.

    Where there is no estimate, the value on the grid is used in its place, with no error.
    """
    on_grid = statistics[f"seed_{variable}"].sel(chosen).reset_coords(drop=True)
    if (continuum := statistics.get(f"continuum_{variable}")) is None:
        return on_grid, on_grid, xr.zeros_like(on_grid)
    chosen_of = continuum.sel(chosen)
    best, error = (chosen_of.sel(kind=kind).reset_coords(drop=True) for kind in ("estimate", "error"))
    return on_grid, best.fillna(on_grid), error.fillna(0)


Measure = Callable[[Evidence], SeedNumbers | FixedNumber]
"""Takes the number of a claim from the evidence: one for each seed, or one for all.

Raises `MissingEvidenceError` if the evidence lacks a surface or a dataset."""


def _kolmogorov(one: xr.DataArray, other: xr.DataArray) -> xr.DataArray:
    """Largest difference between the fractions of peaks below a value, for each seed, from their quantiles.

    Only values above the smallest peak of both are compared, because a grid finds no smaller peaks. The
    distance is smaller than the distance of all peaks, by at most 0.0025 for ten thousand of them
    (`paper/supplement/claims.md`).
    """
    one, other = (found.transpose("seed", "level") for found in xr.align(one, other, join="inner"))
    levels, distances = one["level"].values, []
    for curves in zip(one.values, other.values, strict=True):
        rising = [np.maximum.accumulate(curve) for curve in curves]
        last = [np.append(np.diff(curve) > 0, True) for curve in rising]  # of equal quantiles
        values = np.concatenate(rising)
        values = values[values > max(curve[0] for curve in rising)]
        each = zip(rising, last, strict=True)
        shares = [np.interp(values, curve[some], levels[some], left=0.0) for curve, some in each]
        distances.append(np.abs(shares[0] - shares[1]).max(initial=0.0))
    return xr.DataArray(distances, coords={"seed": one["seed"]})


def hertz_area(evidence: Evidence) -> FixedNumber:
    """Largest relative error of the contact radius at given load, where the contact is resolved."""
    found = evidence.dataset("load_area")
    resolved = found.hertz_contact_radius * found.attrs["grid_points"] >= RESOLVED
    error = np.abs(found.solved_contact_radius / found.hertz_contact_radius - 1)
    return FixedNumber(float(error.where(resolved).max()))


def stiffness_of_poisson(evidence: Evidence) -> FixedNumber:
    """Load over area at the largest ν over the same at the smallest ν, the smallest of all loads."""
    found = evidence.dataset("load_area").sortby("poisson")
    slope = found.imposed_mean_pressure_young / found.solved_contact_area_fraction
    return FixedNumber(float((slope[-1] / slope[0]).min()))


def tractions_of_poisson(evidence: Evidence) -> FixedNumber:
    """Largest relative change of the area with Poisson's ratio at given load over E*."""
    area = evidence.dataset("load_area").solved_contact_area_fraction
    return FixedNumber(float((area.max("poisson") / area.min("poisson") - 1).max()))


def slab_stiffer_at_depth(evidence: Evidence) -> FixedNumber:
    """Load of a slab over the half-space's at the same approach, the smallest over heights."""
    return FixedNumber(float(evidence.dataset("slab_load_area").slab_stiffening.min()))


def slab_stiffer_at_area(evidence: Evidence) -> FixedNumber:
    """Load of the cubic slab over the load of the half-space at the same, largest, area of contact.

    The load is proportional to the cube of the radius, whose relative error is taken from the half-space.
    """
    found = evidence.dataset("slab_load_area")
    cubic = found.isel(slab=int(np.abs(found.slab_height.values - 1).argmin()), step=-1)
    area = np.pi * float(cubic.slab_contact_radius) ** 2
    half_space = float(np.interp(area, found.curve_contact_area_fraction, found.curve_mean_pressure))
    value = float(cubic.slab_mean_pressure) / half_space
    return FixedNumber(value, 3 * value * hertz_area(evidence).value)


def slab_tractions_of_poisson(evidence: Evidence) -> FixedNumber:
    """Largest change with ν of E* × compliance of a bonded cubic slab, over waves that fit in the cell."""
    q = 2 * np.pi * np.sqrt(np.arange(1.0, 4096.0))
    ratios = (0.0, 0.25, 0.33, 0.5)
    layers = [Solid(1 - nu**2, nu, height=1.0, bottom="bonded") for nu in ratios]
    compliance = np.array([layer.surface_compliance(q) for layer in layers])
    return FixedNumber(float((compliance.max(axis=0) / compliance.min(axis=0) - 1).max()))


def coarse_grid(evidence: Evidence) -> FixedNumber:
    """Relative error of the load at given approach on a grid of 32 × 32 nodes."""
    found = evidence.dataset("grid_convergence")
    if COARSE_GRID not in found.grid_points:
        raise MissingEvidenceError(f"no grid of {COARSE_GRID} × {COARSE_GRID}")
    return FixedNumber(float(found.slab_load_error.sel(grid_points=COARSE_GRID)))


def punch_of_poisson(evidence: Evidence) -> FixedNumber:
    """Maximum von Mises stress under a punch at the smallest ν over the same at the largest ν.

    Uncertain by the difference to the closed form.
    """
    found = evidence.dataset("punch").sortby("poisson")
    peak, exact = found.peak_von_mises_array.values, found.peak_von_mises_closed_form.values
    return FixedNumber(float(peak[0] / peak[-1]), float(abs(peak[0] / peak[-1] - exact[0] / exact[-1])))


def _element_difference(fields: Sequence[str], where: Sequence[str]) -> Measure:
    """Largest difference of fields to the finite elements; uncertain by the change over the last two meshes.

    `where` holds ``"edge"``, near the edge of contact, ``"away"``, farther away, or both.
    """

    def measure(evidence: Evidence) -> FixedNumber:
        found = evidence.dataset("elements").sel(field=[*fields])
        coarser, value = np.max([found[f"difference_{part}"].max("field") for part in where], axis=0)[-2:]
        return FixedNumber(float(value), float(abs(value - coarser)))

    return measure


def elements_at_edge(evidence: Evidence) -> FixedNumber:
    """Largest difference to the finite elements near the edge of contact over the largest farther away."""
    found = evidence.dataset("elements").isel(mesh=-1)
    return FixedNumber(float(found.difference_edge.max() / found.difference_away.max()))


_NORMAL, _LATERAL = ("displacement_z", "stress_zz"), ("stress_xx", "stress_xz")

elements_normal = _element_difference(_NORMAL, ("away", "edge"))
elements_lateral = _element_difference(_LATERAL, ("away", "edge"))
elements_away = _element_difference((*_NORMAL, *_LATERAL), ("away",))
