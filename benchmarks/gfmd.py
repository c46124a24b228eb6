"""How many steps the damped dynamics takes: by damping, by load, by grid; and what a mass by mode does.

    python benchmarks/gfmd.py [damping] [eq17] [steps] [mass]

Without arguments all four, in about three minutes on one core. Steps are those to a residual of 1e-6.
"""

import sys

import numpy as np

import asperity as asp
from asperity.contact import gfmd
from asperity.contact.problem import Control, Problem
from asperity.elasticity.layer import Layer
from asperity.errors import ConvergenceError
from asperity.reference.pivoting import pivot
from asperity.spectral import Grid, Work

HALF_SPACE = Layer(1.0, 0.0)
SLAB = Layer(1.0, 0.0, 1.0)
FACTORS = (0.3, 0.5, 0.7, 0.99, 1.2, 1.5, 2.0)
LOADS = (0.002, 0.005, 0.01, 0.02, 0.05, 0.2)
TOLERANCE = 1e-6


def rough(points):
    return asp.self_affine((points, points), 0.8, 1 / 4, 8 / points, 1e-3, seed=1)


def paraboloid(points):
    x = Grid((points, points)).coordinates()[1] - 0.5
    return (x[:, None] ** 2 + x[None, :] ** 2) / 2


def steps(height, layer, control, damping):
    """Steps to rest, with damping over the critical one of the slowest mode; NaN without rest."""
    problem = Problem(height, layer, Grid(height.shape), "float64", 1, Work())
    try:
        return gfmd.solve(problem, control, TOLERANCE, None, None, damping).iterations
    except ConvergenceError:
        return np.nan


def row(name, values, form="9.0f"):
    print(f"{name:32}" + "".join(f"{value:{form}}" for value in values))


def damping(points=128):
    """Steps against the damping, with the critical damping as corrected and with that printed, none."""
    height = rough(points)
    gradient = asp.roughness_parameters(height).rms_gradient
    print(f"Steps by damping over the critical one of the slowest mode, {points}²; nan: no rest in 20 000")
    row("solid, imposed", (0.0, *FACTORS), "9.2f")
    cases = {f"half-space, load {load:g} E* g": (HALF_SPACE, "mean_pressure", load) for load in LOADS[1:]}
    cases["slab, load 0.05 E* g"] = (SLAB, "mean_pressure", 0.05)
    cases["slab, half the approach"] = (SLAB, "approach", None)
    for name, (layer, kind, load) in cases.items():
        value = 0.5 * height.min() if load is None else load * gradient
        found = [steps(height, layer, Control(kind, value), factor) for factor in (0.0, *FACTORS)]
        row(name, found)


def eq17(points=128):
    """The damping that takes the fewest steps, and the exponent of the load in it."""
    height = rough(points)
    gradient = asp.roughness_parameters(height).rms_gradient
    softest = np.pi
    print(f"\nBest damping by load, half-space, {points}², against what the slowest mode suggests (Eq. 17)")
    row("load / (E* g)", LOADS, "9.3f")
    factors = np.geomspace(0.2, 5, 29)
    own = [min(softest, load * gradient / (0.5 * height.std())) for load in LOADS]
    best, fewest = [], []
    for load, stiffness in zip(LOADS, own, strict=True):
        found = np.array(
            [steps(height, HALF_SPACE, Control("mean_pressure", load * gradient), f) for f in factors]
        )
        # The middle of the factors that take no more than a step of the residual's stride longer.
        good = factors[found <= np.nanmin(found) + gfmd.STRIDE]
        best.append(np.sqrt(good[0] * good[-1]) * 2 * np.sqrt(stiffness))
        fewest.append(np.nanmin(found))
    row("slowest mode's, units √(E*/mL)", 2 * np.sqrt(own), "9.2f")
    row("best", best, "9.2f")
    row("steps with it", fewest)
    slope = np.polyfit(np.log(LOADS), np.log(best), 1)[0]
    below = np.polyfit(np.log(LOADS[:4]), np.log(best[:4]), 1)[0]
    print(f"exponent of the load in the best: {slope:.2f}; below 0.02: {below:.2f} (contact stiffness: 0.5)")


def grids(sizes=(64, 128, 256, 512, 1024)):
    """Steps by grid for a paraboloid and a rough surface whose waves stay the same."""
    print("\nSteps by nodes on an edge")
    row("surface", sizes)
    surfaces = {
        "paraboloid": (paraboloid, 0.02),
        "rough, fixed waves": (lambda n: asp.self_affine((n, n), 0.8, 1 / 4, 1 / 16, 1e-3, seed=1), None),
    }
    for name, (make, load) in surfaces.items():
        found = []
        for points in sizes:
            height = make(points)
            pressure = load or 0.05 * asp.roughness_parameters(height).rms_gradient
            found.append(steps(height, HALF_SPACE, Control("mean_pressure", pressure), gfmd.DAMPING))
        row(name, found)
        print(f"{'':32}exponent {np.polyfit(np.log(sizes), np.log(found), 1)[0]:.2f}")


def mass(points=64, most=4000):
    """Where a clamp in real space comes to rest if the mass of a mode follows a power of its stiffness."""
    height = paraboloid(points)
    load = 0.02
    grid = Grid(height.shape)
    stiffness = grid.wavenumber() / 2
    true = pivot(height, HALF_SPACE.surface_compliance(grid.wavenumber()), mean_pressure=load)
    print(f"\nArea fraction at rest with a mass ~ stiffness^s, paraboloid, {points}²")
    print(f"direct: area fraction {np.mean(true > 0):.4f}")
    for power in (0.0, 0.25, 0.5, 1.0):
        inertia = np.maximum(stiffness, stiffness[0, 1]) ** power
        area, off = at_rest(height, load, stiffness, inertia, most)
        print(
            f"s = {power:4.2f}: area fraction {area:.4f}, traction off the contact {off:.1e} of the largest"
        )


def at_rest(height, load, stiffness, inertia, most):
    """Area fraction and largest traction off the contact after many steps."""
    frequency = stiffness / inertia
    squared_step = 0.81 * 4 / frequency.max()
    kappa = frequency[frequency > 0].min() * squared_step
    gamma = 2 * np.sqrt(kappa - kappa**2 / 4)
    push = np.zeros_like(stiffness)
    push[0, 0] = load * height.size
    wall = -height
    now = before = np.fft.rfft2(np.maximum(np.zeros_like(wall), wall))
    for _ in range(most):
        force = -(stiffness * now + push) / inertia
        after = (2 * now - (1 - gamma / 2) * before + squared_step * force) / (1 + gamma / 2)
        displacement = np.maximum(np.fft.irfft2(after, height.shape), wall)
        now, before = np.fft.rfft2(displacement), now
    traction = np.fft.irfft2(stiffness * now + push, height.shape)
    contact = displacement == wall
    return contact.mean(), np.abs(traction[~contact]).max() / traction.max()


if __name__ == "__main__":
    tables = {"damping": damping, "eq17": eq17, "steps": grids, "mass": mass}
    for name in sys.argv[1:] or tables:
        tables[name]()
