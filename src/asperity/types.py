"""Types that several modules share."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from numpy.typing import NDArray

Array = NDArray[Any]
"""An array of any type."""

Progress = Callable[[float, float], None]
"""Called as ``progress(done, total)`` while work goes on."""
