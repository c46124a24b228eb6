"""Load curve: area, gap, pressure, stiffness and stress against the load, and the load where yield begins."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING, Annotated, Any

import numpy as np
from pydantic import PlainValidator, ValidationInfo, WithJsonSchema

from asperity.contact import Contact
from asperity.core.types import Array, Progress
from asperity.core.units import shown_si
from asperity.elasticity.loaded_solid import LoadedSolid, traction_direction
from asperity.engineering.question import IN_FULL_CONTACT, Picture, Question, Row
from asperity.settings.load import UNITS
from asperity.settings.model import Whole, check_of, setting

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr

    from asperity.engineering.answer import Answer
    from asperity.engineering.case import Case

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


MAX_LOADS, RISING = 100, "a list of rising values"
"""Most loads of a load curve, and their description in messages."""

CAPTION = (
    "Load curve: real contact, mean gap, largest pressure, stiffness and largest von Mises stress against "
    "the mean pressure. A dotted line marks a load where yield begins."
)

WIDE = 10
"""Largest over smallest value of a number above which its axis is logarithmic."""


def _written_load(value: Any, info: ValidationInfo) -> Any:
    """A load whose dimension follows from the load of the case: a bare number in a file stays a text."""
    bare = isinstance(value, (int, float)) and (info.context or {}).get("units")
    return str(value) if bare else value


AnyLoad = Annotated[
    Any,
    PlainValidator(_written_load),
    WithJsonSchema({"type": ["number", "string"], "accepts": "a value of the quantity that `load` imposes"}),
]


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


class LoadCurve(Question):
    """The contact under rising loads that end at that of the case; see `asperity.engineering.load_curve`."""

    TEMPLATE = "load_curve.html.j2"

    loads: tuple[AnyLoad, ...] = setting(
        ...,
        min_length=1,
        max_length=MAX_LOADS - 1,
        accepts=f"a list of 1 to {MAX_LOADS - 1} rising values below `load`",
        example=["10 MPa", "20 MPa"],
    )
    """Rising loads before that of `load`, of the same quantity."""
    steps: Whole | None = setting(
        None, default_text="the loads that are listed", ge=2, le=MAX_LOADS, example=8
    )
    """Number of loads from the single one in `loads` to that of `load`, in equal ratios."""

    def check(self, case: Case) -> Iterator[tuple[str, str]]:
        """Loads of another quantity, and loads that do not rise."""
        try:
            path = self.path(case)
        except ValueError as error:
            yield "load_curve.loads", f": {error}"
            return
        if self.steps is not None and len(self.loads) > 1:
            yield "load_curve.loads", f" = {len(self.loads)} values: a single one is needed with steps"
        if any(after <= before for before, after in pairwise(path)):
            shown = ", ".join(shown_si(value, UNITS[case.load.kind]) for value in path)
            yield "load_curve.loads", f" = {shown}: {RISING} below the load is needed"

    def path(self, case: Case) -> list[float]:
        """The loads in SI units; the last is that of the case.

        Raises
        ------
        ValueError
            If one is not of the quantity that the load imposes.
        """
        kind, read = case.load.kind, []
        adapter = check_of(type(case.load), kind)
        for value in self.loads:
            number = float(value) if kind == "area_fraction" else value
            try:
                read.append(float(adapter.validate_python(number)))
            except ValueError:
                raise ValueError(
                    f"{value!r}: a {kind.replace('_', ' ')} is needed, as that of load"
                ) from None
        if self.steps is not None:
            return [*np.geomspace(read[0], case.load.value, self.steps)[:-1].tolist(), case.load.value]
        return [*read, case.load.value]

    def after_stress(self, answer: Answer, progress: Progress) -> AnswerCurve:
        """The load curve, and the loads where yield begins."""
        from asperity.engineering.press import press
        from asperity.engineering.questions.conduction import resistivities

        case, face, path = answer.case, answer.face, self.path(answer.case)

        def contacts() -> Iterator[Contact]:
            for number, load in enumerate(path):
                under = case.under(**{case.load.kind: load})
                yield answer.contact if load == path[-1] else press(face, under)
                progress(number + 1, len(path))

        names = list(case.different_bodies)
        sliding: dict[str, Any] = {"friction": case.friction, "sliding_direction": case.sliding_direction}
        curve = load_curve(contacts(), names, resistivities(case), case.loaded_body, **sliding)
        begins = {}
        for name in names:
            if (limit := case.bodies[name].yield_stress) is not None:

                def stress_under(load: float, name: str = name) -> float:
                    under_load = press(face, case.under(mean_pressure=load))
                    return largest_von_mises(case.loaded_body(under_load, name), name, **sliding)

                stresses = curve["largest_von_mises_stress"].sel(body=name).values
                begins[name] = yield_load(curve["mean_pressure"].values, stresses, limit, stress_under)
        lowest = float(answer.contact.height.min())
        return AnswerCurve(curve.assign(approach=curve["approach"] - lowest), begins)

    def rows(self, answer: Answer) -> Iterator[Row]:
        """Stiffness at the last load, and loads where yield begins."""
        curve: AnswerCurve = answer.of(self)
        loads = curve.numbers["mean_pressure"].values
        group = f"load curve, {loads.size} loads"
        stiffness = float(curve.numbers["stiffness"][-1])
        number = IN_FULL_CONTACT if np.isposinf(stiffness) else f"{shown_si(stiffness * 1e-6, 'Pa')}/µm"
        yield Row(group, "stiffness", stiffness, "Pa/m", f"{number} at the last load")
        for name, load in curve.yield_loads.items():
            value = min(max(load, float(loads[0])), float(loads[-1]))
            words = f"{shown_si(value, 'Pa', 3)} ± {100 * YIELD_LOAD_ERROR:g} %"
            if not 0 < load < np.inf:
                words = f"{'below' if load == 0 else 'above'} {shown_si(value, 'Pa', 3)}, beyond the curve"
            subject = f"the {name} body yields" if len(answer.case.bodies) > 1 else "yield begins"
            yield Row(group, f"mean pressure where {subject}", value, "Pa", words)

    def files(self, case: Case) -> list[str]:
        """Table and picture."""
        return ["curve.csv", "curve.png"]

    def tables(self, answer: Answer) -> Mapping[str, pd.DataFrame]:
        """The curve."""
        return {"curve": answer.of(self).frame()}

    def pictures(self, answer: Answer) -> Iterator[Picture]:
        """The numbers against the mean pressure."""
        yield Picture("curve", CAPTION, _drawn(answer.of(self)))


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
        Such as `asperity.solve_load_path` yields, under rising loads.
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
    >>> path = asp.solve_load_path(height, asp.Solid(1.0, 0.3), mean_pressures=[1e-4, 1e-3])
    >>> curve = asp.engineering.load_curve(path, ["lower"])
    >>> print(curve["area_fraction"].values.round(3), curve["stiffness"].values.round(2))
    [0.016 0.103] [0.46 2.19]
    """
    import xarray as xr

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
    from asperity.engineering.body_stress import STRESS_TOLERANCE, largest_von_mises_between
    from asperity.stress.analysis import analyse_stress

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
    import scipy

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


