"""Paraboloid pressed into a bonded elastic slab by CalculiX, an independent finite-element program.

The model is the quarter cell of `asperity.reference.finite_element` in 20-node bricks with reduced
integration, with surface-to-surface penalty contact against a meshed indenter whose nodes all move down
together; it is close to the paper's Abaqus model. CalculiX (G. Dhondt, www.calculix.de) is an optional
program; this module writes its input deck, runs it and reads its results.
"""

from __future__ import annotations

import os
import re
import shutil
import subprocess
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from asperity.reference.line_elements import Line
from asperity.types import Array

PROGRAM = "ccx"
"""Name of the executable, looked for on the path."""

INSTALL = "CalculiX is not installed: put `ccx` on the path (Debian, Ubuntu: apt install calculix-ccx)"

# Positions of the nodes of a 20-node brick along x, y and z in half elements, in CalculiX's order.
_BRICK = [(0, 0, 0), (2, 0, 0), (2, 2, 0), (0, 2, 0), (0, 0, 2), (2, 0, 2), (2, 2, 2), (0, 2, 2)]
_BRICK += [(1, 0, 0), (2, 1, 0), (1, 2, 0), (0, 1, 0), (1, 0, 2), (2, 1, 2), (1, 2, 2), (0, 1, 2)]
_BRICK += [(0, 0, 1), (2, 0, 1), (2, 2, 1), (0, 2, 1)]


@dataclass(frozen=True)
class Result:
    """Solution of CalculiX on the vertical plane x = y.

    Attributes
    ----------
    load : float
        Force on the whole indenter, four quarters.
    x, z : (nx,), (nz,) arrays
        Integration points; the distance from the axis of the indenter is √2 x.
    displacement : (nz, nx, 3) array
    stress : (nz, nx, 6) array
        In the order xx, yy, zz, yz, xz, xy.
    version : str
        Version of CalculiX.
    """

    load: float
    x: Array
    z: Array
    displacement: Array
    stress: Array
    version: str


def available() -> bool:
    """True if the program is on the path."""
    return shutil.which(PROGRAM) is not None


def press(
    folder: str | os.PathLike[str],
    plane: Array,
    column: Array,
    young: float,
    poisson: float,
    curvature_radius: float,
    approach: float,
    penalty: float,
    threads: int = 1,
) -> Result:
    """Contact of a paraboloid ``r²/(2R)`` with the slab at an approach.

    Parameters
    ----------
    folder : path
        Folder of the input deck and the files of the program; created if missing.
    plane, column : arrays
        Ends of the elements along x and y, and along z.
    young, poisson, curvature_radius, approach : float
    penalty : float
        Contact pressure per length of penetration.
    threads : int
        Threads of CalculiX.

    Raises
    ------
    FileNotFoundError
        If the program is not installed; the message says how to install it.
    RuntimeError
        If the program fails; the message names its log.
    """
    program = shutil.which(PROGRAM)
    if program is None:
        raise FileNotFoundError(INSTALL)
    folder = Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    deck = folder / "slab.inp"
    deck.write_text(
        write_deck(plane, column, young, poisson, curvature_radius, approach, penalty), encoding="ascii"
    )
    environment = {**os.environ, "OMP_NUM_THREADS": str(threads)}
    done = subprocess.run(
        [program, deck.stem], cwd=folder, env=environment, capture_output=True, text=True, check=False
    )
    log = folder / "slab.log"
    log.write_text(done.stdout + done.stderr, encoding="utf-8")
    if done.returncode or "Job finished" not in done.stdout:
        raise RuntimeError(f"CalculiX failed; its log is {log}")
    version = re.search(r"Version\s+(\S+)", done.stdout)
    return read_result(
        (folder / "slab.dat").read_text(encoding="ascii"),
        plane,
        column,
        version.group(1).rstrip(",") if version else "?",
    )


