"""Solids, grids and surfaces: synthesis, form, treatment of maps, and the answer for a map in SI units."""

import math
from dataclasses import asdict

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
    require,
    require_finite,
    shapes,
    wrong,
)

import asperity as asp
from asperity import engineering

solids = st.fixed_dictionaries(
    {
        "layer": layers,
        "q": among(st.lists(st.floats(0, 1e6), min_size=1, max_size=5), wrong, st.lists(extreme, min_size=1)),
        "depth": st.floats(0, 1e-3) | number(0, 10),
    }
)


def try_layer(case):
    """Kernels of a layer: finite."""
    layer = asp.Layer(**case["layer"])
    compliance = layer.surface_compliance(case["q"])
    # The compliance of a free layer rises as 1/q³, beyond all numbers for the smallest q.
    ordinary = np.asarray(case["q"]) > 1e-70
    require_finite(compliance=compliance[ordinary])
    kernels = layer.kernels(case["q"], case["depth"])
    require_finite(**{name: getattr(kernels, name)[ordinary] for name in kernels._fields})
    return "computed"


grids = st.fixed_dictionaries(
    {
        "shape": among(shapes, wrong, st.tuples(number(1, 8), number(1, 8))),
        "length": lengths,
        "height": st.none() | number(1e-3, 10),
        "spacing": number(0.1, 4),
        "growth": number(0.05, 1),
    }
)


def try_grid(case):
    """Grids, and the depths of their planes: rising from the surface to the bottom."""
    grid = asp.Grid(case["shape"], case["length"])
    depths = asp.depth_grid(grid, case["height"], case["spacing"], case["growth"])
    require_finite(depths=depths)
    require(depths[0] == 0 and np.all(np.diff(depths) > 0), "the depths do not rise from zero")
    return "made"


# --- surfaces


surfaces = st.fixed_dictionaries(
    {
        "shape": among(st.tuples(st.integers(8, 48), st.integers(8, 48)), shapes, wrong),
        "hurst": number(0, 1),
        "wavelength_long": number(0.4, 1),
        "wavelength_short": number(0.2, 0.4),
        "rms_height": number(1e-6, 1),
        "seed": among(st.integers(0, 2**64), st.integers(-5, -1), wrong),
        "length": st.just(1.0) | among(st.just(1.0), number(1e-6, 1e6)),
        "johnson": st.none() | st.tuples(number(-2, 2), number(0.1, 10)),
        "moments": st.none() | st.tuples(number(-2, 2), number(1, 10)),
    }
)


def try_surface(case):
    """Self-affine surfaces and their transforms: finite, with the rms height asked for."""
    case = dict(case)
    transform, moments = case.pop("johnson"), case.pop("moments")
    height = asp.self_affine(**case)
    require_rms(height, case["rms_height"])
    if transform is not None:
        require_rms(asp.johnson(height, *transform), case["rms_height"])
    if moments is not None:
        require_rms(asp.with_moments(height, *moments), case["rms_height"])
    asp.spectrum(height, case["length"])
    require_finite(**vars(asp.roughness_parameters(height, case["length"])))
    return "made"


def require_rms(height, rms):
    """Raise `PromiseError` unless a surface is finite and has its rms height."""
    require_finite(height=height)
    # The square of a smaller height is not a normal number.
    require(rms < 1e-150 or math.isclose(float(np.std(height / rms)), 1, rel_tol=1e-9), "another rms height")


forms = st.fixed_dictionaries(
    {
        "form": st.sampled_from([asp.add_sphere, asp.add_cylinder]),
        "height": heights,
        "length": lengths,
        "radius": number(0.1, 1e6),
        "centre": st.none() | st.tuples(number(0, 1), number(0, 1)) | among(st.none(), wrong),
    }
)


def try_form(case):
    """A sphere or a cylinder under the roughness: finite."""
    case = dict(case)
    require_finite(height=case.pop("form")(made(case.pop("height")), **case))
    return "made"


maps = st.fixed_dictionaries(
    {
        "height": heights,
        "length": st.just((1.0, 1.0)) | st.tuples(number(1e-6, 1), number(1e-6, 1)),
        "periodic": st.booleans(),
        "orientation": choice("peaks up", "lower face"),
        "unit": st.just("m") | st.none(),
    }
)
treatments = {
    "detrend": choice("none", "tilt", "curvature"),
    "undefined": st.none() | choice("harmonic"),
    "despike": st.none() | number(3, 20),
    "wavelength_short": st.none() | number(0.1, 1),
    "points": st.none() | among(st.integers(2, 48), st.sampled_from([0, -1, 2**31, 2**62, 1e300]), wrong),
}
prepared = st.fixed_dictionaries(
    {
        "map": maps,
        "periodic": choice("declared", "mirrored", "windowed", "none"),
        "function": st.sampled_from(["treat_map", "make_periodic"]),
        **treatments,
    }
)


def map_of(case):
    """A height map, some of whose points may have no data."""
    height = made(case["height"])
    return asp.HeightMap(height, **{name: value for name, value in case.items() if name != "height"})


def try_treatment(case):
    """A treated map: finite, with mean zero."""
    case = dict(case)
    surface, function = map_of(case.pop("map")), case.pop("function")
    if function == "treat_map":
        treated = asp.treat_map(surface, asp.Treatment(**case))
    else:
        treated = asp.make_periodic(surface, **case)
    require_finite(height=treated.height)
    mean, largest = float(np.mean(treated.height)), float(np.abs(treated.height).max())
    require(abs(mean) <= 1e-9 * largest, "the mean height is not zero")
    return "made"


elastic = {
    "young": number(1e-3, 1e12),
    "poisson": number(-0.99, 0.5),
    "yield_stress": st.none() | number(1e-3, 1e12),
    "height": st.none() | number(1e-6, 10),
    "bottom": choice("bonded", "frictionless", "free"),
}
questions = st.fixed_dictionaries(
    {
        "map": maps,
        "lower": st.fixed_dictionaries(elastic),
        "upper": st.none() | st.fixed_dictionaries(elastic),
        "kind": st.sampled_from(["mean_pressure", "force", "approach", "area_fraction"]),
        "value": number(1e-3, 1),
        "friction": st.just(0.0) | number(0, 2),
        "settings": st.fixed_dictionaries(
            {},
            optional={
                **treatments,
                "radius": st.none() | number(0.1, 1e6),
                "boundary": choice("periodic", "free"),
            },
        ),
    }
)


def try_run(case):
    """The answer for a map: its contact and stress are finite."""
    upper = None if case["upper"] is None else engineering.Body(**case["upper"])
    answer = engineering.run(
        map_of(case["map"]),
        engineering.Body(**case["lower"]),
        upper,
        **{case["kind"]: case["value"]},
        friction=case["friction"],
        map_settings=engineering.MapSettings(**case["settings"]),
    )
    numbers = asdict(answer.numbers)
    if not numbers["contact_nodes"]:
        del numbers["gradient_rms_contact"]
    require_finite(**numbers)
    for body in answer.bodies.values():
        place = (body.depth, body.y, body.x)
        require_finite(von_mises=body.largest_von_mises)
        require(np.all(np.isfinite(place)) or np.all(np.isnan(place)), "a part of the place is not finite")
    require(answer.text().strip(), "the answer is empty")
    return "answered"
