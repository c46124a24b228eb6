"""Write the maps that come with asperity, on which `asperity case` writes its case files.

    python tests/data/example_maps.py

Three maps of one ground surface, 96 x 128 pixels of 2 um, made up: H = 0.8, an rms height of 0.2 um, waves
of 12 to 96 um, and a lay along y. Each is cut out of a larger random surface and tilted a little, as an
instrument shows it.
"""

from pathlib import Path

import numpy as np
from foreign_files import write_x3p

FOLDER = Path(__file__).parents[2] / "src/asperity/engineering/maps"
SHAPE, CELL, LAY, SHORTEST, LONGEST = (96, 128), 512, 3, 6, 48


def ground(seed):
    """Heights in whole nanometres, peaks upward."""
    qy, qx = np.fft.fftfreq(CELL)[:, None], np.fft.rfftfreq(CELL)
    q = np.hypot(LAY * qy, qx)
    q[0, 0] = np.inf
    amplitude = np.where((q >= 1 / LONGEST) & (q <= 1 / SHORTEST), q**-1.8, 0)
    noise = np.fft.rfft2(np.random.default_rng(seed).normal(size=(CELL, CELL)))
    height = np.fft.irfft2(amplitude * noise, s=(CELL, CELL))
    ny, nx = SHAPE
    y, x = np.mgrid[:ny, :nx]
    return np.rint(200 * height[:ny, :nx] / height.std() + 1.5 * x - y).astype(int)


if __name__ == "__main__":
    FOLDER.mkdir(exist_ok=True)
    for number in (1, 2, 3):
        write_x3p(FOLDER / f"ground_{number}.x3p", ground(number), type="I", increment="1e-9")
