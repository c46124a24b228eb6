"""Checks before the first job of a study: is there enough memory and disk space."""

from __future__ import annotations

import os
import shutil
from collections.abc import Mapping

from asperity.core.errors import PreflightError
from asperity.core.system import available_memory


def require_memory(needs: Mapping[str, float]) -> None:
    """Raise `PreflightError` if a job needs more memory than this machine has.

    Parameters
    ----------
    needs : mapping
        File to be made → memory in MB that its job needs.
    """
    largest = max(needs, key=lambda name: needs[name], default=None)
    if largest is not None and needs[largest] > (available := available_memory()):
        raise PreflightError(
            f"{largest} needs about {needs[largest] / 1e3:.3g} GB of memory, this machine has "
            f"{available / 1e3:.3g} GB; choose fewer points, or a machine with more"
        )


def require_space(folder: str | os.PathLike[str], need: float) -> None:
    """Raise `PreflightError` if less than `need` MB are free on the disk of the folder."""
    free = shutil.disk_usage(folder).free / 1e6
    if need > free:
        raise PreflightError(
            f"{folder}: about {need:.3g} MB will be written, {free:.3g} MB are free; "
            f"free some space, or set a folder on another disk as results"
        )
