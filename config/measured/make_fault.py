"""Write fault.asc: a part of the elevation model that matplotlib contains, resampled to square pixels."""

from pathlib import Path

import numpy as np
from matplotlib.cbook import get_sample_data
from scipy.ndimage import map_coordinates

PIXELS = 128
METRES_PER_DEGREE = 111_320.0

with get_sample_data("jacksboro_fault_dem.npz") as data:
    elevation, degrees = data["elevation"], float(data["dx"])
    latitude = 0.5 * float(data["ymin"] + data["ymax"])

pixel = degrees * METRES_PER_DEGREE
row, column = np.mgrid[:PIXELS, :PIXELS].astype(float)
column /= np.cos(np.radians(latitude))
cut = map_coordinates(elevation.astype(float), [row + 100, column + 100], order=3)

header = f"Channel: Elevation\nWidth: {PIXELS * pixel:.1f} m\nHeight: {PIXELS * pixel:.1f} m\nValue units: m"
np.savetxt(Path(__file__).with_name("fault.asc"), cut, fmt="%.1f", header=header)
