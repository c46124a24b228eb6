"""Everything that a user calls: how an input is drawn, and what must hold whatever the input is.

A property is a strategy that draws an input, and a function that tries it, and may return the outcome in a
word. It raises `PromiseError` if a promise is not kept. Every other exception than the package's own is a
defect as well, which the search notices itself.
"""

import functools
import math
import sys
import tempfile
from dataclasses import replace
from pathlib import Path

import numpy as np
from hypothesis import strategies as st
from inputs import (
    among,
    bodies,
    boundaries,
    choice,
    count,
    heights,
    lengths,
    loaded,
    loaded_solid,
    made,
    number,
    require,
    require_finite,
    shapes,
    solid_of,
    wrong,
)

import asperity as asp
from asperity.contact import dilute
from asperity.core.errors import is_refusal
from asperity.fourier.grid import boundary_on, with_mirror_images
from asperity.surface.treatment.treatment import make_periodic

sys.path.insert(0, str(Path(__file__).parents[1]))

import bad_input
import families
import family_outcomes
import random_input
import random_pressure
from answers import ANSWERS

WORST_NODE = 100.0
"""Violation of the contact conditions that a node may have, in units of the solver's tolerance."""

LOAD_ERROR = 1e-5
"""Relative error of an imposed load: single precision on the grids of the search."""

# Contacts

PLURALS = {
    "contact_area_fraction": "contact_area_fractions",
    "mean_pressure": "mean_pressures",
    "force": "forces",
    "approach": "approaches",
}
contacts = st.fixed_dictionaries(
    {
        "height": heights,
        "solid": bodies,
        "kind": st.sampled_from(list(PLURALS)),
        "values": st.lists(number(1e-3, 1.0), min_size=1, max_size=3),
        "settings": st.fixed_dictionaries(
            {},
            optional={
                "length": lengths,
                "hardness": number(1e-3, 10.0),
                "method": choice("active_set", "gfmd"),
                "boundary": boundaries,
                "rtol": st.sampled_from([1e-2, 1e-4, 1e-6]) | number(1e-8, 1e-2),
                "dtype": choice("float64", "float32"),
                "initial": heights.map(made),
            },
        ),
    }
)


def try_contact(case):
    """Solve a contact or a path of loads: finite, certified, and under the load asked for."""
    kind, values, settings = case["kind"], case["values"], {"length": 1.0} | case["settings"]
    height, solid = made(case["height"]), solid_of(case["solid"])
    if len(values) == 1:
        path = [asp.solve_contact(height, solid, **{kind: values[0]}, **settings)]
    else:
        path = asp.solve_load_path(height, solid, **{PLURALS[kind]: values}, **settings)
    for value, contact in zip(values, path, strict=True):
        require_kept(contact, kind, value)


def require_kept(contact, kind, value):
    """Raise `PromiseError` unless a contact is finite, certified, and under the load that it reports."""
    names = ("pressure", "displacement", "gap", "approach", "mean_pressure")
    require_finite(**{name: getattr(contact, name) for name in names})
    require(contact.pressure.min() >= 0, "a pressure is negative")
    certificate = asp.contact.verify_contact(
        contact.height,
        contact.pressure,
        contact.solid,
        contact.grid.length,
        approach=contact.approach,
        hardness=contact.hardness if math.isfinite(contact.hardness) else None,
        boundary=contact.boundary,
    )
    require(contact.pressure.max() <= contact.hardness, "a pressure is above the hardness")
    allowed = WORST_NODE * contact.rtol * max(1.0, reach(contact)) + rounding(contact)
    require(certificate.worst <= allowed, "the certificate does not hold")
    if kind in ("mean_pressure", "force"):
        is_reached = math.isclose(getattr(contact, kind), value, rel_tol=LOAD_ERROR)
        require(is_reached, f"the {kind} is another")
        require(contact.control_error <= LOAD_ERROR, "the control error is another")
    elif kind == "contact_area_fraction":
        nodes = np.count_nonzero(contact.pressure)
        error = abs(nodes / contact.pressure.size / value - 1)
        require(math.isclose(contact.control_error, error, abs_tol=1e-9), "the control error is another")
        if np.unique(contact.height).size == contact.height.size and contact.rtol <= 1e-3:
            wanted = max(1, round(value * contact.height.size))
            require(abs(nodes - wanted) <= max(1, 1e-3 * wanted), "the area is another")


