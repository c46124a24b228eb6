"""The constants of the active-set solver that were found by trial: cost of half and of twice each value.

    python benchmarks/solver_constants.py [NAME ...]

prints the mean number of pairs of transforms and of iterations of solutions on rough surfaces of 512² nodes,
at imposed loads and areas. Without names, all constants are tried, in some minutes on one core.
"""

import sys
from importlib import import_module

import numpy as np
from contact import FRACTION, LAYER, load_on, rough

import asperity as asp

CONSTANTS = {
    "CUTOFF_POWER": "operators",
    "CELL_NODES": "operators",
    "COARSE_RESIDUAL_DROP": "operators",
    "RESIDUAL_DROP": "inner_solve",
    "SINGLE_PRECISION_ERROR": "active_set",
    "FINAL_ERROR": "active_set",
    "LEAST_RESIDUAL": "active_set",
    "LOAD_RESOLUTION": "load",
}
"""Constant → module below `asperity.contact`."""

POINTS = 512
FACTORS = (0.5, 1.0, 2.0)


def cost():
    """Mean number of pairs of transforms, and of iterations."""
    spent = []
    for hurst in (0.2, 0.8):
        height = rough(POINTS, hurst)
        load = {"mean_pressure": load_on(height, FRACTION)}
        for imposed in (load, {"contact_area_fraction": 0.01}, {"contact_area_fraction": 0.1}):
            certificate = asp.solve_contact(height, LAYER, **imposed).certificate
            spent.append((certificate.pairs, certificate.iterations))
    return np.mean(spent, axis=0)


def main():
    for name in sys.argv[1:] or CONSTANTS:
        module = import_module(f"asperity.contact.{CONSTANTS[name]}")
        value = getattr(module, name)
        for factor in FACTORS:
            setattr(module, name, type(value)(value * factor))
            try:
                pairs, iterations = cost()
                found = f"{pairs:7.2f} pairs {iterations:6.0f} iterations"
            except asp.ConvergenceError as error:
                found = str(error)
            print(f"{name:22} {value * factor:8g} {found}", flush=True)
        setattr(module, name, value)


if __name__ == "__main__":
    main()
