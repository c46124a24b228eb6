"""Contact solvers and stresses of other programs (`pip install 'asperity[peers]'`).

The solvers are called like that of asperity, for a rough surface on a half-space with E* = 1 and a cell of
edge 1, under a mean pressure. Each has its own definition of the tolerance.
"""

from __future__ import annotations

import importlib.util
from collections.abc import Callable

import numpy as np

import asperity as asp
from asperity.core.types import Array
from asperity.fourier.grid import Fourier


def tamaas(height: Array, load: float, tolerance: float, boundary: str) -> Array:
    """Pressure by the conjugate gradients of Polonsky and Keer in tamaas, on one thread."""
    import tamaas

    tamaas.initialize(1)
    model = tamaas.ModelFactory.createModel(tamaas.model_type.basic_2d, [1.0, 1.0], list(height.shape))
    model.E, model.nu = 1.0, 0.0
    solver = tamaas.PolonskyKeerRey(model, -height, tolerance)
    if boundary == "free":
        tamaas.ModelFactory.registerNonPeriodic(model, "dcfft")
        solver.setIntegralOperator("dcfft")
    solver.max_iter = 20_000
    solver.dump_freq = 20_001
    solver.solve(load)
    return np.array(model.traction)


def contact_mechanics(height: Array, load: float, tolerance: float, boundary: str) -> Array:
    """Pressure by the conjugate gradients of Polonsky and Keer in ContactMechanics.

    The tolerance is that of the penetration, relative to the rms height.
    """
    import ContactMechanics
    from SurfaceTopography import Topography

    free = boundary == "free"
    half_spaces = ContactMechanics.PeriodicFFTElasticHalfSpace, ContactMechanics.FreeFFTElasticHalfSpace
    substrate = half_spaces[free](height.shape, 1.0, (1.0, 1.0))
    surface = Topography(-height, physical_sizes=(1.0, 1.0), periodic=not free)
    system = ContactMechanics.make_system(substrate=substrate, surface=surface)
    result = system.minimize_proxy(
        external_force=load, pentol=tolerance * height.std(), thermotol=tolerance, maxiter=20_000
    )
    return np.asarray(result.jac) * height.size


SOLVERS: dict[str, Callable[[Array, float, float, str], Array]] = {
    "tamaas": tamaas,
    "ContactMechanics": contact_mechanics,
}


def stress_difference(contact: asp.LoadedSolid, depths: Array) -> float:
    """Largest difference of the stress at the surface and some depths from tamaas, over the largest pressure.

    Nyquist modes, which tamaas keeps in its shear stresses, are left out of the pressure. In tamaas the first
    axis is y, z points downward, and shear components carry √2.
    """
    import tamaas

    grid, layer, fourier = contact.grid, contact.layer, Fourier(contact.grid)
    modes = fourier.forward(contact.pressure)
    modes[2 * np.abs(grid.ky) == grid.shape[0]] = 0
    modes[:, 2 * grid.kx == grid.shape[1]] = 0
    smooth = asp.LoadedSolid(fourier.inverse(modes), grid, layer)
    root = np.sqrt(2.0)
    factors = {"yy": 1, "xx": 1, "zz": 1, "xy": root, "yz": -root, "xz": -root}
    worst = 0.0
    for depth in depths:
        model = tamaas.ModelFactory.createModel(
            tamaas.model_type.volume_2d, [depth, *grid.length], [2, *grid.shape]
        )
        tamaas.ModelFactory.registerVolumeOperators(model)
        model.E, model.nu = layer.young, layer.poisson
        model.traction[...] = 0
        model.traction[..., 2] = smooth.pressure
        gradient, stress = (np.zeros([2, *grid.shape, 6]) for _ in range(2))
        model.operators["boussinesq_gradient"](model.traction, gradient)
        model.operators["hooke"](gradient, stress)
        planes = asp.stress_planes(smooth, [0.0, depth], None, list(factors), 0)
        for number, plane in enumerate(planes):
            for component, (name, factor) in enumerate(factors.items()):
                difference = stress[number, ..., component] / factor - plane.fields[name][0]
                worst = max(worst, float(np.abs(difference).max()))
    return worst / float(smooth.pressure.max())


def is_installed(program: str) -> bool:
    """True if a program can be run here."""
    return importlib.util.find_spec(program) is not None