def reach(contact):
    """Displacement that an error of the pressure as large as itself causes, over the rms height."""
    longest = 2 * np.pi / max(contact.grid.length)
    norm = float(np.sqrt(np.mean(np.square(contact.pressure, dtype=float))))
    rms = float(np.std(contact.height, dtype=float))
    return norm * float(contact.solid.surface_compliance(longest)) / rms if rms else 1.0


def rounding(contact):
    """Rounding error of the heights, over the scale of the certificate."""
    nodal_compliance = min(contact.grid.spacing) / contact.solid.effective_modulus
    scale = float(np.std(contact.height, dtype=float)) or float(contact.maximum_pressure) * nodal_compliance
    largest = float(np.abs(contact.height).max())
    return 10 * float(np.finfo(contact.pressure.dtype).eps) * largest / scale if scale else 0.0


def power_of_ten(low, high):
    """A number between two powers of ten."""
    return st.floats(low, high).map(lambda exponent: 10.0**exponent)


loads = st.tuples(st.just("load"), power_of_ten(-10, 0))
of_family = {
    "family": st.sampled_from(list(families.FAMILIES)),
    "shape": st.tuples(st.integers(1, 48), st.integers(1, 48)),
    "relief": st.just(1.0) | power_of_ten(-6, 6),
    "offset": st.sampled_from(families.FAMILY_LEVELS["offset"]),
    "imposed": loads
    | loads
    | st.tuples(st.just("area"), power_of_ten(-3, 0))
    | st.tuples(st.just("approach"), power_of_ten(-6, -0.001)),
    "hardness": st.none() | st.floats(1.0001, 30),
    "precision": st.sampled_from(families.FAMILY_LEVELS["precision"]),
    "size": st.floats(0.05, 0.45),
    "seed": st.integers(0, 100),
}
engineered = st.builds(
    families.FamilyCase,
    **of_family,
    # Not the thin free sheet, whose solutions take seconds: docs/contact.md.
    solid=st.sampled_from([solid for solid in families.SOLIDS if solid != "sheet"]),
) | st.builds(
    families.FamilyCase,
    **of_family,
    solid=st.sampled_from(families.HALF_SPACES),
    boundary=st.sampled_from(["free", "free along y", "free along x"]),
)


def try_family(case):
    """A surface that engineers press, under any load: solved, and confirmed by a check without the solver."""
    found = family_outcomes.attempt_family(case)
    require(found.outcome in family_outcomes.ACCEPTABLE, f"{found.outcome}: {found.reason}")
    return found.outcome


def try_bound(case):
    """The error of a pressure against the direct solution of its load is within its certificate's bound."""
    error, bound, rounding = random_pressure.error_and_bound(case)
    require(error <= bound + rounding, "the error exceeds its bound")


mirrored_maps = st.fixed_dictionaries(
    {
        "shape": st.tuples(st.integers(1, 40), st.integers(1, 40)),
        "seed": st.integers(0, 100),
        "relief": power_of_ten(-4, -1),
        "length": st.tuples(st.floats(0.5, 2), st.floats(0.5, 2)),
        "solid": st.sampled_from([solid for solid in families.SOLIDS if solid != "sheet"]),
        "boundary": st.sampled_from(["periodic", "free along y", "free along x"]),
        "load": power_of_ten(-5, 0),
        "hardness": st.none() | st.floats(1.01, 30),
        "precision": st.sampled_from(families.FAMILY_LEVELS["precision"]),
    }
)


