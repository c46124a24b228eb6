"""Stress and its peaks in a periodic half-space against Hertz."""

import numpy as np
import pytest
from samples import HALF_SPACE, order
from scipy.special import spherical_jn

import asperity as asp
from asperity.fourier.grid import Fourier
from asperity.stress.planes.planes import depth_grid


def hertz(radius, points, centre):
    """The pressure √(1 − r²/a²) from its exact Fourier transform: no discretisation error but the cut."""
    grid = asp.Grid((points, points))
    reach = grid.wavenumber() * radius
    shape = np.full(reach.shape, 1 / 3)
    np.divide(spherical_jn(1, reach), reach, out=shape, where=reach > 0)
    shift = np.exp(-1j * (grid.odd_qy[:, None] * centre[0] + grid.odd_qx[None, :] * centre[1]))
    return asp.LoadedSolid(Fourier(grid).inverse(2 * np.pi * radius**2 * shape * shift), grid, HALF_SPACE)


@pytest.mark.parametrize(
    ("poisson", "largest", "depth"), [(0.0, 0.7696, 0.3819), (0.3, 0.6200, 0.4809), (0.5, 0.5327, 0.5479)]
)
def test_maximum_von_mises_stress_and_its_depth(poisson, largest, depth):
    radius = 0.02
    depths = radius * np.arange(0.3, 0.66, 0.02)
    planes = asp.stress_planes(hertz(radius, 512, (0.5, 0.5)), depths, poisson, tolerance=1e-5)
    peaks = asp.stress.find_peaks(planes, "von_mises", floor=0.3)
    assert peaks.size == 1
    # Replicas of the contact: the mean pressure is 8e-4. Depth: the maximum is flat.
    assert peaks.value[0] == pytest.approx(largest, abs=8e-4)
    assert peaks.depth[0] / radius == pytest.approx(depth, abs=4e-3)
    assert (peaks.y[0], peaks.x[0]) == pytest.approx((0.5, 0.5), abs=1e-4)


def test_peaks_converge_with_the_grid():
    """Fixed contacts on three grids of 3–5, 6–11, 12–21 nodes to their diameter, against a fourth."""
    radii = np.array([0.03, 0.035, 0.04, 0.045, 0.05, 0.055])
    centres = np.array([(0.2, 0.2), (0.21, 0.52), (0.18, 0.81), (0.7, 0.19), (0.72, 0.5), (0.69, 0.83)])
    centres += np.random.default_rng(8).uniform(-0.02, 0.02, centres.shape)

    def largest(points):
        grid = asp.Grid((points, points))
        y, x = grid.coordinates()
        pressure = np.zeros(grid.shape)
        for (cy, cx), radius in zip(centres, radii, strict=True):
            inside = 1 - ((y[:, None] - cy) ** 2 + (x[None, :] - cx) ** 2) / radius**2
            pressure += np.sqrt(np.maximum(inside, 0.0))
        solid = asp.LoadedSolid(pressure, grid, HALF_SPACE)
        data = asp.analyse_stress(solid, depth_grid(grid, 0.06), quantities=("von_mises",), tolerance=1e-4)
        peaks = asp.stress.select_peaks(data, "von_mises", selection="interior")
        apart = np.hypot(*(peaks[f"peak_{c}"].values[:, None] - centres[:, k] for k, c in enumerate("yx")))
        return np.array([peaks["peak_value"].values[apart[:, n] < radii[n]].max() for n in range(6)])

    points = [48, 96, 192]
    exact = largest(384)
    errors = [np.sqrt(np.mean((largest(n) - exact) ** 2)) for n in points]
    # Each load jumps as nodes enter its circle, so the order holds over the whole range only.
    assert order(points, errors) > 1.5
    assert errors[-1] < 1e-3
