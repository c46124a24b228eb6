"""Maps of a bearing for tests: patches of one ground ring and of its honed counter-face, as X3P files.

    python tests/data/bearing.py FOLDER    # ring_1.x3p to ring_3.x3p, counter_1.x3p to counter_3.x3p

800 x 600 pixels of 0.5 µm by default, ground along y, in whole nanometres, with a tilt, spikes of an optical
instrument, and 0.5 % of the non-measured points.
"""

import sys
from pathlib import Path

import numpy as np
from foreign_files import write_x3p

X3P = {"type": "I", "increment": "1e-9", "pixel": "5e-7"}
"""Whole nanometres on pixels of 0.5 µm."""
FACES = {"ring": (250, 12), "counter": (120, 5)}
"""Face → rms height in nm, and how many times longer than wide its grinding marks are."""


def patch(face, number, shape=(600, 800)):
    """Heights in nanometres, integers, and the mask of the points that have data."""
    rms, long = FACES[face]
    random = np.random.default_rng([number, rms])
    qy, qx = np.fft.fftfreq(2 * shape[0])[:, None], np.fft.rfftfreq(2 * shape[1])[None, :]
    size = np.hypot(long * qy, qx)
    size[0, 0] = np.inf
    amplitude = (size**2 + 0.01**2) ** -0.9 * np.exp(-((size / 0.2) ** 2))
    whole = np.fft.irfft2(amplitude * np.fft.rfft2(random.normal(size=(qy.size, 2 * shape[1]))))
    height = (rms / whole.std() * whole)[: shape[0], : shape[1]]  # not periodic, as a measured patch is
    y, x = np.mgrid[: shape[0], : shape[1]]
    height = height + 0.8 * x - 0.3 * y
    spikes, missing = random.integers(height.size, size=12), random.random(shape) < 0.005
    height.flat[spikes] += 8000.0
    return np.rint(height).astype(int), ~missing


def write_maps(folder, shape=(600, 800), patches=3):
    """Write the maps of both faces; their paths by face."""
    paths = {face: [Path(folder) / f"{face}_{number + 1}.x3p" for number in range(patches)] for face in FACES}
    for face, files in paths.items():
        for number, path in enumerate(files):
            write_x3p(path, *patch(face, number, shape), **X3P)
    return paths


if __name__ == "__main__":
    write_maps(sys.argv[1])
