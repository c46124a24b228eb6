"""Cost of hardness, load curves, cycles, engines of the transforms, layers, partial slip and the gap.

    python benchmarks/options.py --grid 1024 --out results/benchmarks/options.csv

Ratios of the processor times of calculations with and without an option, measured in turns.
"""

import os
import time
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path
from typing import Any

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # waiting threads would count as processor time

import numpy as np
from measuring import alternately, paired, parser_of, write

import asperity as asp
from asperity.stress.cycles.criteria import Criteria
from asperity.stress.cycles.stress_cycles import Cycles

HARDNESSES = (1.0, 0.5, 0.2)
"""Hardness over E* times the rms gradient."""

COATINGS = (0.1, 3.0)
"""Young's modulus of coatings over the base's."""

MODULI = (2.0, 0.5, 3.0, 1.5)
"""Young's moduli of four layers over the base's; a coating of the first one is four times as thick."""

ENGINES = ("scipy", "pyfftw")
TOLERANCE = 1e-4
"""Tolerance of the planes of stress, as in `asperity run`."""

MOST_PAIRS, SECONDS_OF_PAIRS = 5, 8.0

Call = Callable[[], Any]


def calls(points: int) -> Iterator[tuple[str, str, Call, Call]]:
    """Option, the calculation by whose time its time is divided, and both calculations."""
    height = asp.self_affine((points, points), 0.8, 0.25, 8 / points, rms_height=1e-3, seed=1)
    solid, gradient = asp.Solid(1.0, 0.0), asp.roughness_parameters(height).rms_gradient
    load = 0.02 * gradient
    press = partial(asp.solve_contact, height, mean_pressure=load)
    elastic, contact = partial(press, solid), press(solid)

    def stress(of: asp.Contact, **more: Any) -> Call:
        return partial(asp.analyse_stress, of, tolerance=TOLERANCE, **more)

    for scaled in HARDNESSES:
        plastic = partial(press, solid, hardness=scaled * gradient)
        yield f"contact with a hardness of {scaled:g} E* ḡ", "elastic contact", elastic, plastic
    for young in COATINGS:
        body = asp.Solid(young, 0.25, 8 / points, base=solid)
        area = contact.contact_area_fraction  # its time grows with the area
        of_area = asp.solve_contact(height, body, contact_area_fraction=area)
        coated = partial(asp.solve_contact, height, body, mean_pressure=of_area.mean_pressure)
        name = f"a coating of {young:g} E, one short wave thick"
        yield f"contact of equal area with {name}", "elastic contact", elastic, coated
        yield f"stress with {name}", "stress", stress(contact), stress(coated())
    base, thick = asp.Solid(1.0, 0.3), 40 / points
    solids = [[(thick, MODULI[0], 0.25)], [(thick / 4, young, 0.25) for young in MODULI]]
    one, four = (partial(press, asp.Solid.stack(layers, base)) for layers in solids)
    yield "contact with four layers", "one coating", one, four
    both = (stress(each().in_body("lower")) for each in (one, four))
    yield "stress with four layers", "one coating", *both
    loads = np.geomspace(load / 10, load, 12)
    curve = asp.engineering.load_curve
    several = partial(asp.solve_load_path, height, solid, mean_pressures=loads)
    yield "curve of 12 loads", "elastic contact", elastic, lambda: curve(several())
    push = partial(asp.contact.partial_slip, contact, 0.4, tangential_force=0.2 * contact.force)
    yield "partial slip", "elastic contact", elastic, lambda: push().displacement
    yield "percolation", "elastic contact", elastic, partial(asp.contact.percolation, contact)
    yield "flow of a film", "elastic contact", elastic, partial(asp.contact.film_flow, contact, 1.0, 1.0)
    watch = Cycles(asp.LoadedSolid.of(contact), Criteria(0.3, 0.48, 0.1), "x", 0.3)
    yield "stress with cycles", "stress", stress(contact), stress(contact, observe=watch.add)
    for engine in ENGINES:
        for name, over, call in (
            ("contact", "elastic contact", elastic),
            ("stress", "stress", stress(contact)),
        ):
            yield f"{name} with {engine}", over, call, partial(_with_engine, engine, call)


def _with_engine(engine: str, call: Call) -> None:
    with asp.fft_engine(engine):
        call()


def main() -> None:
    """Measure, print and write the table."""
    parser = parser_of(__doc__)
    parser.add_argument("--grid", type=int, default=1024, help="nodes on an edge")
    parser.add_argument("--out", type=Path, required=True)
    given = parser.parse_args()
    for _, _, plain, other in calls(64):  # compiles
        plain(), other()
    rows = []
    for option, over, plain, other in calls(given.grid):
        times = alternately((plain, other), MOST_PAIRS, SECONDS_OF_PAIRS, time.process_time)
        rows.append(
            {
                "points": given.grid,
                "option": option,
                "over": over,
                "seconds": float(np.median(times[:, 1])),
                **paired(*times.T),
                "load_average": os.getloadavg()[0],
            }
        )
        print(rows[-1], flush=True)
    write(rows, given.out)


if __name__ == "__main__":
    main()
