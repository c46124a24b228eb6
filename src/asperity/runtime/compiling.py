"""Compilation of the numba functions of the package before the jobs of a study need them.

Numba compiles a function when it is first called with arguments of some types, and keeps the machine code in
a file beside the module, where other processes find it. All functions together take some 25 s, and 150 MB of
memory that the calculation itself does not need. Compiling them once, before other jobs start, keeps these
jobs from compiling the same functions side by side.
"""

from __future__ import annotations

import gc
import platform
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from importlib.metadata import version
from itertools import product
from typing import Any

import numpy as np
from numba.core.registry import CPUDispatcher, cpu_target

from asperity import __version__
from asperity.contact import METHODS, solve, solve_path
from asperity.contact.inner_response import MIN_POINTS
from asperity.elasticity.layer import Layer
from asperity.spectral import Grid
from asperity.stress.analysis import analyse_stress
from asperity.stress.arguments import FIELDS
from asperity.stress.depths import depth_grid
from asperity.stress.planes import stress_planes
from asperity.stress.pressed import PressedSolid
from asperity.surface.self_affine import self_affine

PACKAGES = ("numba", "llvmlite", "numpy")
"""Packages besides this one on whose versions the machine code depends."""

PRECISIONS = ("float32", "float64")

LAYERS = (
    Layer(1.0, 0.33),
    Layer(1.0, 0.33, height=1.0),
    Layer(1.0, 0.33, height=1.0, bottom="frictionless"),
)

THIN_LAYER = Layer(1.0, 0.33, height=1e-7)
"""A layer so thin that the solver has to damp its steps."""

DEPTH_TOLERANCES = (1e-2, 1e-6)
"""Tolerances with which stress planes are computed in single and in double precision."""


@contextmanager
def _collecting_seldom() -> Iterator[None]:
    """Let the garbage collector run seldom: the objects of numba live long, and it looks at all of them."""
    usual = gc.get_threshold()
    gc.set_threshold(200_000, *usual[1:])
    try:
        yield
    finally:
        gc.set_threshold(*usual)


@_collecting_seldom()
def compile_contact() -> None:
    """Call every compiled function of the contact solvers with all types that a study uses."""
    height = self_affine((32, 32), 0.8, 0.5, 0.125, 1e-3, seed=1)
    for precision, method, layer in product(PRECISIONS, METHODS, LAYERS):
        solve(height, layer, area_fraction=0.1, method=method, rtol=1e-4, dtype=precision)
    fine = self_affine((64, 64), 0.8, 0.5, 0.0625, 1e-3, seed=1)
    divided = self_affine((MIN_POINTS, MIN_POINTS), 0.8, 0.5, 0.0625, 1e-3, seed=1)
    for precision in PRECISIONS:
        solve(height, LAYERS[0], approach=0.5 * height.min(), rtol=1e-4, dtype=precision)
        solve(fine, THIN_LAYER, area_fraction=0.1, rtol=1e-4, dtype=precision)
        solve(divided, LAYERS[0], area_fraction=0.1, rtol=1e-4, dtype=precision)
        free = solve(height, LAYERS[0], area_fraction=0.1, boundary="free", rtol=1e-4, dtype=precision)
        assert free.gradient_rms_contact > 0
    for contact in solve_path(height, LAYERS[0], area_fractions=(0.1, 0.11, 0.12), rtol=1e-4):
        assert contact.area_fraction > 0


@_collecting_seldom()
def compile_stress() -> None:
    """Call every compiled function of stress planes, peaks and layers in the same way."""
    height = self_affine((32, 32), 0.8, 0.5, 0.125, 1e-3, seed=1)
    grid = Grid(height.shape)
    for layer, tolerance in product(LAYERS, DEPTH_TOLERANCES):
        contact = PressedSolid(np.maximum(-height, 0.0), grid, layer)
        depths = depth_grid(grid, layer.height, spacing=2.0)
        analyse_stress(contact, depths, None if layer.height else (0.0, 0.5), tolerance=tolerance)
        friction = 0.0 if layer.bottom == "frictionless" else 0.3
        for _ in stress_planes(contact, depths[:2], fields=FIELDS, tolerance=tolerance, friction=friction):
            pass
    wavenumbers = np.array([1.0, 2.0])
    layer.compliance(wavenumbers, 0.0)
    layer.stress(wavenumbers[:, None], 0.0, np.zeros((2, 2)))


PARTS = {"contact": compile_contact, "stress": compile_stress}
"""Parts that share hardly a function and can be compiled at the same time."""


def compiled_functions() -> dict[str, Any]:
    """Every numba function of the imported modules of this package, by module and name."""
    modules = {name: module for name, module in sys.modules.items() if name.startswith("asperity.")}
    return {
        f"{name}.{function.py_func.__name__}": function
        for name, module in modules.items()
        for function in list(vars(module).values())
        if isinstance(function, CPUDispatcher) and function.__module__ == name
    }


def describe(part: str) -> str:
    """Text that states what is compiled, with which versions and for which processor."""
    _, processor, _ = cpu_target.target_context.codegen().magic_tuple()
    packages = ", ".join([f"asperity {__version__}", *(f"{name} {version(name)}" for name in PACKAGES)])
    return (
        f"The functions of the {part} are compiled; their machine code lies beside the modules.\n"
        f"{packages}, Python {platform.python_version()},\n"
        f"for {processor} ({platform.machine()}).\n"
    )
