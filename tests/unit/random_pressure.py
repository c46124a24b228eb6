"""Random surfaces and pressures, with the true error of a pressure beside the bound of its certificate."""

import numpy as np
from hypothesis import strategies as st

import asperity as asp
from asperity.reference.pivoting import pivot

SOLIDS = (
    asp.Layer(1.0, 0.0),
    asp.Layer(1.0, 0.3, height=1.0),
    asp.Layer(1.0, 0.5, height=0.02),
    asp.Layer(1.0, 0.3, height=0.003),
    asp.Layer(1.0, 0.3, height=0.3, bottom="free"),
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
        "change": st.sampled_from(["noise", "wave", "shift", "node", "start", "solve"]),
        "size": st.floats(-9, 3),
    }
)


def height_of(case):
    """A surface whose waves decay with a power of their number, times a power of two, on an offset."""
    generator = np.random.default_rng(case["seed"])
    noise = np.fft.rfft2(generator.standard_normal(case["shape"]))
    ny, nx = case["shape"]
    wave = np.hypot(np.fft.fftfreq(ny, 1 / ny)[:, None], np.arange(nx // 2 + 1))
    height = np.fft.irfft2(noise / np.maximum(wave, 1) ** case["power"], case["shape"])
    return (height / height.std() + case["offset"]) * 2.0 ** case["exponent"], generator


def error_and_bound(case):
    """Square of the energy norm of a pressure's error over load × rms height, its bound, and its rounding.

    The exact pressure of the same load is the direct solution by principal pivoting.
    """
    height, generator = height_of(case)
    solid, grid = case["solid"], asp.Grid(case["shape"], case["length"])
    modes = solid.surface_compliance(grid.wavenumber())
    rms, size = float(height.std()), 10.0 ** case["size"]
    load = 10.0 ** case["load"] * rms / max(grid.length) * solid.effective_modulus
    exact = pivot(height, modes, mean_pressure=load)
    y, x = np.indices(grid.shape)
    waves = generator.integers(3, size=2) / grid.shape
    node = generator.integers(grid.size) == np.arange(grid.size).reshape(grid.shape)
    if case["change"] == "solve":
        pressure = asp.solve(height, solid, grid.length, mean_pressure=load, rtol=min(size, 0.5)).pressure
    else:
        changed = {
            "noise": exact * (1 + size * generator.standard_normal(grid.shape)),
            "wave": exact * (1 + size * np.cos(2 * np.pi * (waves[0] * y + waves[1] * x))),
            "shift": np.roll(exact, 1, axis=1),
            "node": exact + size * load * grid.size * node,
            "start": size * load * generator.random(grid.shape),
        }[case["change"]]
        pressure = np.maximum(changed, 0)
    if not pressure.any():
        return 0.0, 0.0, 0.0
    exact = pivot(height, modes, mean_pressure=float(pressure.mean()))
    displacement = np.fft.irfft2(modes * np.fft.rfft2(pressure), grid.shape)
    wrong = pressure - exact
    energy = float(np.vdot(wrong, np.fft.irfft2(modes * np.fft.rfft2(wrong), grid.shape)))
    bound = asp.verify_contact(height, pressure, solid, grid.length).error_bound
    rounding = 1e-11 * (np.abs(height).max() + np.abs(displacement).max()) / rms
    return energy / (float(pressure.sum()) * rms), bound, rounding
