"""The functions that numba compiles, compiled before they are needed.

Numba compiles a function when it is first called with some types, and keeps the code where other processes
find it. For the whole library that takes some twenty seconds, and 150 MB that the calculation itself does not
need: done once, it is spared to the jobs of a study, which would all do it at the same time.
"""

from __future__ import annotations

import platform
import sys
from dataclasses import replace
from importlib.metadata import version
from itertools import product
from typing import Any

import numpy as np
from numba.core.registry import CPUDispatcher, cpu_target

from asperity import __version__
from asperity.contact import METHODS, solve
from asperity.elasticity.layer import Layer
from asperity.spectral import Grid
from asperity.stress.analysis import analyse_stress
from asperity.stress.depths import depth_grid
from asperity.stress.pressed import PressedSolid
from asperity.surface.roughness import self_affine
from asperity.validation.extremes import Scene, attempt

PACKAGES = ("numba", "llvmlite", "numpy")
"""On whose versions the code depends besides."""

PRECISIONS = ("float32", "float64")

LAYERS = (
    Layer(1.0, 0.33),
    Layer(1.0, 0.33, height=1.0),
    Layer(1.0, 0.33, height=1.0, bottom="frictionless"),
)

DEPTH_TOLERANCES = (1e-2, 1e-6)
"""Planes are in single precision at the one, in double precision at the other."""

RARE = (Scene(imposed=("approach", 0.5)), Scene(scaled_height=1e-6, points=64))
"""Contacts that take steps which others do not: at a given approach, and to be damped on a thin layer."""


def compile_contact() -> None:
    """Call every function of the contact with all types that a study gives it, on small scenes."""
    height = self_affine((32, 32), 0.8, 0.5, 0.125, 1e-3, seed=1)
    for precision, method, layer in product(PRECISIONS, METHODS, LAYERS):
        solve(height, layer, area_fraction=0.1, method=method, rtol=1e-4, dtype=precision)
    for precision in PRECISIONS:
        free = solve(height, LAYERS[0], area_fraction=0.1, boundary="free", rtol=1e-4, dtype=precision)
        assert free.gradient_rms_contact > 0
    for precision, scene in product(PRECISIONS, RARE):
        attempt(replace(scene, precision=precision))


def compile_stress() -> None:
    """The same with the functions of the stress, its peaks and the layer."""
    height = self_affine((32, 32), 0.8, 0.5, 0.125, 1e-3, seed=1)
    grid = Grid(height.shape)
    for layer, tolerance in product(LAYERS, DEPTH_TOLERANCES):
        contact = PressedSolid(np.maximum(-height, 0.0), grid, layer)
        depths = depth_grid(grid, layer.height, spacing=2.0)
        analyse_stress(contact, depths, None if layer.height else (0.0, 0.5), tolerance=tolerance)
    wavenumbers = np.array([1.0, 2.0])
    layer.compliance(wavenumbers, 0.0)
    layer.stress(wavenumbers[:, None], 0.0, np.zeros((2, 2)))


PARTS = {"contact": compile_contact, "stress": compile_stress}
"""Which have hardly a function in common, and can be compiled at the same time."""


def compiled_functions() -> dict[str, Any]:
    """Every function of the imported modules of this package that numba compiles, by module and name."""
    modules = {name: module for name, module in sys.modules.items() if name.startswith("asperity.")}
    return {
        f"{name}.{function.py_func.__name__}": function
        for name, module in modules.items()
        for function in list(vars(module).values())
        if isinstance(function, CPUDispatcher) and function.__module__ == name
    }


def describe(part: str) -> str:
    """What is compiled, with which versions and for which processor, for a reader."""
    _, processor, _ = cpu_target.target_context.codegen().magic_tuple()
    packages = ", ".join([f"asperity {__version__}", *(f"{name} {version(name)}" for name in PACKAGES)])
    return (
        f"The functions of the {part} are compiled, and kept beside the modules of the library:\n"
        f"{packages}, Python {platform.python_version()},\n"
        f"for {processor} ({platform.machine()}).\n"
    )
