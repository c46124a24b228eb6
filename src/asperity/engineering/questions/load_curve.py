"""Load curve: area, gap, pressure, stiffness and stress against the load, and the load where yield begins."""

import math
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from functools import partial
from itertools import pairwise
from typing import Annotated, Any

import numpy as np
import pandas as pd
import scipy
import xarray as xr
from pydantic import PlainValidator, ValidationInfo, WithJsonSchema

from asperity.contact import Contact
from asperity.core.processes import side_by_side
from asperity.core.types import Array, Progress
from asperity.core.units import scaled_unit, shown_si
from asperity.elasticity.loaded_solid import LoadedSolid, traction_direction
from asperity.engineering.answer_data import AnswerData
from asperity.engineering.body_stress import STRESS_TOLERANCE
from asperity.engineering.face import RoughFace, processes_on
from asperity.engineering.press import press
from asperity.engineering.question import IN_FULL_CONTACT, Findings, Picture, Question, Stages, part_of
from asperity.engineering.questions.conduction import resistivities
from asperity.engineering.questions.leak import SEALING_LOAD, WIDE
from asperity.engineering.records import POSITIVE, SEARCH, Record, find, per_cent
from asperity.engineering.scene import Scene
from asperity.settings.load import UNITS
from asperity.settings.model import Whole, check_of, optional, setting
from asperity.stress.analysis import analyse_stress
from asperity.stress.extremes import Extremes
from asperity.surface.treatment.treatment import TreatedMap

TOPIC = "load curve"

COLUMNS = {
    "mean_pressure": "mean_pressure_Pa",
    "contact_area_fraction": "contact_area_fraction",
    "normal_approach": "normal_approach_m",
    "mean_gap": "mean_gap_m",
    "maximum_pressure": "maximum_pressure_Pa",
    "stiffness": "stiffness_Pa_m",
    "plastic_area": "plastic_area_fraction",
    "thermal_conductance": "thermal_conductance_W_m2_K",
    "electrical_conductance": "electrical_conductance_S_m2",
    "electrical_resistance": "electrical_resistance_ohm",
    "force": "force_N",
    "constriction": "narrowest_constriction_m",
    "constriction_on_half": "narrowest_constriction_on_half_m",
    "leakage": "leakage_m3_s",
    "leakage_on_half": "leakage_on_half_m3_s",
}
"""Variable of a load curve → column of its table."""

YIELD_LOAD = "mean pressure where yield begins"

YIELD_LOAD_ERROR = 0.005
"""Relative error of the load where yield begins; a third of the error costs one or two contacts more."""

YIELD_CONTACTS = 4
"""Usual number of contacts to find the load where yield begins."""

MAX_LOADS, RISING = 100, "a list of rising values"
"""Most loads of a load curve, and their description in messages."""

CAPTION = (
    "Load curve: numbers of the contact, maximum von Mises stress and, if requested, leakage against "
    "the mean pressure. A dotted line marks a load where yield begins, or that seals the gap."
)

PANELS = {
    "leakage": ("m^3/s", "leakage_m3_s", "leakage_on_half_m3_s"),
    "contact area fraction": ("%", "contact_area_fraction"),
    "mean gap": ("m", "mean_gap_m"),
    "maximum pressure": ("Pa", "maximum_pressure_Pa"),
    "stiffness": ("Pa/m", "stiffness_Pa_m"),
    "von Mises stress": ("Pa", "maximum_von_mises_lower_Pa", "maximum_von_mises_upper_Pa"),
    "electrical resistance": ("Ω", "electrical_resistance_ohm"),
}
"""Label of a panel of the picture → its unit, and columns of the table."""

ROOM = 5
"""Factor by which a logarithmic axis is longer below, for a legend under a falling curve."""


def _written_load(value: Any, info: ValidationInfo) -> Any:
    """A load whose dimension follows from the load of the case: a bare number in a file stays a text."""
    bare = isinstance(value, (int, float)) and (info.context or {}).get("units")
    return str(value) if bare else value


AnyLoad = Annotated[
    Any,
    PlainValidator(_written_load),
    WithJsonSchema({"type": ["number", "string"], "accepts": "a value of the quantity that `load` imposes"}),
]


