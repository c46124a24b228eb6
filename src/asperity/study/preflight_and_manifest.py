"""Before and after a run of the study: memory and disk space, compilation, and manifest of its results."""

import os
import re
import shutil
from collections.abc import Iterable, Mapping
from pathlib import Path

from asperity.core.errors import PreflightError
from asperity.core.system import available_memory, sha256_of
from asperity.results.atomic import write_text

MANIFEST = "SHA256SUMS"
"""File in the folder of results with the SHA-256 hash of every file, as ``sha256sum --check`` reads it."""


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


def warm_up(part: str) -> None:
    """Compile a part of the library that ``asperity run``, ``view`` and the study call.

    Numba compiles a function at its first call and keeps the machine code beside the module, where others
    find it: afterwards the jobs do not compile the same functions side by side.

    Parameters
    ----------
    part : str
        One of `asperity.core.system.COMPILED_PARTS`: contacts, and the stress in single precision; or the
        stress in double precision, for which no contact is compiled. Both take the same time.
    """
    # Imported here as they take time: every job reads the rules that import this module.
    import numpy as np

    from asperity.contact import solve_contact
    from asperity.elasticity.loaded_solid import LoadedSolid
    from asperity.elasticity.solid import Solid
    from asperity.fourier.grid import Grid
    from asperity.stress.analysis import analyse_stress
    from asperity.stress.exceedance import Exceedance
    from asperity.stress.planes.planes import stress_planes
    from asperity.stress.planes.stream import LinearPlane
    from asperity.surface.self_affine import self_affine

    height, solid = self_affine((64, 64), 0.8, 0.5, 0.125, 1e-3, seed=1), Solid(1.0, 0.33)
    if part == "stress":
        loaded = LoadedSolid(np.maximum(height, 0.0), Grid(height.shape), solid)
        analyse_stress(loaded, tolerance=1e-6)
        [*stress_planes(loaded, [0.0, 0.01], fields=("von_mises", "principal_1", "xz"), tolerance=0.0)]
        return
    for precision in ("float32", "float64"):
        contact = solve_contact(height, solid, contact_area_fraction=0.1, rtol=1e-4, dtype=precision)
        solve_contact(height, solid, mean_pressure=0.002, hardness=0.02, rtol=1e-4, dtype=precision)
    above = Exceedance(0.2 * float(contact.pressure.max()))

    def observe(plane: LinearPlane) -> None:
        above.add(plane.depth, plane.grid, plane.field("von_mises", 0.33))
        plane.field_at("von_mises", 0.33, np.arange(2))

    analyse_stress(contact, tolerance=1e-2, observe=observe)


def write_manifest(folder: Path, outputs: Iterable[str | os.PathLike[str]]) -> None:
    """Add files of a run to the manifest of its results, and drop those that are gone.

    A file that was not written since the manifest keeps its hash, so that damage stays visible.
    """
    path = folder / MANIFEST
    text = path.read_text(encoding="utf-8", errors="replace") if path.is_file() else ""
    known = {name: digest for digest, name in re.findall(r"^([0-9a-f]{64})  (.+)$", text, re.MULTILINE)}
    written = path.stat().st_mtime if path.is_file() else 0.0
    names = {*known, *(os.path.relpath(output, folder) for output in outputs)}
    lines = []
    for name in sorted(names):
        file = folder / name
        if not file.is_file():
            continue
        if name not in known or file.stat().st_mtime >= written:
            known[name] = sha256_of(file)
        lines.append(f"{known[name]}  {name}\n")
    write_text(path, "".join(lines))