def try_mirrored(case):
    """The contact on a mirrored map is that on the cell of the map and its mirror images."""
    solid, (dtype, rtol) = families.SOLIDS[case["solid"]], case["precision"]
    boundary = case["boundary"] if solid.height is None else "periodic"
    _, grid = boundary_on(boundary, asp.Grid(case["shape"], case["length"], mirrored=True))
    height = case["relief"] * np.random.default_rng(case["seed"]).random(case["shape"])
    load = case["load"] * solid.effective_modulus
    settings = {"mean_pressure": load, "dtype": dtype, "rtol": rtol, "boundary": boundary}
    if case["hardness"]:
        settings["hardness"] = case["hardness"] * load
    found = asp.solve_contact(height, solid, grid, **settings)
    whole = asp.solve_contact(with_mirror_images(height, grid), solid, grid.whole_cell, **settings)
    expected = whole.pressure[grid.map]
    error = np.linalg.norm(found.pressure - expected) / np.linalg.norm(expected)
    require(error <= WORST_NODE * rtol, "the pressure is another than on the cell")


adhesive_contacts = st.fixed_dictionaries(
    {
        "shape": st.tuples(st.integers(4, 40), st.integers(4, 40)),
        "seed": st.integers(0, 100),
        "relief": power_of_ten(-4, -1),
        "solid": st.sampled_from([solid for solid in families.SOLIDS if solid != "sheet"]),
        "boundary": st.sampled_from(["periodic", "mirrored", "free"]),
        "work": power_of_ten(-9, -4),
        "range": power_of_ten(-0.15, 1),
        "law": st.sampled_from(["exponential", "maugis-dugdale"]),
        "path": st.lists(st.floats(-0.5, 0.8), min_size=1, max_size=4),
        "hardness": st.none() | power_of_ten(-3, 0),
    }
)


def try_adhesion(case):
    """A path with adhesion: certified anew, and within the strength and the hardness."""
    solid = families.SOLIDS[case["solid"]]
    boundary = "free" if case["boundary"] == "free" and solid.height is None else "periodic"
    grid = asp.Grid(case["shape"], mirrored=case["boundary"] == "mirrored")
    height = case["relief"] * np.random.default_rng(case["seed"]).random(case["shape"])
    modulus = solid.effective_modulus
    fitted = asp.Adhesion.fitted(case["work"] * modulus, solid, grid, case["law"])
    adhesion = replace(fitted, range=fitted.range * case["range"])
    hardness = case["hardness"] and case["hardness"] * modulus
    path = height.min() + (height.mean() - height.min()) * np.array(case["path"])
    settings = {"adhesion": adhesion, "hardness": hardness, "boundary": boundary}
    for contact in asp.solve_load_path(height, solid, grid, approaches=path.tolist(), **settings):
        settings["approach"] = contact.approach
        found = asp.contact.verify_contact(contact.height, contact.pressure, solid, grid, **settings)
        require(found.worst < 1e-3, "the certificate does not hold")
        require(contact.pressure.min() >= -adhesion.strength * (1 + 1e-9), "a tension is above the strength")
        require(contact.pressure.max() <= contact.hardness, "a pressure is above the hardness")


dilute_contacts = st.fixed_dictionaries(
    {
        "shape": st.tuples(st.integers(128, 300), st.integers(128, 300)),
        "seed": st.integers(0, 100),
        "kind": st.sampled_from(["rough", "steps", "punch", "spikes", "bowl"]),
        "boundary": st.sampled_from(["periodic", "mirrored", "free", "free along y", "free along x"]),
        "solid": st.sampled_from(families.HALF_SPACES),
        "control": st.sampled_from(["mean_pressure", "force", "approach", "contact_area_fraction"]),
        "load": power_of_ten(-7, -4),
        "hardness": st.none() | st.floats(1.01, 30),
        "precision": st.sampled_from(families.FAMILY_LEVELS["precision"]),
    }
)


