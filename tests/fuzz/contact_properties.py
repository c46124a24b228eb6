"""Contacts: one load, a path of loads, and the certificate of any pressure."""

import math

import numpy as np
from hypothesis import strategies as st
from inputs import among, choice, heights, layers, lengths, made, number, require, require_finite, wrong

import asperity as asp

WORST_NODE = 100.0
"""Violation of the contact conditions that a node may have, in units of the solver's tolerance."""

LOAD_ERROR = 1e-5
"""Relative error of an imposed load: single precision on the grids of the search."""

bodies = layers | layers | st.tuples(layers, layers)
controls = st.one_of(
    st.fixed_dictionaries({"area_fraction": number(1e-3, 1.0)}),
    st.fixed_dictionaries({"mean_pressure": number(0, 1.0)}),
    st.fixed_dictionaries({"force": number(0, 1.0)}),
    st.fixed_dictionaries({"approach": number(-1.0, 1.0)}),
    among(st.just({"area_fraction": 0.1}), st.just({}), st.just({"approach": 0, "mean_pressure": 1})),
)
settings = {
    "length": lengths,
    "method": choice("active_set", "gfmd"),
    "boundary": choice("periodic", "free"),
    "rtol": st.sampled_from([1e-2, 1e-4, 1e-6]) | number(1e-8, 1e-2),
    "dtype": choice("float64", "float32"),
}
contacts = st.fixed_dictionaries(
    {
        "height": heights,
        "solid": bodies,
        "control": controls,
        "settings": st.fixed_dictionaries(
            {},
            optional=settings
            | {
                "threads": among(st.just(1), st.sampled_from([0, 2, True, 2**31, 2**63]), wrong),
                "initial": heights.map(made)
                | st.sampled_from([1.0, 1e-30, 1e30, 1e300]).map(lambda size: np.full((8, 8), size)),
            },
        ),
    }
)


def solid_of(case):
    """A layer, or two bodies."""
    return (
        asp.Layer(**case) if isinstance(case, dict) else asp.TwoBodies(*(asp.Layer(**body) for body in case))
    )


def try_contact(case):
    """Solve a contact: finite, certified, and under the control asked for."""
    solid = solid_of(case["solid"])
    contact = asp.solve(made(case["height"]), solid, **case["control"], **case["settings"])
    require_kept(contact, case["control"])
    return "solved"


def require_kept(contact, control):
    """Raise `PromiseError` unless a contact is finite, certified, and under its control or says it is not."""
    require_finite(
        pressure=contact.pressure,
        displacement=contact.displacement,
        gap=contact.gap,
        approach=contact.approach,
        mean_pressure=contact.mean_pressure,
    )
    require(contact.pressure.min() >= 0, "a pressure is negative")
    found = asp.verify_contact(
        contact.height,
        contact.pressure,
        contact.solid,
        contact.grid.length,
        approach=contact.approach,
        boundary=contact.boundary,
    )
    allowed = WORST_NODE * contact.rtol * max(1.0, reach(contact)) + rounding(contact)
    require(found.worst <= allowed, "the certificate does not hold")
    ((kind, value),) = ((kind, float(value)) for kind, value in control.items())
    if kind in ("mean_pressure", "force"):
        reached = getattr(contact, kind)
        require(math.isclose(reached, value, rel_tol=LOAD_ERROR), f"the {kind} is another")
        require(contact.control_error <= LOAD_ERROR, "the control error is another")
    elif kind == "area_fraction":
        nodes = np.count_nonzero(contact.pressure)
        error = abs(nodes / contact.pressure.size / value - 1)
        require(math.isclose(contact.control_error, error, abs_tol=1e-9), "the control error is another")
        if np.unique(contact.height).size == contact.height.size and contact.rtol <= 1e-3:
            wanted = max(1, round(value * contact.height.size))
            require(abs(nodes - wanted) <= max(1, 1e-3 * wanted), "the area is another")


def reach(contact):
    """Displacement that an error of the pressure as large as itself causes, over the rms height."""
    longest = 2 * np.pi / max(contact.grid.length)
    compliance = float(contact.solid.surface_compliance(longest))
    norm = float(np.sqrt(np.mean(np.square(contact.pressure, dtype=float))))
    rms = float(np.std(contact.height, dtype=float))
    return norm * compliance / rms if rms else 1.0


def rounding(contact):
    """Rounding error of the heights, over the scale of the certificate."""
    nodal_compliance = min(contact.grid.spacing) / contact.solid.effective_modulus
    scale = max(float(np.std(contact.height, dtype=float)), float(contact.max_pressure) * nodal_compliance)
    largest = float(np.abs(contact.height).max())
    return 10 * float(np.finfo(contact.pressure.dtype).eps) * largest / scale if scale else 0.0


paths = st.fixed_dictionaries(
    {
        "height": heights,
        "solid": bodies,
        "kind": st.sampled_from(["area_fraction", "mean_pressure", "force", "approach"]),
        "values": st.lists(number(0.01, 1.0), max_size=4),
        "settings": st.fixed_dictionaries({}, optional=settings),
    }
)
PLURALS = {
    "area_fraction": "area_fractions",
    "mean_pressure": "mean_pressures",
    "force": "forces",
    "approach": "approaches",
}


def try_path(case):
    """Solve a path of loads: each contact as if it were solved alone."""
    kind, values = case["kind"], case["values"]
    path = asp.solve_path(
        made(case["height"]), solid_of(case["solid"]), **{PLURALS[kind]: values}, **case["settings"]
    )
    count = 0
    for value, contact in zip(values, path, strict=True):
        require_kept(contact, {kind: value})
        count += 1
    return "solved" if count else "empty"


certificates = st.fixed_dictionaries(
    {"height": heights, "pressure": heights, "solid": bodies},
    optional={
        "length": lengths,
        "boundary": choice("periodic", "free"),
        "approach": number(-1, 1),
        "mean_pressure": number(0, 1),
    },
)


def try_certificate(case):
    """Certificate of any pressure: its worst violation is infinite or a number, never NaN."""
    case = dict(case)
    height, pressure, solid = (
        made(case.pop("height")),
        made(case.pop("pressure")),
        solid_of(case.pop("solid")),
    )
    require(
        not math.isnan(asp.verify_contact(height, pressure, solid, **case).worst), "the certificate is NaN"
    )
    return "computed"
