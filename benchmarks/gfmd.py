"""Steps of the damped dynamics by load and grid, and its fixed point if masses depend on the mode.

    python benchmarks/gfmd.py [eq17] [steps] [mass]

Without arguments it prints all three tables, in about three minutes on one core. Steps are those to a
residual of 1e-6.
"""

import sys

import numpy as np

import asperity as asp
from asperity.contact import gfmd
from asperity.contact.problem import Control, Problem
from asperity.contact.response import response_on
from asperity.core.errors import ConvergenceError
from asperity.elasticity.solid import Solid
from asperity.fourier.grid import Grid
from asperity.reference.pivoting import pivot

HALF_SPACE = Solid(1.0, 0.0)
LOADS = (0.002, 0.005, 0.01, 0.02, 0.05, 0.2)
TOLERANCE = 1e-6


def rough(points):
    return asp.self_affine((points, points), 0.8, 1 / 4, 8 / points, 1e-3, seed=1)


def steps_to_rest(height, layer, control, damping_fraction):
    """Number of steps until the surface is at rest; NaN if it is not after `gfmd.MAX_STEPS`.

    The damping is given as a fraction of the critical damping of the slowest mode.
    """
    response = response_on("periodic", layer, Grid(height.shape), omits_mean=control.fixes_load)
    problem = Problem(height, response)
    try:
        return gfmd.solve(problem, control, TOLERANCE, None, None, damping_fraction).iterations
    except ConvergenceError:
        return np.nan


def print_row(name, values, form="9.0f"):
    print(f"{name:32}" + "".join(f"{value:{form}}" for value in values))


def eq17(points=128):
    """Print the damping that takes the fewest steps, and the exponent of the load in it."""
    height = rough(points)
    gradient = asp.roughness_parameters(height).rms_gradient
    factors, best = np.geomspace(0.2, 5, 29), []
    for load in LOADS:
        control = Control("mean_pressure", load * gradient)
        found = np.array([steps_to_rest(height, HALF_SPACE, control, factor) for factor in factors])
        # The middle of the factors with the fewest steps, known to within one check of the residual.
        good = factors[found <= np.nanmin(found) + gfmd.STEPS_BETWEEN_CHECKS]
        slowest = min(np.pi, load * gradient / (0.5 * height.std()))
        best.append(np.sqrt(good[0] * good[-1]) * 2 * np.sqrt(slowest))
    print(f"\nDamping with the fewest steps, units √(E*/mL), half-space, {points}²")
    print_row("load / (E* g)", LOADS, "9.3f")
    print_row("best", best, "9.2f")
    print(f"exponent of the load: {np.polyfit(np.log(LOADS), np.log(best), 1)[0]:.2f}")


def grids(sizes=(64, 128, 256, 512)):
    """Print the steps by grid, for a rough surface with the same waves on every grid."""
    found = []
    for points in sizes:
        height = asp.self_affine((points, points), 0.8, 1 / 4, 1 / 16, 1e-3, seed=1)
        control = Control("mean_pressure", 0.05 * asp.roughness_parameters(height).rms_gradient)
        found.append(steps_to_rest(height, HALF_SPACE, control, gfmd.DAMPING_FRACTION))
    print("\nSteps by nodes on an edge")
    print_row("nodes", sizes)
    print_row("steps", found)
    print(f"exponent {np.polyfit(np.log(sizes), np.log(found), 1)[0]:.2f}")


def mass(points=64, steps=4000):
    """Print the contact at rest if the mass of a mode is a power of its stiffness."""
    grid, load = Grid((points, points)), 0.02
    x = grid.coordinates()[1] - 0.5
    height = (x[:, None] ** 2 + x[None, :] ** 2) / 2
    stiffness = grid.wavenumber() / 2
    exact = pivot(height, HALF_SPACE.surface_compliance(grid.wavenumber()), mean_pressure=load)
    print(f"\nArea fraction at rest with mass ~ stiffness^s, paraboloid, {points}²")
    print(f"direct solution: area fraction {np.mean(exact > 0):.4f}")
    for power in (0.0, 0.25, 0.5, 1.0):
        inertia = np.maximum(stiffness, stiffness[0, 1]) ** power
        area, off = at_rest(height, load, stiffness, inertia, steps)
        print(f"s = {power:4.2f}: area fraction {area:.4f}, largest traction outside the contact {off:.1e}")


def at_rest(height, load, stiffness, inertia, steps):
    """Area fraction and largest traction outside the contact after many steps."""
    frequency = stiffness / inertia
    squared_step = 0.81 * 4 / frequency.max()
    kappa = frequency[frequency > 0].min() * squared_step
    gamma = 2 * np.sqrt(kappa - kappa**2 / 4)
    push = np.zeros_like(stiffness)
    push[0, 0] = load * height.size
    wall = -height
    now = before = np.fft.rfft2(np.maximum(np.zeros_like(wall), wall))
    for _ in range(steps):
        force = -(stiffness * now + push) / inertia
        after = (2 * now - (1 - gamma / 2) * before + squared_step * force) / (1 + gamma / 2)
        displacement = np.maximum(np.fft.irfft2(after, height.shape), wall)
        now, before = np.fft.rfft2(displacement), now
    traction = np.fft.irfft2(stiffness * now + push, height.shape)
    contact = displacement == wall
    return contact.mean(), np.abs(traction[~contact]).max() / traction.max()


if __name__ == "__main__":
    tables = {"eq17": eq17, "steps": grids, "mass": mass}
    for name in sys.argv[1:] or tables:
        tables[name]()
