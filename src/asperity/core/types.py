"""Types that several modules share."""

import os
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, DTypeLike, NDArray

__all__ = ["REAL_TYPES", "Array", "ArrayLike", "DTypeLike", "FilePath", "Progress"]

Array = NDArray[Any]
"""An array with elements of any type."""

REAL_TYPES = (np.dtype(np.float32), np.dtype(np.float64))
"""Precisions of real fields: single and double."""

FilePath = str | os.PathLike[str]
"""Path of a file or folder."""

Progress = Callable[[float, float], None]
"""Function called as ``progress(done, total)`` to report the progress of a computation."""
