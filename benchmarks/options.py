"""Cost of hardness, load curves, cycles, engines of the transforms, coatings, partial slip and the gap.

Processor times are relative to the plain calculation.

python benchmarks/options.py --grid 1024 --out options.csv
"""

import argparse
import time
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

import asperity as asp
from asperity.fourier import ENGINES
from asperity.stress.cycles.criteria import Criteria
from asperity.stress.cycles.stress_cycles import Cycles

HARDNESSES = (3.0, 1.0, 0.5, 0.2, 0.1, 0.05)
"""Hardness over E* times the rms gradient."""

COATINGS = (0.1, 3.0)
"""Young's modulus of coatings over the base's."""

TOLERANCE = 1e-4
"""Tolerance of the planes of stress, as in `asperity run`."""


def seconds(call: Callable[[], Any]) -> float:
    """Least processor time of three calls after a first one, which compiles."""
    times = []
    for _ in range(4):
        begin = time.process_time()
        call()
        times.append(time.process_time() - begin)
    return min(times[1:])


def rows(points: int) -> Iterator[tuple[str, str, float]]:
    """Option, the calculation by whose time its time is divided, and the ratio."""
    height = asp.self_affine((points, points), 0.8, 0.25, 8 / points, rms_height=1e-3, seed=1)
    solid, gradient = asp.Solid(1.0, 0.0), asp.roughness_parameters(height).rms_gradient
    load = 0.02 * gradient
    contact = asp.solve_contact(height, solid, mean_pressure=load)
    elastic = seconds(lambda: asp.solve_contact(height, solid, mean_pressure=load))
    for scaled in HARDNESSES:
        plastic = partial(asp.solve_contact, height, solid, mean_pressure=load, hardness=scaled * gradient)
        ratio = seconds(plastic) / elastic
        yield f"contact with a hardness of {scaled:g} E* ḡ", "elastic contact", ratio
    both = seconds(lambda: asp.engineering.load_curve([asp.solve_contact(height, solid, mean_pressure=load)]))
    yield "stiffness", "elastic contact", both / elastic - 1
    loads = np.geomspace(load / 10, load, 12)
    for bodies in ((), ("lower",)):
        begin = time.process_time()
        asp.engineering.load_curve(asp.solve_load_path(height, solid, mean_pressures=loads), bodies)
        ratio = (time.process_time() - begin) / elastic
        yield f"curve of 12 loads{', with the largest stress' if bodies else ''}", "elastic contact", ratio
    yield from interface_rows(contact, elastic)
    pressed = asp.LoadedSolid.of(contact)
    watch = Cycles(pressed, Criteria(0.3, 0.48, 0.1), "x", 0.3)
    alone = seconds(lambda: asp.analyse_stress(contact, tolerance=TOLERANCE))
    both = seconds(lambda: asp.analyse_stress(contact, tolerance=TOLERANCE, observe=watch.add))
    yield "stress with cycles", "stress", both / alone
    for engine in ENGINES[1:]:
        with asp.fft_engine(engine):
            pressing = seconds(lambda: asp.solve_contact(height, solid, mean_pressure=load))
            analysing = seconds(lambda: asp.analyse_stress(contact, tolerance=TOLERANCE))
        yield f"contact with {engine}", "elastic contact", pressing / elastic
        yield f"stress with {engine}", "stress", analysing / alone
    for young in COATINGS:
        coated = asp.Solid(young, 0.25, 8 / points, base=solid)
        pressing = partial(asp.solve_contact, height, coated, mean_pressure=load)
        name = f"coating of {young:g} E, one short wave thick"
        yield f"contact with a {name}", "elastic contact", seconds(pressing) / elastic
        ours = partial(asp.analyse_stress, pressing(), tolerance=TOLERANCE)
        yield f"stress with a {name}", "stress", seconds(ours) / alone


def interface_rows(contact: asp.Contact, elastic: float) -> Iterator[tuple[str, str, float]]:
    """Partial slip, percolation and flow; the flow needs pyamg, and is timed once."""
    push = partial(asp.contact.partial_slip, contact, 0.4, tangential_force=0.2 * contact.force)
    slip = push()
    yield "partial slip", "elastic contact", seconds(lambda: push().displacement) / elastic
    yield "cycle of fretting, 6 forces", "elastic contact", seconds(lambda: slip.cycle(6)) / elastic
    yield "percolation", "elastic contact", seconds(lambda: asp.contact.percolation(contact)) / elastic
    small = asp.solve_contact(contact.height[:64, :64], contact.solid, mean_pressure=1e-4)
    asp.contact.film_flow(small, 1.0, 1.0)  # compiles
    begin = time.process_time()
    asp.contact.film_flow(contact, 1.0, 1.0)
    yield "flow of a film", "elastic contact", (time.process_time() - begin) / elastic


def main() -> None:
    """Measure, print and write the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--grid", type=int, default=1024, help="nodes on an edge")
    parser.add_argument("--out", type=Path, required=True)
    given = parser.parse_args()
    table = pd.DataFrame(rows(given.grid), columns=["option", "over", "ratio"]).assign(points=given.grid)
    print(table.to_string(index=False))
    table.to_csv(given.out, index=False, float_format="%.3g")


if __name__ == "__main__":
    main()
