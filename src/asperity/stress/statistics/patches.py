"""How the depth of the peaks follows the size of the patch of contact above them."""

import numpy as np
import pandas as pd

from asperity.core.types import Array


def depth_patch_correlation(depth: Array, row: Array, column: Array, patches: Array, radii: Array) -> float:
    """Rank correlation (Spearman) between the depth of peaks and the radius of the patch above them.

    Parameters
    ----------
    depth, row, column : (peaks,) arrays
        Depth of each peak, and the node above it.
    patches, radii : arrays
        As of `contact_patches`. Peaks that are not under a patch are left out.

    Returns
    -------
    float
        NaN with fewer than two different depths or radii.
    """
    ny, nx = patches.shape
    above = patches[row % ny, column % nx]
    touched = above > 0
    depth, radius = depth[touched], radii[above[touched] - 1]
    if np.unique(depth).size < 2 or np.unique(radius).size < 2:
        return float("nan")
    return float(np.corrcoef(pd.Series(radius).rank(), pd.Series(depth).rank())[0, 1])