def try_dilute(case):
    """The contact on nodes that may touch is that on the whole grid."""
    (ny, nx), seed, (dtype, rtol) = case["shape"], case["seed"], case["precision"]
    grid = asp.Grid((ny, nx), (1.0, nx / ny), case["boundary"] == "mirrored")
    generator, (y, x) = np.random.default_rng(seed), np.indices(grid.shape) / ny
    rough = asp.self_affine(grid.shape, 0.7, 0.3, 0.03, rms_height=3e-3, seed=seed)
    top, left = generator.random(2)
    height = {
        "rough": rough,
        "steps": np.round(rough, 3),
        "punch": np.where(np.maximum(abs(y - top), abs(x - left)) < 0.04, 0.0, 0.1),
        "spikes": 0.01 * (generator.random(grid.shape) > 1e-3),
        "bowl": (y - top) ** 2 + (x - left) ** 2,
    }[case["kind"]]
    solid = families.SOLIDS[case["solid"]]
    settings = {
        "boundary": "periodic" if case["boundary"] == "mirrored" else case["boundary"],
        "dtype": dtype,
        "rtol": rtol,
    }
    load = case["load"] * solid.effective_modulus
    if case["hardness"]:
        settings["hardness"] = 100 * case["hardness"] * load
    usual = dilute.MAX_AREA, dilute.MIN_POINTS
    try:
        dilute.MAX_AREA, dilute.MIN_POINTS = 0.0, 128
        whole = asp.solve_contact(height, solid, grid, mean_pressure=load, **settings)
        if not 0 < whole.contact_area_fraction < usual[0]:
            return "dense"
        dilute.MAX_AREA = usual[0]
        control = case["control"]
        found = asp.solve_contact(height, solid, grid, **{control: getattr(whole, control)}, **settings)
    except asp.ConvergenceError as error:
        require(dilute.MAX_AREA == 0, f"not solved on the nodes that may touch: {error}")
        raise
    finally:
        dilute.MAX_AREA, dilute.MIN_POINTS = usual
    if control == "contact_area_fraction":
        require(found.control_error <= max(whole.control_error, 1e-2), "the area is another")
        return
    error = np.linalg.norm(found.pressure - whole.pressure) / np.linalg.norm(whole.pressure)
    allowed = WORST_NODE * rtol * max(1.0, reach(whole)) + rounding(whole) * (control == "approach")
    require(error <= allowed, f"the pressure is another than on the whole grid, by {error:.1g}")


# Stress

COMPONENTS = ("xx", "yy", "zz", "yz", "xz", "xy")
FIELDS = (*COMPONENTS, "von_mises", "maximum_shear", "principal_1", "hydrostatic")
names = st.lists(choice(*FIELDS), min_size=1, max_size=3, unique_by=repr)
depths = among(st.lists(st.floats(0, 1), min_size=1, max_size=4, unique=True).map(sorted), wrong)
sliding = ("friction", "sliding_direction")
extents = st.none() | st.tuples(number(0, 1), number(0, 1))
stresses = st.fixed_dictionaries(
    loaded
    | {
        "kind": st.sampled_from(["planes", "section", "box"]),
        "poisson": st.none() | number(-0.99, 0.5) | st.lists(number(-0.99, 0.5), max_size=3),
        "fields": names,
        "depths": depths,
        "tolerance": st.sampled_from([0, 1e-2, 1e-6]) | number(0, 0.9),
        "along": choice("x", "y"),
        "at": st.none() | number(0, 1),
        "y": extents,
        "x": extents,
        "spacing": st.none() | number(0.05, 0.5),
    }
)


def try_stress(case):
    """Planes with their peaks, sections and boxes: finite, and peaks within the cell.

    Planes of a mirrored map on its own grid equal the planes of the map and its mirror images.
    """
    solid = loaded_solid(case)
    chosen = {name: case[name] for name in ("fields", "poisson", "tolerance", *sliding)}
    if case["kind"] == "section":
        require_finite_dataset(asp.stress_section(solid, case["along"], case["at"], case["depths"], **chosen))
    elif case["kind"] == "box":
        more = {name: case[name] for name in ("y", "x", "spacing")}
        require_finite_dataset(asp.stress.stress_box(solid, case["depths"], **chosen, **more).dataset())
    else:
        planes = list(asp.stress_planes(solid, case["depths"], **chosen))
        for plane in planes:
            require_finite(**{name: np.asarray(field) for name, field in plane.fields.items()})
        peaks = asp.stress.find_peaks(iter(planes), case["fields"][0])
        require_finite(value=peaks.value, depth=peaks.depth, y=peaks.y, x=peaks.x)
        for position, edge in ((peaks.y, solid.grid.length[0]), (peaks.x, solid.grid.length[1])):
            lowest = -0.5 * edge if solid.grid.mirrored else 0.0  # the mirror line
            require(np.all((position >= lowest) & (position <= edge)), "a peak lies outside the cell")
        if solid.grid.mirrored is True:
            cells = asp.stress_planes(solid.with_mirror_images(), case["depths"], **chosen)
            for plane, cell in zip(planes, cells, strict=True):
                require_alike(solid.grid, plane, cell)


