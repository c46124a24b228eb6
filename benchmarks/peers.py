"""Contact solvers and stresses of other programs (`pip install 'asperity[peers]'`).

The solvers are called as asperity's, for a rough surface on a half-space with E* = 1 and a cell of edge 1,
under a mean pressure, on one thread, and return the pressure. Each has its own definition of the tolerance.
ASPHER is built by pip from its source, which takes cmake, a C++17 compiler and Eigen (Debian: libeigen3-dev).

slippy 0.5.2 is not among them: it needs numpy before 1.21, which Python 3.11 cannot install, and its import
ends with an error on today's scipy.
"""

import importlib.util
import itertools
import os
import time
from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np

import asperity as asp
from asperity.core.types import Array
from asperity.fourier.grid import Fourier


def aspher(height: Array, load: float, setting: float, boundary: str, mode: str = "fft") -> Array:
    """Pressure by the nested grids of ASPHER, identified in single and polished in double precision.

    The setting is the tolerance of its certificate: Frank–Wolfe gap, penetration and load. Over a free
    boundary it transforms the padded map, or sums hierarchically over candidate nodes, which is faster where
    little touches. Its fastest mode, in single precision, has no tolerance; the setting is the order of the
    sums.
    """
    os.environ["OMP_NUM_THREADS"] = "1"  # read when the extension module is loaded
    import aspher

    settings: dict[str, Any] = {"backend": mode if boundary == "free" else "periodic", "tol": setting}
    if mode == "fft":
        settings["precision"] = "float_then_double"  # which candidates do not have
    else:
        settings["active_set"] = True
    if mode == "single":
        settings = {"backend": "h2", "active_set": True, "single_precision": True, "q": int(setting)}
        settings |= {"allow_tolerance_relaxation": True, "light_result": True}
    result = aspher.solve_nested(len(height), height.ravel(), load, **settings)
    return np.asarray(result.pressure).reshape(height.shape)


def tamaas(height: Array, load: float, tolerance: float, boundary: str) -> Array:
    """Pressure by the conjugate gradients of Polonsky and Keer in tamaas."""
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


def contact_mechanics(
    height: Array, load: float, tolerance: float, boundary: str, hardness: float | None = None
) -> Array:
    """Pressure by the conjugate gradients of Polonsky and Keer in ContactMechanics.

    The tolerance holds for the penetration, relative to the rms height.
    """
    import ContactMechanics
    from SurfaceTopography import PlasticTopography, Topography

    free = boundary == "free"
    half_spaces = ContactMechanics.PeriodicFFTElasticHalfSpace, ContactMechanics.FreeFFTElasticHalfSpace
    substrate = half_spaces[free](height.shape, 1.0, (1.0, 1.0))
    surface = Topography(-height, physical_sizes=(1.0, 1.0), periodic=not free)
    if hardness is None:
        system = ContactMechanics.make_system(substrate=substrate, surface=surface)
    else:
        surface = PlasticTopography(surface, hardness)
        system = ContactMechanics.make_plastic_system(substrate=substrate, surface=surface)
    result = system.minimize_proxy(
        external_force=load, pentol=tolerance * height.std(), thermotol=tolerance, maxiter=20_000
    )
    return np.asarray(result.jac) * height.size


def tamaas_adhesion(height: Array, adhesion: asp.Adhesion, mean_gap: float, tolerance: float) -> Array:
    """Pressure at a mean gap under the exponential law, by conjugate gradients on the gap of tamaas."""
    import tamaas

    tamaas.initialize(1)
    model = tamaas.ModelFactory.createModel(tamaas.model_type.basic_2d, [1.0, 1.0], list(height.shape))
    model.E, model.nu = 1.0, 0.0
    attraction = tamaas.ExponentialAdhesionFunctional(-height)
    attraction.parameters = {"rho": adhesion.range, "surface_energy": adhesion.work}
    kind = tamaas.PolonskyKeerRey
    solver = kind(model, -height, tolerance, kind.gap, kind.gap)
    solver.max_iter, solver.dump_freq = 100_000, 100_001
    solver.addFunctionalTerm(attraction)
    solver.solve(mean_gap)
    return np.array(model.traction)


SOLVERS: dict[str, Callable[[Array, float, float, str], Array]] = {
    "ASPHER": aspher,
    "ASPHER, candidate nodes": partial(aspher, mode="h2"),
    "ASPHER, single precision": partial(aspher, mode="single"),
    "tamaas": tamaas,
    "ContactMechanics": contact_mechanics,
}


def stress_difference(contact: asp.LoadedSolid, depths: Array) -> float:
    """Largest difference of the stress at the surface and some depths from tamaas, over the maximum pressure.

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
        size = [depth, *grid.length], [2, *grid.shape]
        model = tamaas.ModelFactory.createModel(tamaas.model_type.volume_2d, *size)
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
    name = program.split(",")[0]
    return importlib.util.find_spec(name.lower() if name == "ASPHER" else name) is not None


def adhesion_times(nodes: int, work: float, repeats: int = 3) -> list[tuple[str, float, float]]:
    """Program, least time and error of a rough contact with adhesion, against a solution to 1e-9."""
    height = asp.self_affine((nodes, nodes), 0.8, 0.5, 8 / nodes, rms_height=2e-3, seed=1)
    solid, approach = asp.Solid(1.0, 0.0), height.min() + 3e-3
    adhesion = asp.Adhesion.fitted(work, solid, asp.Grid(height.shape))

    def ours(rtol: float) -> Array:
        return asp.solve_contact(height, solid, approach=approach, adhesion=adhesion, rtol=rtol).pressure

    programs = {"asperity": lambda: ours(1e-6)}
    gap = height.mean() - approach
    programs["tamaas"] = lambda: tamaas_adhesion(height, adhesion, gap, 5e-6)
    exact, times, errors = ours(1e-9), {}, {}
    for _ in range(repeats):
        for name, solve in programs.items():
            begin = time.perf_counter()
            pressure = solve()
            times.setdefault(name, []).append(time.perf_counter() - begin)
            errors[name] = float(np.linalg.norm(pressure - exact) / np.linalg.norm(exact))
    return [(name, min(each), errors[name]) for name, each in times.items()]


if __name__ == "__main__":  # adhesion beside tamaas
    for nodes, work in itertools.product((128, 256), (1e-6, 1e-5, 3e-5)):
        for name, seconds, error in adhesion_times(nodes, work):
            print(f"{nodes}² nodes, w = {work:g} E* L: {name} {seconds:.2f} s, error {error:.1e}")
