"""Promises of the numbers of a contact: spots, stiffness in full contact, estimates for vanishing pixels."""

import math
from types import SimpleNamespace

import numpy as np
from hypothesis import strategies as st
from inputs import require

import asperity as asp
from asperity import engineering
from asperity.engineering.answer_numbers import contact_spots
from asperity.fourier.grid import Grid
from asperity.surface.treatment.treatment import TreatedMap

COVERED = 0.5
"""Share of the stated errors of one surface that cover the true ones, at least; on average it is 0.96."""

# Spots

SIZES = ["area_m2", "length_m", "width_m"]
spots = st.fixed_dictionaries(
    {
        "shape": st.tuples(st.integers(4, 24), st.integers(4, 24)),
        "ends": st.tuples(*[st.floats(0, 1)] * 4),
        "shift": st.tuples(st.integers(0, 23), st.integers(0, 23)),
    }
)


def spots_of(touching, boundary):
    """Spots of a pressure of one where nodes touch."""
    pressure = touching.astype(float)
    face = TreatedMap(pressure, Grid(pressure.shape), 0.1, None, boundary=boundary)
    return contact_spots(face, SimpleNamespace(pressure=pressure))


def try_spots(case):
    """A spot of two bars with a common corner is the same wherever it lies on a periodic cell."""
    ny, nx = case["shape"]
    top, bottom, left, right = (
        int(end * (n - 2)) for end, n in zip(case["ends"], (ny, ny, nx, nx), strict=True)
    )
    touching = np.zeros((ny, nx), bool)
    touching[min(top, bottom) : max(top, bottom) + 1, left] = True
    touching[top, min(left, right) : max(left, right) + 1] = True
    alone = spots_of(touching, "free")[SIZES].to_numpy()
    moved = spots_of(np.roll(touching, case["shift"], (0, 1)), "periodic")[SIZES].to_numpy()
    require(alone.shape == moved.shape and np.allclose(alone, moved), "a spot is another where it is moved")


# Full contact

full = st.fixed_dictionaries(
    {
        "shape": st.tuples(st.integers(4, 33), st.integers(4, 33)),
        "kind": st.sampled_from(["flat", "waves", "noise"]),
        "seed": st.integers(0, 100),
        "height": st.none() | st.floats(1e-5, 1e-2),
        "steps": st.booleans(),
    }
)


def try_full(case):
    """Stiffness in full contact is that of the mean strain, infinite on a half-space; the answer stands."""
    ny, nx = case["shape"]
    y, x = np.indices((ny, nx))
    waves = np.cos(2 * np.pi * x / nx) + np.cos(2 * np.pi * y / ny)
    noise = np.random.default_rng(case["seed"]).standard_normal((ny, nx))
    height = 1e-9 * {"flat": 0 * waves, "waves": waves, "noise": noise}[case["kind"]]
    body = {"young": 2e11, "poisson": 0.3, "height": case["height"]}
    load = 1e12  # far above the pressure that flattens the heights
    contact = asp.solve(height, asp.Layer(**body), 1e-3, mean_pressure=load)
    require(contact.area_fraction == 1, "a node is out of contact")
    expected = math.inf if case["height"] is None else 2e11 * 0.7 / (1.3 * 0.4) / case["height"]
    require(math.isclose(contact.stiffness, expected, rel_tol=1e-6), "another stiffness in full contact")
    if case["height"] is None:
        require(contact.conductance(1.0) == math.inf, "a finite conductance in full contact")
        if case["kind"] != "flat":
            surface = asp.HeightMap(height, (1e-3, 1e-3), periodic=True, unit="m", name="fuzz")
            metal = engineering.Body(2e11, 0.3, conductivity=50.0)
            loads = [load / 2, load] if case["steps"] else load
            try:
                answer = engineering.run(surface, metal, metal, mean_pressure=loads)
            except ValueError as error:
                require(False, f"the answer of full contact is refused: {error}")
            require("infinite" in answer.text(), "the answer does not tell that the conductance is infinite")


# Estimates for vanishing pixels

estimated = st.fixed_dictionaries(
    {
        "nodes": st.sampled_from([4, 8]),
        "hurst": st.floats(0.1, 0.95),
        "seed": st.integers(0, 2**31),
        "area_fraction": st.floats(0.02, 0.95),
    }
)


def try_estimated(case):
    """Most stated errors for vanishing pixels cover the true ones, found with four times finer pixels."""
    layer = asp.Layer(young=1.0, poisson=0.33)

    def estimates(nodes, **load):
        points = 8 * nodes
        height = asp.self_affine(
            (points, points), case["hurst"], 1 / 2, 1 / 8, rms_height=1e-3, seed=case["seed"]
        )
        contact = asp.solve(height, layer, **load)
        return contact, asp.continuum(
            contact, asp.analyse_stress(contact, quantities=("pressure", "von_mises"))
        )

    contact, found = estimates(case["nodes"], area_fraction=case["area_fraction"])
    if found.attrs.get("reason"):
        return "no estimate"
    truth = estimates(4 * case["nodes"], mean_pressure=contact.mean_pressure)[1]
    if truth.attrs.get("reason"):
        return "no estimate"
    best = truth.sel(kind="estimate")
    true = abs(found.sel(kind="estimate") / best - 1)
    over = np.concatenate([(true[name] / found[name].sel(kind="error")).values.ravel() for name in found])
    covered = float(np.mean(over[~np.isnan(over)] <= 1))
    require(covered >= COVERED, f"stated errors cover {100 * covered:.0f} % of the true ones")
    return None


PROPERTIES = {
    "spots": (spots, try_spots),
    "full": (full, try_full),
    "estimates": (estimated, try_estimated),
}