def require_alike(grid, plane, cell):
    """Raise `PromiseError` unless a plane of a mirrored map equals the plane of its whole cell."""
    require(plane.grid.whole_cell.shape == cell.grid.shape or not plane.grid.mirrored, "another grid")
    if plane.grid.shape == grid.shape:
        scale = max(np.abs(field).max() for field in cell.fields.values())
        for name, field in plane.fields.items():
            difference = field - cell.fields[name][:, : grid.shape[0], : grid.shape[1]]
            require(np.abs(difference).max() <= 1e-5 * scale, "not equal to the cell's")


def require_finite_dataset(data):
    """Raise `PromiseError` unless the variables of a dataset are finite."""
    found = {str(name): values.values for name, values in data.variables.items()}
    require_finite(**{name: values for name, values in found.items() if values.dtype.kind == "f"})


# Surfaces and maps


surfaces = st.fixed_dictionaries(
    {
        "shape": among(st.tuples(st.integers(8, 48), st.integers(8, 48)), shapes, wrong),
        "hurst": number(0, 1),
        "wavelength_long": number(0.4, 1),
        "wavelength_short": number(0.2, 0.4),
        "rms_height": number(1e-6, 1),
        "seed": among(st.integers(0, 2**64), st.integers(-5, -1), wrong),
        "length": st.just(1.0) | among(st.just(1.0), number(1e-6, 1e6)),
        "transform": st.none()
        | st.tuples(st.just(asp.surface.johnson), number(-2, 2), number(0.1, 10))
        | st.tuples(st.just(asp.surface.with_moments), number(-2, 2), number(1, 10)),
    }
)


def try_surface(case):
    """Self-affine surfaces and their transforms: finite, with the rms height asked for."""
    case = dict(case)
    transform, rms = case.pop("transform"), case["rms_height"]
    height = asp.self_affine(**case)
    if transform is not None:
        function, *arguments = transform
        height = function(height, *arguments)
    require_finite(height=height)
    # The square of a smaller height is not a normal number.
    require(rms < 1e-150 or math.isclose(float(np.std(height / rms)), 1, rel_tol=1e-9), "another rms height")
    asp.surface.spectrum(height, case["length"])
    require_finite(**vars(asp.roughness_parameters(height, case["length"])))