def write_deck(
    plane: Array,
    column: Array,
    young: float,
    poisson: float,
    curvature_radius: float,
    approach: float,
    penalty: float,
) -> str:
    """Input deck of the model; arguments as for `press`."""
    side, height = 2 * len(plane) - 1, 2 * len(column) - 1
    thickness = 0.1 * column[-1]
    lines = ["*NODE, NSET=SLAB", *_nodes(plane, column, 0, None)]
    above = np.array([column[-1], column[-1] + thickness])
    offset = side * side * height
    lines += ["*NODE, NSET=INDENTER", *_nodes(plane, above, offset, curvature_radius)]
    lines += ["*ELEMENT, TYPE=C3D20R, ELSET=SLAB", *_elements(len(plane) - 1, len(column) - 1, 0, 0)]
    count = (len(plane) - 1) ** 2 * (len(column) - 1)
    lines += ["*ELEMENT, TYPE=C3D20R, ELSET=INDENTER", *_elements(len(plane) - 1, 1, offset, count)]
    per_layer = (len(plane) - 1) ** 2
    top = range(count - per_layer + 1, count + 1)
    lines += ["*SURFACE, NAME=TOP, TYPE=ELEMENT", *(f"{element}, S2" for element in top)]
    punch = range(count + 1, count + per_layer + 1)
    lines += ["*SURFACE, NAME=PUNCH, TYPE=ELEMENT", *(f"{element}, S1" for element in punch)]
    lines += ["*ELSET, ELSET=DIAGONAL", *(f"{element}" for element in _diagonal(plane, column))]
    walls = {"BOTTOM": (0, (0,)), "WALLX": (2, (0, side - 1)), "WALLY": (1, (0, side - 1))}
    for name, (axis, places) in walls.items():
        lines += [f"*NSET, NSET={name}"]
        lines += [
            f"{_number(z, y, x, side, 0)}" for z, y, x in _grid(height, side) if (z, y, x)[axis] in places
        ]
    lines += [
        "*MATERIAL, NAME=SOLID",
        "*ELASTIC",
        f"{young:.15g}, {poisson:.15g}",
        "*SOLID SECTION, ELSET=SLAB, MATERIAL=SOLID",
        "*SOLID SECTION, ELSET=INDENTER, MATERIAL=SOLID",
        "*SURFACE INTERACTION, NAME=WALL",
        "*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR",
        f"{penalty:.15g}",
        "*CONTACT PAIR, INTERACTION=WALL, TYPE=SURFACE TO SURFACE",
        "TOP, PUNCH",
        "*BOUNDARY",
        "BOTTOM, 1, 3",
        "WALLX, 1, 1",
        "WALLY, 2, 2",
        "*STEP, INC=200",
        "*STATIC, DIRECT",
        "1.0, 1.0",
        "*BOUNDARY",
        "INDENTER, 1, 2",
        f"INDENTER, 3, 3, {-approach:.15g}",
        "*NODE PRINT, NSET=INDENTER, TOTALS=ONLY, FREQUENCY=200",
        "RF",
        "*NODE PRINT, NSET=SLAB, FREQUENCY=200",
        "U",
        "*EL PRINT, ELSET=DIAGONAL, FREQUENCY=200",
        "S",
        "*END STEP",
    ]
    return "\n".join(lines) + "\n"


