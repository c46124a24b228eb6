"""Area, gap, pressure, stiffness and stress against the load, and the load where yield begins."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import pandas as pd
import scipy  # submodules are imported at first use
import xarray as xr

from asperity.contact import Contact
from asperity.core.types import Array
from asperity.elasticity.loaded_solid import LoadedSolid, traction_direction
from asperity.engineering.body_stress import STRESS_TOLERANCE, largest_von_mises_between
from asperity.stress.analysis import analyse_stress

COLUMNS = {
    "mean_pressure": "mean_pressure_Pa",
    "area_fraction": "area_fraction",
    "approach": "approach_m",
    "mean_gap": "mean_gap_m",
    "largest_pressure": "largest_pressure_Pa",
    "stiffness": "stiffness_Pa_m",
    "plastic_area": "plastic_area",
    "thermal_conductance": "thermal_conductance_W_m2_K",
    "electrical_conductance": "electrical_conductance_S_m2",
}
"""Variable of a load curve → column of its table."""

YIELD_LOAD_ERROR = 0.005
"""Relative error of the load where yield begins; a third of the error costs one or two contacts more."""


@dataclass(frozen=True, eq=False)
class AnswerCurve:
    """Load curve of an answer.

    Parameters
    ----------
    numbers : dataset
        As of `load_curve`, in SI units; the approach is that since first touch.
    yield_loads : dict
        Body → mean pressure at which it begins to yield, as of `yield_load`.
    """

    numbers: xr.Dataset
    yield_loads: Mapping[str, float]

    def frame(self) -> pd.DataFrame:
        """The curve as a table; the columns are described in ``docs/tables.md``."""
        found = self.numbers.drop_dims("body").to_dataframe().rename(columns=COLUMNS)
        for body in self.numbers["body"].values:
            found[f"largest_von_mises_{body}_Pa"] = self.numbers["largest_von_mises_stress"].sel(body=body)
            if body in self.yield_loads:
                found[f"yield_begins_{body}_Pa"] = self.yield_loads[body]
        return found


def load_curve(
    contacts: Iterable[Contact],
    bodies: Sequence[str] = (),
    resistivities: Mapping[str, float] | None = None,
    loaded: Callable[[Contact, str], LoadedSolid] = Contact.in_body,
    **sliding: Any,
) -> xr.Dataset:
    """Numbers of contacts against their load; each contact is released before the next is solved.

    Parameters
    ----------
    contacts : iterable of Contact
        Such as `asperity.solve_path` yields, under rising loads.
    bodies : sequence of "lower" and "upper"
        Bodies whose largest von Mises stress is computed, by a stress analysis for each load.
    resistivities : mapping, optional
        Name of a conductance → sum of the resistivities of both bodies; see `asperity.Contact.conductance`.
    loaded : callable, optional
        Contact and name of a body → the loaded body; by default under the contact alone.
    **sliding
        `friction` and `sliding_direction` on the lower body, as for `asperity.analyse_stress`.

    Returns
    -------
    dataset
        Along `load`: ``mean_pressure``, ``area_fraction``, ``approach``, ``mean_gap``, ``largest_pressure``,
        ``stiffness`` dp̄/dδ, the conductances by their names, ``plastic_area`` if there is a hardness, and
        along `body`, too, the ``largest_von_mises_stress``, of a coated body that below its coating; in the
        units of the contacts.

    Examples
    --------
    >>> height = asp.self_affine((64, 64), 0.8, 0.5, 0.125, rms_height=1e-3, seed=1)
    >>> path = asp.solve_path(height, asp.Layer(1.0, 0.3), mean_pressures=[1e-4, 1e-3])
    >>> curve = asp.load_curve(path, ["lower"])
    >>> print(curve["area_fraction"].values.round(3), curve["stiffness"].values.round(2))
    [0.016 0.103] [0.46 2.19]
    """
    rows, stresses = [], []
    for contact in contacts:
        gap = np.where(contact.pressure > 0, 0, contact.gap)
        row = {
            "mean_pressure": contact.mean_pressure,
            "area_fraction": contact.area_fraction,
            "approach": contact.approach,
            "mean_gap": float(gap.mean(dtype=float)),
            "largest_pressure": contact.max_pressure,
            "stiffness": contact.stiffness,
        }
        if math.isfinite(contact.hardness):
            row["plastic_area"] = contact.plastic_area
        row |= {name: contact.conductance(value) for name, value in (resistivities or {}).items()}
        rows.append(row)
        stresses.append([largest_von_mises(loaded(contact, body), body, **sliding) for body in bodies])
    if not rows:
        raise ValueError("contacts: at least one is needed")
    found = xr.Dataset({name: ("load", [row[name] for row in rows]) for name in rows[0]})
    if not bodies:
        return found
    stress = (("load", "body"), np.array(stresses))
    return found.assign(largest_von_mises_stress=stress).assign_coords(body=list(bodies))


def largest_von_mises(
    loaded: LoadedSolid, body: str, friction: float = 0.0, sliding_direction: str | float = "x"
) -> float:
    """Largest von Mises stress in a body, at the nodes or between them; below its coating, if it has one."""
    stress = analyse_stress(
        loaded,
        quantities=("von_mises",),
        tolerance=STRESS_TOLERANCE,
        friction=friction,
        sliding_direction=traction_direction(sliding_direction, body),
    )
    return largest_von_mises_between(
        stress, np.nextafter(loaded.layer.interface or -1.0, np.inf), np.inf
    ).value


def yield_load(loads: Array, stresses: Array, limit: float, stress_under: Callable[[float], float]) -> float:
    """Mean pressure at which a stress reaches a limit, to `YIELD_LOAD_ERROR` of itself.

    Parameters
    ----------
    loads, stresses : (count,) arrays
        Rising loads, and the stress under them.
    limit : float
    stress_under : callable
        The stress under another load.

    Returns
    -------
    float
        0 if the stress is above the limit under all loads, infinite if it is below.
    """
    above = np.flatnonzero(stresses >= limit)
    if not above.size:
        return math.inf
    first = int(above[0])
    if first == 0:
        return 0.0
    ends = np.log(loads[first - 1 : first + 1])
    known = dict(zip(ends.tolist(), np.log(stresses[first - 1 : first + 1] / limit).tolist(), strict=True))

    def excess(logarithm: float) -> float:
        if logarithm not in known:
            known[logarithm] = math.log(stress_under(math.exp(logarithm)) / limit)
        return known[logarithm]

    return math.exp(
        scipy.optimize.brentq(excess, float(ends[0]), float(ends[1]), xtol=YIELD_LOAD_ERROR, rtol=1e-12)
    )