maps = st.fixed_dictionaries(
    {
        "height": among(heights.filter(lambda height: min(height.shape) > 2), heights).map(made),
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
    "scan_lines": st.sampled_from((None, "median", "matched")),
    "s_filter": st.none() | number(0.01, 1),
    "l_filter": st.none() | number(0.01, 10),
    "points": st.none() | count(2, 48),
}
treated = st.fixed_dictionaries(
    {
        "map": maps,
        "periodic": choice("declared", "mirrored", "windowed", "none"),
        "in_cell": st.booleans(),
        **treatments,
    }
)


def try_treatment(case):
    """A treated map: finite, with mean zero."""
    case = dict(case)
    surface, in_cell = asp.HeightMap(**case.pop("map")), case.pop("in_cell")
    height = (make_periodic if in_cell else asp.prepare_map)(surface, **case).height
    require_finite(height=height)
    require(abs(float(np.mean(height))) <= 1e-9 * float(np.abs(height).max()), "the mean height is not zero")


strengths = st.none() | number(1e-3, 1e12)
hardness = {"hardness": strengths}
more = hardness | {"conductivity": number(1e-9, 1e5), "resistivity": number(1e-12, 1e20)}
material = {"young": number(1e-3, 1e12), "poisson": number(-0.99, 0.5), "yield_stress": strengths}
strength = st.fixed_dictionaries(
    {}, optional=dict.fromkeys(("shear", "tension", "energy", "toughness"), number(1e-3, 1e9))
).filter(lambda given: given and not {"energy", "toughness"} <= given.keys())
layer = st.fixed_dictionaries(
    material | {"thickness": number(1e-6, 10)},
    optional={"residual_stress": number(-1e9, 1e9), "strength": strength},
)
layered = {"layers": st.lists(layer, min_size=1, max_size=3)}
elastic = (
    st.fixed_dictionaries(material, optional=more)
    | st.fixed_dictionaries(material | layered, optional=hardness)
    | st.fixed_dictionaries(layered | {"base": choice("bonded", "frictionless")}, optional=hardness)
)
fatigue_limits = st.builds(
    lambda torsion, ratio: {"fatigue_torsion": torsion, "fatigue_bending": ratio * torsion},
    st.floats(1e-3, 1e12),
    st.floats(1.0, 2.0),
)
cases = st.fixed_dictionaries(
    {
        "map": maps,
        "lower": elastic,
        "upper": st.none() | elastic,
        "kind": st.sampled_from([kind.replace("approach", "normal_approach") for kind in PLURALS]),
        "value": number(1e-3, 1) | st.lists(st.floats(1e-3, 1), min_size=1, max_size=3).map(sorted),
        "friction": st.just(0.0) | number(0, 2),
        "direction": st.just("x") | choice("x", "y") | number(-180, 360),
        "fatigue": st.just({}) | fatigue_limits,
        "settings": st.fixed_dictionaries(
            {},
            optional={
                **treatments,
                "radius": st.none() | number(0.1, 1e6),
                "periodic": choice("mirrored", "none"),
            },
        ),
    }
)


def try_run(case):
    """The answer for a map: its contact and stress are finite."""
    *loads, load = case["value"] if isinstance(case["value"], list) else [case["value"]]
    imposed = {"approach": "normal_approach"}.get(case["kind"], case["kind"])
    answer = asp.run(
        {"file": asp.HeightMap(**case["map"]), **case["settings"]},
        case["lower"] | case["fatigue"],
        case["upper"],
        **{imposed: load},
        **({"load_curve": {"loads": loads}} if loads else {}),
        sliding={"friction": case["friction"], "direction": case["direction"]},
    )
    require_finite(**{each.quantity: each.value for each in answer.records if not each.words})
    for body in answer.stress:
        position = answer.record("maximum von Mises stress", body).position
        is_whole = np.all(np.isfinite(position)) or np.all(np.isnan(position))
        require(is_whole, "a part of the position is not finite")
    require(str(answer).strip(), "the answer is empty")


# The command line

FOLDER = Path(tempfile.mkdtemp(prefix="fuzz-"))
MAP = bad_input.matrix(bad_input.ROWS)


@functools.cache
def files():
    """Results of the stages of a small study."""
    return bad_input.make_chain(FOLDER)


def try_command(words):
    """A command with some words inserted, replaced or deleted: done or refused."""
    random_input.require_answered(words, files(), FOLDER)


@st.composite
def map_files(draw):
    """A map file of one of the families with some of its bytes or words replaced, and its suffix."""
    path = draw(st.none() | st.sampled_from(sorted(bad_input.DATA.glob("steel*.*"))))
    content = bytearray(MAP if path is None else path.read_bytes())
    for _ in range(draw(st.integers(0, 3))):
        start = draw(st.integers(0, len(content)))
        end = start + draw(st.sampled_from([0, 1, 8, 100, 10_000]))
        words = st.sampled_from([b"nan", b"inf", b"1e300", b"\n", b" ", b"#", b"0 m", b"%", b"{", b"\x00"])
        content[start:end] = draw(words | st.binary(max_size=8))
    suffix = path.suffix[1:] if path else "asc"
    return bytes(content), draw(st.sampled_from([suffix, suffix, suffix, "txt", "npy", "x3p", "gz", ""]))


def try_map(case):
    """A damaged map file: pressed by the library, or refused with a line for each problem."""
    content, suffix = case
    path = FOLDER / f"given.{suffix}"
    path.write_bytes(content)
    random_input.require_answered(["info", str(path)], {}, FOLDER)
    try:
        surface = asp.prepare_map(path, periodic="mirrored", detrend="tilt")
        asp.solve_contact(surface.height, asp.Solid(1.0, 0.3), surface.grid, contact_area_fraction=0.2)
    except (ValueError, asp.ConvergenceError) as error:
        if isinstance(error, ValueError) and not is_refusal(error):
            raise
        lines = getattr(error, "lines", [str(error)])
        require(all(line.isprintable() and len(line) < random_input.MAX_MESSAGE for line in lines), "lines")
        return "refused"


TREATED = r"""
height has the shape .*: at least \d+ x \d+ points are needed
a surface that varies is needed
wavelength_short( = .*)?: a (number|smaller one)
periodic = 'none': one of declared
detrend = .*: the file states that the map is one period
points = .*: (an even number|more)
([sl]_filter = .*)+: (a filter that leaves some|less than l_filter)
"""
STRESSED = r"""
boundary = 'free.*': (a )?half-spaces? (is|are) needed
(grid\.shape = .*|map): at least (three|3) nodes
friction = .* in a layer with
bottom = 'free': bonded or frictionless
"""
DOCUMENTED = {
    "contact": r"""
initial has the shape
method = 'gfmd': active_set is needed
approach = .*: less than .* the mean
hardness = .*: more than the mean pressure
\w+ = .*: rising values are needed with a hardness
contact_area_fraction = .*: less is needed
boundary = 'free.*': half-spaces are needed
dtype = 'float32': cannot hold
mean_pressure = .*: at least .*float32
""",
    "stress": rf"""{STRESSED}
poisson = .*: (.*, as in the contact|given . times)
poisson: one of
poisson has the shape
depths\[\d\] = .*: a depth from 0 to
box of .* GiB are accepted
[xy] = .*: a pair .* of rising positions
spacing = .*: a number of at least
at = .*: a position from
""",
    "surface": r"""
wavelength_short = .*: at least two nodes
skewness = .*: no Johnson curve
wavelength_long = .*: no wave
""",
    "treatment": TREATED,
    "run": rf"""{TREATED}{STRESSED}
sliding\.direction = .* stress cycles
sliding\.friction = .* which bears no shear
conduction: a counter_body is needed
conduction: conductivity or resistivity of both bodies
(counter_)?body\.(conductivity|resistivity): missing
(counter_)?body\.layers: not accepted
(counter_)?body\.layers\.\d\.(residual_stress|strength\.\w+): not accepted
(counter_)?body\.fatigue_torsion: not accepted with several
load_curve\.loads = .*: a list of rising values
contact_area_fraction = .*: less is needed
load\.normal_approach = .*: (less than|a length from)
load\.\w+ = .*: a mean pressure (of less|below the hardness)
length = .*: spacings of the nodes
""",
}
"""Property → begins of refusals of arguments that are in their ranges, but do not go together, a line each.
Without an entry every refusal counts as one."""

PROPERTIES = {
    "family": (engineered, try_family),
    "contact": (contacts, try_contact),
    "mirrored": (mirrored_maps, try_mirrored),
    "adhesion": (adhesive_contacts, try_adhesion),
    "dilute": (dilute_contacts, try_dilute),
    "bound": (random_pressure.pressures, try_bound),
    "stress": (stresses, try_stress),
    "surface": (surfaces, try_surface),
    "treatment": (treated, try_treatment),
    "run": (cases, try_run),
    "command": (random_input.command_lines(), try_command),
    "config": (random_input.configurations() | random_input.unknown_keys(), random_input.require_checked),
    "map": (map_files(), try_map),
    **ANSWERS,
}
