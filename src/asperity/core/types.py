"""Types that several modules share."""

import os
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import ArrayLike as ArrayLike
from numpy.typing import DTypeLike as DTypeLike
from numpy.typing import NDArray

Array = NDArray[Any]
"""An array with elements of any type."""

REAL_TYPES = (np.dtype(np.float32), np.dtype(np.float64))
"""Precisions of real fields: single and double."""

FilePath = str | os.PathLike[str]
"""Path of a file or folder."""

Progress = Callable[[float, float], None]
"""Function called as ``progress(done, total)`` to report the progress of a computation."""
