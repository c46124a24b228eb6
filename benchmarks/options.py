"""Time of options of an analysis over the time without them."""

from __future__ import annotations

import time

import asperity as asp


def cycles(points: int) -> float:
    """Time of a stress analysis with cycles in its stream over that of one without, at points² nodes."""
    from asperity.stress.cycles import Cycles

    height = asp.self_affine((points, points), 0.8, 0.25, 8 / points, rms_height=1e-3, seed=1)
    contact = asp.solve(height, asp.Layer(1.0, 0.3), area_fraction=0.1)
    times = []
    for asked in (False, True, False, True):  # the first pair compiles
        watch = Cycles(asp.LoadedSolid.of(contact), 0.3, 0.48, 0.1, "x", 0.3) if asked else None
        start = time.perf_counter()
        asp.analyse_stress(contact, tolerance=1e-4, observe=watch and watch.add)
        times.append(time.perf_counter() - start)
    return times[3] / times[2]


if __name__ == "__main__":
    print(f"stress with cycles over stress without, 512²: {cycles(512):.2f}")
