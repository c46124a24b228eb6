"""Error of a mean over the area of one map, from the scatter of its parts: another place gives another mean.

The map is cut into equal blocks that are wider than its longest wave, so that they are nearly independent.
Under a given load a sum over the blocks is proportional to their load, to first order: the error is the error
of the ratio of the sum to the load, with the variance that a bootstrap of the blocks has in the limit of many
draws (W. G. Cochran, Sampling Techniques, 3rd ed., Wiley 1977, Eq. 6.9), and Student's t.
"""

from dataclasses import dataclass

import numpy as np

from asperity.core.types import Array
from asperity.surface.roughness import correlated_lengths
from asperity.surface.treatment.treatment import TreatedMap

BLOCK = 4.0
"""Edge of a block over the correlation length of the heights along it. On self-affine surfaces such a block
is wider than the longest wave. `benchmarks/places.py` covers 93 and 95 % of 120 maps."""

FEWEST_BLOCKS = 16
"""Fewest blocks from which the error is estimated. On a smaller map the waves may be short by chance: it then
holds as many blocks, and its error is wrong."""

NEIGHBOURS = 1.1
"""Factor of the error, as blocks that touch are not independent (`benchmarks/places.py`, other surfaces)."""

CONFIDENCE = 0.95
"""Confidence of the interval."""


@dataclass(frozen=True, eq=False)
class Blocks:
    """Blocks of a map.

    Parameters
    ----------
    shape : (rows, columns)
    load : (rows, columns) array
        Fraction of the load on each block.
    """

    shape: tuple[int, int]
    load: Array

    def means(self, values: Array) -> Array:
        """Mean over each block, (rows, columns), of values (ny, nx) on the map, on any grid."""
        return _means(values, self.shape)

    def error(self, means: Array) -> float:
        """Half of the 95 % interval of a mean over the area, relative to it, from means over the blocks."""
        from scipy.special import stdtrit  # scipy.stats takes half a second to import

        total, count = float(means.mean()), means.size
        if not total > 0:
            return np.nan
        residual = means / total - self.load / self.load.mean()
        scatter = np.sqrt(float(np.square(residual).sum()) / (count - 1))
        return float(NEIGHBOURS * stdtrit(count - 1, (1 + CONFIDENCE) / 2) * scatter / np.sqrt(count))


def blocks_of(face: TreatedMap, pressure: Array) -> Blocks | None:
    """The blocks of a map under a pressure on its cell; None where it holds fewer than `FEWEST_BLOCKS`."""
    angle, length = correlated_lengths(face.height, face.grid.spacing)
    wide = [float((length * np.abs(part)).max()) for part in (np.sin(angle), np.cos(angle))]
    if not min(wide) > 0:
        return None
    rows, columns = (int(edge // (BLOCK * own)) for edge, own in zip(face.grid.length, wide, strict=True))
    if rows * columns < FEWEST_BLOCKS:
        return None
    return Blocks((rows, columns), _means(pressure, (rows, columns)))


def _means(values: Array, shape: tuple[int, int]) -> Array:
    """Means over blocks of nodes, (rows, columns); a block without a node has the value of the one before."""
    starts = [np.arange(count) * nodes // count for nodes, count in zip(values.shape, shape, strict=True)]
    sums = np.add.reduceat(np.add.reduceat(values, starts[0], 0, dtype=float), starts[1], 1)
    counts = (np.diff(start, append=nodes) for nodes, start in zip(values.shape, starts, strict=True))
    sizes = [np.maximum(count, 1) for count in counts]
    return sums / np.outer(*sizes)
