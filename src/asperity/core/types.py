"""Types that several modules share."""

import os
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, DTypeLike, NDArray

__all__ = ["FIELDS", "REAL_TYPES", "Array", "ArrayLike", "DTypeLike", "FilePath", "Progress"]

Array = NDArray[Any]
"""An array with elements of any type."""

REAL_TYPES = (np.dtype(np.float32), np.dtype(np.float64))
"""Precisions of real fields: single and double."""

FIELDS = (
    *("xx", "yy", "zz", "yz", "xz", "xy"),
    *("von_mises", "maximum_shear", "principal_1", "principal_2", "principal_3", "hydrostatic"),
)
"""Names of the fields of the stress, its components first."""

FilePath = str | os.PathLike[str]
"""Path of a file or folder."""

Progress = Callable[[float, float], None]
"""Function called as ``progress(done, total)`` to report the progress of a computation."""
