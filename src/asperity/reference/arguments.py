"""Check of arguments shared by the closed forms."""

from __future__ import annotations

import numpy as np


def require_positive(**values: float) -> None:
    """Raise `ValueError` naming the first argument that is not positive and finite."""
    for name, value in values.items():
        if not (np.isfinite(value) and value > 0):
            raise ValueError(f"{name} = {value!r}: a positive finite number is needed")