class LoadCurve(Question):
    """The contact under rising loads up to the load of the case; see `asperity.engineering.load_curve`."""

    ASKS = "How does it change with the load?"
    TILES = (YIELD_LOAD,)
    FILES = ("curve",)
    SIDE_BY_SIDE = True

    loads: tuple[AnyLoad, ...] = setting(
        ...,
        min_length=1,
        max_length=MAX_LOADS - 1,
        accepts=f"a list of 1 to {MAX_LOADS - 1} rising values below `load`",
        example=["10 MPa", "20 MPa"],
    )
    """Rising loads below `load`, of the same quantity."""
    steps: Whole | None = optional("the loads that are listed", ge=2, le=MAX_LOADS, example=8)
    """Number of loads from the single one in `loads` to `load`, in equal ratios."""

    def problems(self, case: Scene, rough: RoughFace | None = None) -> Iterator[tuple[str, str]]:
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

    def path(self, case: Scene) -> list[float]:
        """The loads in SI units; the last is the load of the case.

        Raises
        ------
        ValueError
            If one is not of the quantity that the load imposes.
        """
        kind, read = case.load.kind, []
        adapter = check_of(type(case.load), kind)
        for value in self.loads:
            number = float(value) if kind == "contact_area_fraction" else value
            try:
                read.append(float(adapter.validate_python(number)))
            except ValueError:
                needed = f"a {kind.replace('_', ' ')} is needed, as in load"
                raise ValueError(f"{value!r}: {needed}") from None
        if self.steps is not None:
            return [*np.geomspace(read[0], case.load.value, self.steps)[:-1].tolist(), case.load.value]
        return [*read, case.load.value]

    def cost(self, case: Scene, is_mirrored: bool) -> tuple[float, float]:
        """Contact, stress and leakage under each load, and the searches."""
        leak, bodies = case.questions.get("leak"), case.different_bodies.values()
        flow = 0.0 if leak is None else leak.flow_cost
        yields = sum(body.yield_stress is not None for body in bodies)
        one, searches = 0.5 + 2.0 * len(bodies) + flow, 2.5 * YIELD_CONTACTS * yields
        return 0.0, len(self.path(case)) * one + searches

    def compute(self, stages: Stages, progress: Progress) -> Findings:
        """The load curve, and the load where yield begins."""
        case, names = stages.case, list(stages.asked.different_bodies)
        done = len(self.path(case))
        limits = {name: limit for name in names if (limit := case.bodies[name].yield_stress) is not None}
        parts = done + YIELD_CONTACTS * len(limits)
        curve = self._curve(stages, partial(part_of, progress, 0, done, parts))
        loads, shares = curve["mean_pressure"].values, curve["contact_area_fraction"].values
        first, last = (shown_si(float(load), "Pa", 3) for load in loads[[0, -1]])
        grows = " to ".join(map(per_cent, shares[[0, -1]]))
        verdict = [f"from {first} to {last} the contact area fraction grows from {grows}"]
        stiffness = float(curve["stiffness"][-1])
        words = IN_FULL_CONTACT if np.isposinf(stiffness) else ""
        records = [Record("stiffness", stiffness, "Pa/m", TOPIC, words=words, note="at the last load")]
        table = curve.drop_dims("body").to_dataframe().rename(columns=COLUMNS).rename_axis(None)
        for name in names:
            stresses = curve["maximum_von_mises_stress"].sel(body=name).values
            table[f"maximum_von_mises_{name}_Pa"] = stresses
            if name in limits:
                search = partial(part_of, progress, done, done := done + YIELD_CONTACTS, parts)
                begins = _yield_begins(stages, name, loads, stresses, limits[name], search)
                table[f"yield_begins_{name}_Pa"] = begins
                value, is_known = float(np.clip(begins, loads[0], loads[-1])), 0 < begins < math.inf
                words = "" if is_known else f"{_where(begins, loads)}, beyond the curve"
                record = Record(YIELD_LOAD, value, "Pa", TOPIC, name, bounds=POSITIVE, words=words)
                records.append(record.with_error(SEARCH, YIELD_LOAD_ERROR * value if is_known else 0.0))
                of = f" of the {name} body" if len(case.bodies) > 1 else ""
                verdict.append(f"yield{of} begins {_where(begins, loads)}")
        return Findings(records=records, verdict="; ".join(verdict), tables={"curve": table})

    def _curve(self, stages: Stages, progress: Progress) -> xr.Dataset:
        """The result of `load_curve` for the case, with the normal approach, forces and leakages."""
        face, path = stages.face, self.path(stages.asked)
        given = [(stages.case, face, load, stages.contact if load == path[-1] else None) for load in path]
        processes = processes_on([face], len(path), stages.cores)
        rows = side_by_side(_at_load, given, processes, lambda parts: progress(sum(parts), len(parts)))
        curve = xr.concat([*rows], "load")
        approach = curve["approach"] - float(stages.contact.height.min())
        return curve.assign(approach=approach).rename(approach="normal_approach")

    def pictures(self, answer: AnswerData) -> Iterator[Picture]:
        """The numbers against the mean pressure."""
        yield Picture("curve", CAPTION, _drawn(answer.tables["curve"], answer.records))


