"""Random surfaces and pressures, with the true error of a pressure beside the bound of its certificate."""

import numpy as np
from hypothesis import strategies as st

import asperity as asp
from asperity.reference.pivoting import pivot

SOLIDS = (
    asp.Solid(1.0, 0.0),
    asp.Solid(1.0, 0.3, height=1.0),
    asp.Solid(1.0, 0.5, height=0.02),
    asp.Solid(1.0, 0.3, height=0.003),
    asp.Solid(1.0, 0.3, height=0.3, bottom="free"),
)

pressures = st.fixed_dictionaries(
    {
        "shape": st.tuples(st.integers(1, 24), st.integers(2, 24)),
        "length": st.tuples(st.floats(0.1, 10), st.floats(0.1, 10)),
        "seed": st.integers(0, 2**32),
        "power": st.sampled_from([0, 1, 2]),
        "exponent": st.integers(-40, 40),
        "offset": st.sampled_from([0.0, 1.0, 1e3]),
        "solid": st.sampled_from(SOLIDS),
        "load": st.floats(-6, 1),
        "change": st.sampled_from(["noise", "shift", "node", "start", "solve"]),
        "size": st.floats(-9, 3),
    }
)


def error_and_bound(case):
    """Square of the energy norm of a pressure's error over load × rms height, its bound, and its rounding.

    The waves of the surface decay with a power of their number; its heights are multiplied by a power of two
    and stand on an offset. The exact pressure of the same load is the direct solution by principal pivoting.
    """
    generator, (ny, nx) = np.random.default_rng(case["seed"]), case["shape"]
    noise = np.fft.rfft2(generator.standard_normal(case["shape"]))
    wave = np.hypot(np.fft.fftfreq(ny, 1 / ny)[:, None], np.arange(nx // 2 + 1))
    height = np.fft.irfft2(noise / np.maximum(wave, 1) ** case["power"], case["shape"])
    height = (height / height.std() + case["offset"]) * 2.0 ** case["exponent"]
    solid, grid = case["solid"], asp.Grid(case["shape"], case["length"])
    modes = solid.surface_compliance(grid.wavenumber())
    rms, size = float(height.std()), 10.0 ** case["size"]
    load = 10.0 ** case["load"] * rms / max(grid.length) * solid.effective_modulus
    exact = pivot(height, modes, mean_pressure=load)
    if case["change"] == "solve":
        pressure = asp.solve_contact(
            height, solid, grid.length, mean_pressure=load, rtol=min(size, 0.5)
        ).pressure
    else:
        node = generator.integers(grid.size) == np.arange(grid.size).reshape(grid.shape)
        changed = {
            "noise": exact * (1 + size * generator.standard_normal(grid.shape)),
            "shift": np.roll(exact, 1, axis=1),
            "node": exact + size * load * grid.size * node,
            "start": size * load * generator.random(grid.shape),
        }[case["change"]]
        pressure = np.maximum(changed, 0)
    if not pressure.any():
        return 0.0, 0.0, 0.0
    exact = pivot(height, modes, mean_pressure=float(pressure.mean()))
    displacement, wrong = np.fft.irfft2(modes * np.fft.rfft2(pressure), grid.shape), pressure - exact
    energy = float(np.vdot(wrong, np.fft.irfft2(modes * np.fft.rfft2(wrong), grid.shape)))
    bound = asp.contact.verify_contact(height, pressure, solid, grid.length).error_bound
    rounding = 1e-11 * (np.abs(height).max() + np.abs(displacement).max()) / rms
    return energy / (float(pressure.sum()) * rms), bound, rounding