def read_result(text: str, plane: Array, column: Array, version: str = "?") -> Result:
    """Solution read from the program's table of results, ``slab.dat``."""
    tables = re.split(r"\n(?=\s*(?:total force|displacements|stresses))", text)

    def last(title: str) -> Array:
        body = [table for table in tables if table.lstrip().startswith(title)][-1]
        rows = [line.split() for line in body.splitlines()[1:]]
        return np.array([[float(entry) for entry in row] for row in rows if row])

    load = -4 * float(last("total force")[0, 2])
    side, height = 2 * len(plane) - 1, 2 * len(column) - 1
    listed = last("displacements")
    moved = np.zeros((height, side, side, 3))
    moved.reshape(-1, 3)[listed[:, 0].astype(int) - 1] = listed[:, 1:]

    (x, _), (z, _) = Line(plane).at_gauss_points(0), Line(column).at_gauss_points(0)
    stress = np.empty((len(z), len(x), 6))
    displacement = np.empty((len(z), len(x), 3))
    elements = _diagonal(plane, column)
    gauss = np.array([-1.0, 1.0]) / np.sqrt(3.0)
    # Integration points are numbered along x first, then y, then z; those on the diagonal have equal x and y.
    places = {1: (0, 0), 4: (0, 1), 5: (1, 0), 8: (1, 1)}
    order = [0, 1, 2, 5, 4, 3]  # printed xx, yy, zz, xy, xz, yz
    for row in last("stresses"):
        layer, step = elements[int(row[0])]
        if int(row[1]) not in places:
            continue
        up, along = places[int(row[1])]
        where = 2 * layer + up, 2 * step + along
        stress[where] = row[2:8][order]
        corner = moved[2 * layer : 2 * layer + 3, 2 * step : 2 * step + 3, 2 * step : 2 * step + 3]
        nodes = np.array([corner[c, b, a] for a, b, c in _BRICK])
        displacement[where] = _serendipity(gauss[along], gauss[along], gauss[up]) @ nodes
    return Result(load, x, z, displacement, stress, version)


def _serendipity(xi: float, eta: float, zeta: float) -> Array:
    """Shape functions of the 20-node brick at a local point −1 … 1, (20,)."""
    point = np.array([xi, eta, zeta])
    local = np.array(_BRICK) - 1.0
    linear = np.prod(1 + local * point, axis=1)
    corner = linear / 8 * (local @ point - 2)
    middle = linear / 4 * np.prod(np.where(local == 0, 1 - point**2, 1.0), axis=1)
    return np.where(np.all(local != 0, axis=1), corner, middle)


def _grid(height: int, side: int) -> Iterator[tuple[int, int, int]]:
    """Indices z, y, x of the nodes of 20-node bricks on a grid of half elements."""
    for z in range(height):
        for y in range(side):
            for x in range(side):
                if z % 2 + y % 2 + x % 2 <= 1:
                    yield z, y, x


def _number(z: int, y: int, x: int, side: int, offset: int) -> int:
    """Number of a node in the deck."""
    return offset + (z * side + y) * side + x + 1


def _nodes(plane: Array, column: Array, offset: int, curvature_radius: float | None) -> Iterator[str]:
    """Lines of the deck with the positions of the nodes of the slab, or of the indenter of that curvature."""
    across, up = Line(plane).nodes, Line(column).nodes
    for z, y, x in _grid(len(up), len(across)):
        # The lower face of the indenter is curved, its upper face is flat.
        rise = (
            0.0
            if curvature_radius is None or z == len(up) - 1
            else (across[x] ** 2 + across[y] ** 2) / (2 * curvature_radius) * (1 - z / (len(up) - 1))
        )
        number = _number(z, y, x, len(across), offset)
        yield f"{number}, {across[x]:.15g}, {across[y]:.15g}, {up[z] + rise:.15g}"


def _elements(across: int, up: int, offset: int, first: int) -> Iterator[str]:
    """Lines of the deck with the nodes of each element."""
    side = 2 * across + 1
    number = first
    for layer in range(up):
        for row in range(across):
            for step in range(across):
                number += 1
                nodes = [
                    str(_number(2 * layer + c, 2 * row + b, 2 * step + a, side, offset)) for a, b, c in _BRICK
                ]
                yield f"{number}, {', '.join(nodes[:10])},"
                yield ", ".join(nodes[10:])


def _diagonal(plane: Array, column: Array) -> dict[int, tuple[int, int]]:
    """Numbers of the elements on the plane x = y, with their indices along z and along x."""
    across = len(plane) - 1
    return {
        (layer * across + step) * across + step + 1: (layer, step)
        for layer in range(len(column) - 1)
        for step in range(across)
    }