def _at_load(
    case: Scene, face: TreatedMap, load: float, contact: Contact | None, progress: Progress
) -> xr.Dataset:
    """The result of `load_curve` for one load of a case, whose contact may be known."""
    leak, constants = case.questions.get("leak"), resistivities(case)
    if contact is None:
        contact = press(face, case.under(**{case.load.kind: load}), partial(part_of, progress, 0.0, 0.3, 1.0))

    def more(contact: Contact) -> dict[str, float]:
        found = {"force": contact.mean_pressure * face.grid.area}
        if (current := constants.get("electrical_conductance")) is not None:
            found["electrical_resistance"] = 1 / (contact.conductance(current) * face.grid.area)
        return found if leak is None else found | leak.under_load(contact)

    sliding: dict[str, Any] = {"friction": case.friction, "sliding_direction": case.sliding_direction}
    return load_curve([contact], [*case.different_bodies], constants, case.loaded_body, more, **sliding)


def _yield_begins(
    stages: Stages, name: str, loads: Array, stresses: Array, limit: float, progress: Progress
) -> float:
    """Mean pressure at which a body begins to yield, as of `yield_load`."""
    case, steps = stages.case, iter(range(YIELD_CONTACTS))

    def stress_under(load: float) -> float:
        progress(next(steps, YIELD_CONTACTS), YIELD_CONTACTS)
        contact = press(stages.face, case.under(mean_pressure=load))
        return maximum_von_mises(case.loaded_body(contact, name), **case.sliding_of(name))

    return yield_load(loads, stresses, limit, stress_under)


def _where(load: float, loads: Array) -> str:
    """A load on a curve in words; 0 is below all loads, and infinite above."""
    if 0 < load < math.inf:
        return f"at {shown_si(load, 'Pa', 3)}"
    return f"{'above' if load else 'below'} {shown_si(float(loads[-1 if load else 0]), 'Pa', 3)}"


def load_curve(
    contacts: Iterable[Contact],
    bodies: Sequence[str] = (),
    resistivities: Mapping[str, float] | None = None,
    loaded: Callable[[Contact, str], LoadedSolid] | None = None,
    more: Callable[[Contact], Mapping[str, float]] | None = None,
    friction: float = 0.0,
    sliding_direction: str | float = "x",
) -> xr.Dataset:
    """Numbers of contacts against their load; each contact is released before the next is solved.

    Parameters
    ----------
    contacts : iterable of Contact
        Such as `asperity.solve_load_path` yields, under rising loads.
    bodies : sequence of "lower" and "upper"
        Bodies whose maximum von Mises stress is computed, by a stress analysis for each load.
    resistivities : mapping, optional
        Name of a conductance → sum of the resistivities of both bodies; see `asperity.Contact.conductance`.
    loaded : callable, optional
        Contact and name of a body → the loaded body; by default under the contact alone.
    more : callable, optional
        Contact → further numbers by name.
    friction, sliding_direction
        On the lower body, as for `asperity.analyse_stress`.

    Returns
    -------
    dataset
        Along `load`: ``mean_pressure``, ``contact_area_fraction``, ``approach``, ``mean_gap``,
        ``maximum_pressure``, ``stiffness`` dp̄/dδ, the conductances by their names, ``plastic_area`` if there
        is a hardness, and along `body`, too, the ``maximum_von_mises_stress``, below the coating of a coated
        body; in the units of the contacts.

    Examples
    --------
    >>> height = asp.self_affine((64, 64), 0.8, 0.5, 0.125, rms_height=1e-3, seed=1)
    >>> path = asp.solve_load_path(height, asp.Solid(1.0, 0.3), mean_pressures=[1e-4, 1e-3])
    >>> curve = asp.engineering.load_curve(path, ["lower"])
    >>> print(curve["contact_area_fraction"].values.round(3), curve["stiffness"].values.round(2))
    [0.016 0.103] [0.46 2.19]
    """
    rows, stresses = [], []
    for contact in contacts:
        gap = np.where(contact.pressure > 0, 0, contact.gap)
        row = {
            "mean_pressure": contact.mean_pressure,
            "contact_area_fraction": contact.contact_area_fraction,
            "approach": contact.approach,
            "mean_gap": float(gap.mean(dtype=float)),
            "maximum_pressure": contact.maximum_pressure,
            "stiffness": contact.stiffness,
        }
        if math.isfinite(contact.hardness):
            row["plastic_area"] = contact.plastic_area
        row |= {name: contact.conductance(value) for name, value in (resistivities or {}).items()}
        rows.append(row | dict(more(contact) if more else {}))
        solids = {body: loaded(contact, body) if loaded else contact.in_body(body) for body in bodies}
        direction = {body: traction_direction(sliding_direction, body) for body in solids}
        stresses.append([maximum_von_mises(solids[each], friction, direction[each]) for each in solids])
    if not rows:
        raise ValueError("contacts: at least one is needed")
    found = xr.Dataset({name: ("load", [row[name] for row in rows]) for name in rows[0]})
    if not bodies:
        return found
    stress = (("load", "body"), np.array(stresses))
    return found.assign(maximum_von_mises_stress=stress).assign_coords(body=list(bodies))


