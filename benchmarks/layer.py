"""Accuracy and speed of the elastic layer, and the effect of the uniform mode: three tables.

    python benchmarks/layer.py [accuracy] [speed] [uniform]

Without arguments all three are printed, in about two minutes on one core.
"""

import sys
from dataclasses import replace

import one_thread  # noqa: F401

# isort: split

import numpy as np
from timing import seconds

import asperity as asp
from asperity.elasticity.layer import Layer
from asperity.spectral import Fourier, Grid
from asperity.stress.depths import depth_grid
from asperity.stress.planes import stress_planes
from asperity.validation.rounding import PRECISIONS, layer_errors

HEIGHTS = [1e-8, 1e-6, 1e-4, 1e-2, 0.1, 0.5, 0.99, 1.0, 1.01, 2.0, 5.0, 10.0, 39.0, 41.0, 300.0, 1e3, 1e5]
RATIOS = [-0.99, -0.7, -0.3, 0.0, 0.2, 0.33, 0.45, 0.499999, 0.5]
MEASURES = ("compliance", "stress", "displacement", "face_compliance")


def accuracy():
    """Print the largest error of each quantity over all q · height, ν and depths."""
    print("Largest errors (asperity.validation.rounding.layer_errors defines what each is relative to)")
    print(f"{'bottom':14}{'precision':11}" + "".join(f"{name:>17}" for name in MEASURES))
    for bottom in ("half-space", "bonded", "frictionless", "free"):
        for precision in PRECISIONS:
            worst = dict.fromkeys(MEASURES, float("nan"))
            for poisson in RATIOS:
                for height in HEIGHTS if bottom != "half-space" else [None]:
                    support = "bonded" if height is None else bottom
                    for name, error in layer_errors(height, support, poisson, precision).items():
                        worst[name] = max(error, np.nan_to_num(worst[name]))
            cells = "".join(f"{worst[name]:17.1e}" if worst[name] >= 0 else f"{'-':>17}" for name in MEASURES)
            print(f"{bottom:14}{precision:11}{cells}")


def speed(points=2048):
    """Print the time of all five kernels of a grid at one depth, in units of one real transform."""
    grid = Grid((points, points))
    solids = {
        "half-space": (Layer(1.0, 0.33), 0.002),
        "bonded, height 1": (Layer(1.0, 0.33, 1.0), 0.002),
        "frictionless, height 1": (Layer(1.0, 0.33, 1.0, "frictionless"), 0.002),
        "bonded, height 0.01": (Layer(1.0, 0.33, 0.01), 0.002),
        "frictionless, height 0.01": (Layer(1.0, 0.33, 0.01, "frictionless"), 0.002),
        "bonded, height 0.0001": (Layer(1.0, 0.33, 1e-4), 2e-5),
        "frictionless, height 0.0001": (Layer(1.0, 0.33, 1e-4, "frictionless"), 2e-5),
    }
    print(f"\nTime of all kernels of {points}² at one depth, in units of one real transform")
    print(f"{'solid':28}" + "".join(f"{precision:>10}" for precision in PRECISIONS))
    ratios = {name: [] for name in solids}
    for precision in PRECISIONS:
        fourier = Fourier(grid, precision)
        field = np.random.default_rng(1).random(grid.shape).astype(precision)
        out = np.empty(grid.half_shape, fourier.complex)
        transform = seconds(lambda f=fourier, v=field, o=out: f.forward(v, o))
        q = grid.wavenumber()[: points // 2 + 1].astype(precision)
        for name, (layer, depth) in solids.items():
            ratios[name].append(seconds(lambda s=layer, d=depth, q=q: s.kernels(q, d)) / transform)
    for name, values in ratios.items():
        print(f"{name:28}" + "".join(f"{value:10.2f}" for value in values))


def uniform(points=256):
    """Print the largest von Mises stress in a laterally free cell divided by that in a confined one."""
    height = asp.self_affine(
        (points, points),
        hurst=0.8,
        wavelength_long=1 / 4,
        wavelength_short=8 / points,
        rms_height=1e-3,
        seed=1,
    )
    print(f"\nLargest von Mises stress, laterally free divided by confined; rough, {points}², half-space")
    print(
        f"{'area fraction':>14}{'ν':>7}{'all depths':>13}{'depth L/16':>13}{'depth L/4':>13}{'depth L/2':>13}"
    )
    for mean_pressure in (0.0005, 0.0025, 0.01):
        contact = asp.solve(height, Layer(1.0, 0.33), mean_pressure=mean_pressure)
        depths = np.unique([*depth_grid(contact.grid, 0.5), 1 / 16, 1 / 4, 1 / 2])
        ratios = (0.0, 0.25, 0.33, 0.5)
        peaks = {}
        for lateral in ("confined", "free"):
            solid = replace(contact, solid=replace(contact.layer, lateral=lateral))
            planes = stress_planes(solid, depths, ratios)
            peaks[lateral] = np.array([p.fields["von_mises"].max(axis=(1, 2)) for p in planes])
        chosen = [np.flatnonzero(depths == d)[0] for d in (1 / 16, 1 / 4, 1 / 2)]
        for n, nu in enumerate(ratios):
            free, confined = peaks["free"][:, n], peaks["confined"][:, n]
            values = [free.max() / confined.max(), *(free[chosen] / confined[chosen])]
            print(f"{contact.area_fraction:14.3f}{nu:7.2f}" + "".join(f"{value:13.4f}" for value in values))


if __name__ == "__main__":
    tables = {"accuracy": accuracy, "speed": speed, "uniform": uniform}
    for name in sys.argv[1:] or tables:
        tables[name]()
