"""The surface of the test maps.

All files `steel.*` hold this surface: steel, ground along y, 40 x 48 pixels of 2 µm, in whole nanometres,
with a tilt, spikes of an optical instrument, and non-measured points.
"""

import numpy as np

SHAPE = (40, 48)
PIXEL = 2e-6
SPIKES = ((7, 11), (7, 12), (21, 30), (33, 5))
MISSING = ((3, 40), (4, 40), (4, 41), (5, 40), (18, 9), (29, 22), (29, 23))


def ground_steel():
    """Heights in nanometres, integers, peaks upward; and the mask of the points that have data."""
    random = np.random.default_rng(20)
    ny, nx = SHAPE
    qy, qx = np.fft.fftfreq(ny)[:, None], np.fft.rfftfreq(nx)[None, :]
    # Grinding marks are long in y: wavenumbers along y count eight times.
    size = np.hypot(8 * qy, qx)
    size[0, 0] = np.inf
    amplitude = (size**2 + 0.03**2) ** -0.9
    height = np.fft.irfft2(amplitude * np.fft.rfft2(random.normal(size=SHAPE)), s=SHAPE)
    height *= 400 / height.std()
    y, x = np.mgrid[:ny, :nx]
    height += 12.0 * x - 5.0 * y
    for spot in SPIKES:
        height[spot] += 15000.0
    valid = np.ones(SHAPE, dtype=bool)
    valid[tuple(np.transpose(MISSING))] = False
    return np.rint(height).astype(int), valid