def maximum_von_mises(
    loaded: LoadedSolid, friction: float = 0.0, sliding_direction: str | float = "x"
) -> float:
    """Maximum von Mises stress, at the nodes or between them, in the material whose yield stress a body has.

    That is an elastic base, or the uppermost layer on a rigid one.
    """
    sliding: dict[str, Any] = {"friction": friction, "sliding_direction": sliding_direction}
    extremes = Extremes(loaded.layer)
    settings: dict[str, Any] = {"quantities": ("von_mises",), "tolerance": STRESS_TOLERANCE, **sliding}
    analyse_stress(loaded, observe=extremes.add, **settings)
    part = -1 if loaded.layer.extent is None else 0
    return extremes.refined(loaded, STRESS_TOLERANCE, **sliding)[part]["von_mises"].value


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

    low, high = ends.tolist()
    return math.exp(scipy.optimize.brentq(excess, low, high, xtol=YIELD_LOAD_ERROR, rtol=1e-12))


def _drawn(table: pd.DataFrame, records: Sequence[Record]) -> Any:
    """Numbers of a load curve against the mean pressure, the electrical resistance against the force."""
    from asperity.engineering.drawing import plain_logarithms
    from asperity.views.panels import canvas

    panels = {
        label: (unit, [name for name in names if name in table])
        for label, (unit, *names) in PANELS.items()
        if names[0] in table
    }
    loads = table["mean_pressure_Pa"].to_numpy()
    margin = max(float(loads[-1] / loads[0]) ** 0.05, 1.01)
    with canvas([0.8] * len(panels), None) as (figure, axes, _):
        for axis, (label, (unit, names)) in zip(axes, panels.items(), strict=True):
            values, against, along = table[names].to_numpy(), ("mean pressure", "Pa"), loads
            if label == "electrical resistance":
                against, along = ("force", "N"), table["force_N"].to_numpy()
            if label == "leakage":  # a logarithmic axis shows no sealed gap
                values = np.where(values > 0, values, np.nan)
            factor, symbol = (0.01, unit) if unit == "%" else scaled_unit(values, unit)
            per, of = scaled_unit(along, against[1])
            for column, marker in zip(values.T, "os", strict=False):
                axis.plot(along / per, column / factor, f"-{marker}", ms=3)
            plain_logarithms(axis.xaxis)
            axis.set(xlim=(along[0] / per / margin, along[-1] / per * margin))
            axis.set(xlabel=f"{against[0]} ({of})", ylabel=f"{label} ({symbol})")
            finite = values[np.isfinite(values)] / factor  # the stiffness is infinite in full contact
            lowest, highest = finite.min(initial=np.inf), finite.max(initial=0)
            if WIDE**3 * lowest > highest > WIDE * lowest > 0:
                plain_logarithms(axis.yaxis)
            elif highest > WIDE * lowest > 0:
                axis.set_yscale("log")
            elif highest > 0:
                axis.set_ylim(0, 1.1 * highest)
            # Dotted lines at the loads where yield begins, and that seal.
            marked: Iterable[Record] = ()
            if label == "leakage":
                axis.legend(["all nodes", "half of the nodes"], loc="lower left")
                if axis.get_yscale() == "log":
                    axis.set_ylim(bottom=axis.get_ylim()[0] / ROOM)
                marked = find(records, SEALING_LOAD)
            if label == "von Mises stress":
                if len(names) > 1:
                    axis.legend(["lower body", "upper body"])
                marked = find(records, YIELD_LOAD)
            for load in marked:
                if not load.words:
                    axis.axvline(load.value / per, color=f"C{int(load.body == 'upper')}", ls=":", lw=1)
    return figure
