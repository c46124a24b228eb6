"""Spots of contact on a map, as a table."""

from __future__ import annotations

import numpy as np
import pandas as pd

from asperity.core.types import Array
from asperity.fourier.grid import Grid
from asperity.stress.statistics.patches import contact_patches


def contact_spots(pressure: Array, grid: Grid, periodic: bool) -> pd.DataFrame:
    """Connected patches of contact, those of largest load first.

    Parameters
    ----------
    pressure : (ny, nx) array
        In Pa, on the nodes of the map.
    grid : Grid
        Of the map, in m.
    periodic : bool
        True if opposite edges of the map are neighbours.

    Returns
    -------
    DataFrame
        Columns as ``docs/tables.md`` describes them. Length and width are the axes of the ellipse with the
        area of the spot and the ratio of its principal second moments.
    """
    number, _ = contact_patches(pressure > 0, periodic)
    node = np.flatnonzero(number)
    spot, carried = number.ravel()[node] - 1, pressure.ravel()[node].astype(float)
    _, first, nodes = np.unique(spot, return_index=True, return_counts=True)

    def mean(values: Array) -> Array:
        return np.bincount(spot, values, nodes.size) / nodes

    place, offset = [], []
    for index, count, step in zip(np.divmod(node, grid.shape[1]), grid.shape, grid.spacing, strict=True):
        away = index - index[first][spot]
        if periodic:
            away = (away + count // 2) % count - count // 2
        middle = mean(away)
        place.append((index[first] + middle) % count * step)
        offset.append((away - middle[spot]) * step)
    yy, xx = (mean(own**2) + step**2 / 12 for own, step in zip(offset, grid.spacing, strict=True))
    yx = mean(offset[0] * offset[1])
    spread = np.hypot((xx - yy) / 2, yx)
    ratio = np.sqrt(((xx + yy) / 2 + spread) / ((xx + yy) / 2 - spread))
    area = nodes * grid.area / grid.size
    largest = np.zeros(nodes.size)
    np.maximum.at(largest, spot, carried)
    table = pd.DataFrame(
        {
            "area_m2": area,
            "load_N": np.bincount(spot, carried, nodes.size) * grid.area / grid.size,
            "y_m": place[0],
            "x_m": place[1],
            "length_m": np.sqrt(4 / np.pi * area * ratio),
            "width_m": np.sqrt(4 / np.pi * area / ratio),
            "angle_deg": np.degrees(np.arctan2(2 * yx, xx - yy) / 2) % 180,
            "largest_pressure_Pa": largest,
            "nodes": nodes,
        }
    )
    return table.sort_values("load_N", ascending=False, ignore_index=True)
