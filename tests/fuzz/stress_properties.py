"""The stress: planes, analyses, sections and boxes, peaks and their statistics."""

import numpy as np
from hypothesis import strategies as st
from inputs import (
    among,
    choice,
    extreme,
    heights,
    layers,
    lengths,
    made,
    number,
    pressed,
    require,
    require_finite,
    wrong,
)

import asperity as asp

names = st.lists(
    choice("xx", "yy", "zz", "yz", "xz", "xy", "von_mises", "largest_shear", "principal_1", "hydrostatic"),
    min_size=1,
    max_size=3,
    unique_by=repr,
)
solids = {
    "pressure": heights,
    "layer": layers | st.just({"young": 1.0, "poisson": 0.3}),
    "length": lengths,
    "boundary": choice("periodic", "free"),
}
sliding = {
    "friction": st.just(0.0) | number(0, 2) | extreme,
    "sliding_direction": choice("x", "y") | number(-360, 360),
}
stresses = st.fixed_dictionaries(
    solids
    | {
        "poisson": st.none() | number(-0.99, 0.5) | st.lists(number(-0.99, 0.5), max_size=3),
        "fields": names,
        "depths": among(st.lists(st.floats(0, 1), min_size=1, max_size=4, unique=True).map(sorted), wrong),
        "tolerance": st.sampled_from([0, 1e-2, 1e-6]) | number(0, 1),
    }
    | sliding
)


def try_stress(case):
    """Stress planes and their peaks: finite, and peaks within the planes."""
    on_solid = pressed(case)
    grid = on_solid.grid
    chosen = ("poisson", "fields", "tolerance", "friction", "sliding_direction")
    planes = list(asp.stress_planes(on_solid, case["depths"], **{name: case[name] for name in chosen}))
    for plane in planes:
        require_finite(**{name: np.asarray(field) for name, field in plane.fields.items()})
    peaks = asp.find_peaks(iter(planes), case["fields"][0])
    require_within(peaks, grid)
    return "computed"


def require_within(peaks, grid):
    """Raise `PromiseError` unless peaks are finite and within the cell."""
    require_finite(value=peaks.value, depth=peaks.depth, y=peaks.y, x=peaks.x)
    for place, edge in ((peaks.y, grid.length[0]), (peaks.x, grid.length[1])):
        require(np.all((place >= 0) & (place <= edge)), "a peak lies outside the cell")


analyses = st.fixed_dictionaries(
    solids
    | {
        "poisson": st.none() | st.lists(st.floats(-0.9, 0.5), min_size=1, max_size=3, unique=True),
        "tolerance": st.sampled_from([0, 1e-2, 1e-6]),
        "spacing": number(0.3, 4),
        "growth": number(0.05, 1),
        "floor": number(0, 1),
        "quantities": among(st.just(("pressure", "von_mises", "xz")), names),
        "pool": st.fixed_dictionaries(
            {
                "gradient": number(0.1, 1.0),
                "bins": among(st.integers(1, 200), st.sampled_from([0, -1, 2**40]), wrong),
                "resamples": among(st.integers(1, 50), st.sampled_from([0, -1, 2**60]), wrong),
                "confidence": number(0.5, 0.99),
                "seed": among(st.integers(0, 9), st.just(-1), wrong),
            }
        ),
        "selection": choice("all", "at_contact", "interior", "under_contact"),
    }
    | sliding
)


MAY_BE_UNKNOWN = ("median_depth", "peak_percentile", "decay_length")
"""Statistics of a selection without peaks, and lengths over which nothing falls to half, are NaN."""


def try_analysis(case):
    """Analysis of the stress under any pressure, its peaks, and their statistics: finite."""
    on_solid = pressed(case)
    depths = asp.depth_grid(on_solid.grid, on_solid.layer.height, case["spacing"], case["growth"])
    chosen = ("poisson", "tolerance", "floor", "quantities", "friction", "sliding_direction")
    data = asp.analyse_stress(on_solid, depths, **{name: case[name] for name in chosen})
    require_finite_dataset(data)
    ratio = None if case["poisson"] is None else case["poisson"][0]
    require_finite_dataset(asp.peaks(data, case["quantities"][0], ratio, case["selection"]), {"poisson"})
    if data.sizes["peak"]:
        pool = dict(case["pool"])
        # With one seed the bands are NaN.
        found = asp.pool_peaks([data], [pool.pop("gradient")], **pool)
        unknown = {str(name) for name in found.variables if str(name).startswith(MAY_BE_UNKNOWN)}
        require_finite_dataset(found, unknown | {str(n) for n in found if str(n).endswith(("_low", "_high"))})
    return "computed"


def require_finite_dataset(data, unknown=frozenset()):
    """Raise `PromiseError` unless the variables of a dataset are finite, or may be unknown."""
    for name, values in data.variables.items():
        if values.dtype.kind == "f" and name not in unknown | {"peak_poisson"}:
            require_finite(**{str(name): values.values})


extents = st.none() | st.tuples(number(0, 1), number(0, 1)).map(
    lambda pair: tuple(sorted(pair)) if all(isinstance(edge, float) for edge in pair) else pair
)
sections = st.fixed_dictionaries(
    {
        **solids,
        "length": st.just(1.0),
        "fields": names,
        "kind": st.sampled_from(["section", "box"]),
        "along": choice("x", "y"),
        "at": st.none() | number(0, 1),
        "depths": among(st.lists(st.floats(0, 1), min_size=1, max_size=4, unique=True).map(sorted), wrong),
        "y": extents,
        "x": extents,
        "spacing": st.none() | number(0.05, 0.5) | extreme,
    }
    | sliding
)


def try_section(case):
    """Sections and boxes of the stress: finite."""
    on_solid = pressed(case)
    chosen = {name: case[name] for name in ("fields", "friction", "sliding_direction")}
    if case["kind"] == "section":
        data = asp.stress_section(on_solid, case["along"], case["at"], case["depths"], **chosen)
    else:
        more = {name: case[name] for name in ("y", "x", "spacing")}
        data = asp.stress_box(on_solid, case["depths"], **chosen, **more).dataset()
    require_finite_dataset(data)
    return "computed"


statistics = st.fixed_dictionaries(
    {
        "field": heights,
        "length": lengths,
        "floor": number(0, 1),
        "bins": among(st.integers(1, 200), st.sampled_from([0, -1, 2**40]), wrong, extreme),
        "limits": st.none() | st.tuples(number(-1, 0), number(0.1, 1)),
    }
)


def try_statistics(case):
    """Peaks of a plane, density of its values and their autocorrelation: finite."""
    field = made(case["field"])
    grid = asp.Grid(field.shape, case["length"])
    require_within(asp.plane_peaks(field, grid, case["floor"]), grid)
    lag, covariance = asp.autocorrelation(field, grid)
    require_finite(lag=lag, covariance=covariance)
    density = asp.probability_density(field, case["bins"], case["limits"])
    require_finite(edges=density.edges, density=density.density)
    return "computed"