def _drawn(curve: AnswerCurve) -> Any:
    """Numbers of a load curve against the mean pressure."""
    from asperity.views.panels import canvas

    numbers = curve.numbers
    loads = numbers["mean_pressure"].values
    panels = {
        "area_fraction": ("real contact", 1.0),
        "mean_gap": ("mean gap (nm)", 1e9),
        "largest_pressure": ("largest pressure (GPa)", 1e-9),
        "stiffness": ("stiffness (GPa/µm)", 1e-15),
        "largest_von_mises_stress": ("von Mises stress (GPa)", 1e-9),
    }
    with canvas([0.8] * len(panels), None) as (figure, axes, _):
        for axis, (name, (label, factor)) in zip(axes, panels.items(), strict=True):
            values = factor * numbers[name].values.reshape(loads.size, -1)
            margin = max((loads[-1] / loads[0]) ** 0.05, 1.01)
            limits = 1e-6 * loads[0] / margin, 1e-6 * loads[-1] * margin
            axis.set(xscale="log", xlim=limits, xlabel="mean pressure (MPa)", ylabel=label)
            for column, marker in zip(values.T, "os", strict=False):
                axis.plot(1e-6 * loads, column, f"-{marker}", ms=3)
            finite = values[np.isfinite(values)]  # the stiffness is infinite in full contact
            highest = finite.max(initial=0)
            if highest > WIDE * finite.min(initial=np.inf) > 0:
                axis.set_yscale("log")
            elif highest > 0:
                axis.set_ylim(0, 1.1 * highest)
        bodies = [str(body) for body in numbers["body"].values]
        if len(bodies) > 1:
            axis.legend([f"{body} body" for body in bodies])
        for name, load in curve.yield_loads.items():
            if 0 < load < np.inf:
                axis.axvline(1e-6 * load, color=f"C{bodies.index(name)}", ls=":", lw=1)
    return figure
