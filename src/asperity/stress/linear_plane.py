"""The linear parts A and B of the stress in one plane, and the fields that follow from them."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from asperity.elasticity.layer import COMPONENTS
from asperity.spectral import Grid
from asperity.stress.arguments import MEASURES
from asperity.stress.fields import KINDS, SHARED, Field, Parts, fill_fields
from asperity.types import Array

_NORMAL = ("xx", "yy", "zz")

Gather = Callable[[Array], Array]
"""Takes values out of a field [y, x], the same places of every field."""


@dataclass(frozen=True)
class LinearPlane:
    """One plane of the stress as A + ν B, from which every field follows for every Poisson's ratio.

    Parameters
    ----------
    depth, grid, bound
        Of the plane, as in `asperity.stress.planes.StressPlane`.
    constant : dict
        Component → field A[y, x], in the unit of the contact pressure.
    slope : dict
        Component → field B[y, x]. Empty if ν is fixed; A is the stress itself then. If all components are
        there, B_yy is left out: it follows from A_xx + A_yy + A_zz = B_xx + B_yy but for the uniform mode.
    mean_pressure : float
        Of the cell.
    lateral : mapping of float to float
        Poisson's ratio → uniform part of σ_xx and σ_yy.
    done : float
        Share of the work of the whole stream that is done with this plane.
    values : (ny, parts, at least nx) array, optional
        One array that holds A and then B.
    scale : float
        The root mean square of σ_zz or less, as far as it is known before the plane is computed.

    Notes
    -----
    The arrays are used again: those of a plane hold the plane after the next when it is computed.
    """

    depth: float
    grid: Grid
    bound: float
    constant: dict[str, Array]
    slope: dict[str, Array]
    mean_pressure: float
    lateral: dict[float, float]
    done: float = 1.0
    values: Array | None = None
    scale: float = 0.0

    @property
    def dtype(self) -> np.dtype[Any]:
        """Precision of the fields."""
        return next(iter(self.constant.values())).dtype

    def parts(self) -> Parts:
        """The parts as the compiled functions take them."""
        arrays = [*self.constant.values(), *self.slope.values()]
        values = self.values
        if values is None:
            values = np.stack([array.reshape(-1, array.shape[-1]) for array in arrays], axis=1)
        slope = self.slope or self.constant
        own = {name: number for number, name in enumerate(self.constant)}
        slopes = {name: number + len(own) for number, name in enumerate(self.slope)} or own
        place = [own.get(name, -1) for name in COMPONENTS]
        place += [slopes.get(name, -1) for name in ("xx", "yy", "xy")]
        columns = next(iter(slope.values())).shape[-1]
        return Parts(values, np.array(place), columns, self.dtype.type(self.mean_pressure))

    def compiled(self, name: str, poisson: float) -> Field:
        """One field as the compiled functions take it."""
        real = self.dtype.type
        return Field(KINDS[name], real(poisson if self.slope else 0.0), real(self.lateral[poisson]))

    def field(self, name: str, poisson: float, out: Array | None = None) -> Array:
        """The field `name` for one Poisson's ratio, (ny, nx), written to `out` if it is given."""
        if out is None:
            out = np.empty(next(iter(self.constant.values())).shape, self.dtype)
        kind, ratio, uniform = self.compiled(name, poisson)
        ratios, uniforms = (np.array([value], self.dtype) for value in (ratio, uniform))
        rows = out.reshape(1, -1, out.shape[-1])
        shared = np.empty(SHARED, self.dtype)
        fill_fields(self.parts(), kind, ratios, uniforms, np.array([0]), shared, rows)
        return out

    def sample(self, name: str, poisson: float, gather: Gather) -> Array:
        """The field `name` where `gather` takes the values of A and B from."""
        all_there = len(self.constant) == len(COMPONENTS)
        needed = COMPONENTS if name == "yy" and all_there else components_for((name,))
        constant, slope = (
            {component: gather(field) for component, field in parts.items() if component in needed}
            for parts in (self.constant, self.slope)
        )
        return replace(self, constant=constant, slope=slope, values=None).field(name, poisson)


def components_for(fields: Sequence[str]) -> tuple[str, ...]:
    """Components from which the fields follow, in the order of `COMPONENTS`."""
    needed = set(fields)
    if needed.intersection(MEASURES):
        return COMPONENTS
    if "hydrostatic" in needed:
        needed.update(_NORMAL)
    return tuple(name for name in COMPONENTS if name in needed)
