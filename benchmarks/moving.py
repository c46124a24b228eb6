"""Cycles of two rough faces: error of few shifts, its estimate, and cost in units of one stress analysis.

OMP_NUM_THREADS=1 python benchmarks/moving.py --grid 128 --seeds 3
"""

import argparse
import time

import asperity as asp

LIMITS = {"fatigue_torsion": 0.3, "fatigue_bending": 0.48, "yield_stress": 0.1}
NAMES = ("shear_range", "dang_van", "shakedown_upper")
NODES_PER_WAVE = 8


def main() -> None:
    """Print a line for each seed and number of shifts."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--grid", type=int, default=128)
    parser.add_argument("--seeds", type=int, default=3)
    options = parser.parse_args()
    points, wave = options.grid, NODES_PER_WAVE / options.grid
    half_space = asp.Solid(1.0, 0.3)
    pair = asp.TwoBodies(half_space, half_space)
    for seed in range(options.seeds):
        low, high = (
            asp.self_affine((points, points), 0.8, 0.5, wave, rms, 2 * seed + number)
            for number, rms in enumerate((1e-3, 7e-4))
        )
        begin = time.process_time()
        contact = asp.solve_contact(high - low, pair, mean_pressure=3e-3)
        middle = time.process_time()
        asp.analyse_stress(contact.in_body("lower"), tolerance=1e-4)
        analysis = time.process_time() - middle
        print(
            f"seed {seed}: contact {(middle - begin) / analysis:.2f} of a stress analysis of {analysis:.2f} s"
        )
        every = None
        for shifts in (points, points // 2, points // 4):
            begin = time.process_time()
            settings = {"shifts": shifts, "sliding_direction": "y", "wavelength_short": wave}
            moving = asp.engineering.MovingContact(low, high, pair, mean_pressure=3e-3, **settings)
            found = asp.stress.stress_cycles(moving.in_body("lower"), **LIMITS, tolerance=1e-4).attrs
            cost = (time.process_time() - begin) / analysis
            every = every or found
            errors = [abs(found[f"worst_{name}"][0] / every[f"worst_{name}"][0] - 1) for name in NAMES]
            print(
                f"  {shifts} shifts, step {points / shifts / NODES_PER_WAVE:.3f} waves: cost {cost:.0f}, "
                f"largest error {max(errors):.4f}, estimate {found['few_shifts_error']:.4f}"
            )


if __name__ == "__main__":
    main()
