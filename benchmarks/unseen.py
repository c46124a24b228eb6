"""Coverage of discretisation errors on kinds of surfaces that no constant of the estimates was chosen on.

    python benchmarks/unseen.py    # writes paper/supplement/unseen.csv and prints it, in a quarter of an hour

As `benchmarks/answers.py`, for six other kinds; heights that are not band-limited are sampled at the nodes.
"""

import answers
import numpy as np
import random_cases

from asperity.core.types import Array

SMOOTH = "two rings", "plateau-honed", "exponential"
CREASED = "pyramids", "caps", "ridged"


def height_of(case: answers.Case, nodes: int) -> Array:
    """Lower face of a case with a number of nodes on the shortest wave."""
    waves, one, two = int(case["waves"]), float(case["one"]), float(case["two"])
    points, low, kind = nodes * waves, float(case["low"]), str(case["kind"])
    y, x = np.mgrid[:points, :points] / points
    if kind == "two rings":  # waves of two lengths
        long = {**case, "waves": waves // 4}
        height = answers.field(points, long, 1, low=0.7 * (waves // 4))
        height += (0.05 + 0.3 * one) * answers.field(points, case, low=0.8 * waves)
    elif kind == "plateau-honed":  # a smooth minimum of grooves in two directions and a plateau
        lay, angle = {**case, "ratio": 4 + 8 * one}, 0.2 + 0.5 * two
        grooves = answers.field(points, lay, turned=angle) + answers.field(points, lay, 1, turned=-angle)
        plateau = 0.2 * answers.field(points, case, 2, low=max(low, 4)) + 0.5 * one
        height = np.logaddexp(-8 * grooves, -8 * plateau) / 8
    elif kind == "exponential":  # of two bands, with a longer tail of heights
        rough = {**case, "hurst": 0.5}
        height = answers.field(points, rough) + 0.5 * answers.field(points, rough, 3, low=5)
        height = np.arcsinh(3 * (one - 0.5) * height) / 1.5 if abs(one - 0.5) > 0.1 else height
    elif kind == "pyramids":
        count = int(3 + 4 * one)
        sides = (np.abs((count * along + place) % 1 - 0.5) for along, place in ((x, two), (y, one)))
        height = 3 * sum(sides) + 0.4 * answers.field(points, case, low=max(low, 3))
    elif kind == "caps":  # paraboloids whose grooves are sharp
        draw = np.random.default_rng(int(case["seed"]))
        number, height = int(40 + 60 * one), np.full((points, points), np.inf)
        for at_y, at_x in draw.random((number, 2)):
            squared = ((y - at_y + 0.5) % 1 - 0.5) ** 2 + ((x - at_x + 0.5) % 1 - 0.5) ** 2
            height = np.minimum(height, squared * number * (1 + 2 * draw.random()) + 0.3 * draw.random())
    else:  # crests at the zeros of two fields
        height = np.abs(answers.field(points, case, low=max(low, 3)))
        height += 0.4 * np.abs(answers.field(points, case, 1, low=max(low, 6)))
    return 1e-3 * height


answers.height_of = height_of
answers.SMOOTH, answers.CREASED, answers.UNDER_HARDNESS = SMOOTH, CREASED, ()

if __name__ == "__main__":
    random_cases.run(
        __doc__,
        "paper/supplement/unseen.csv",
        answers.cases,
        answers.compared,
        answers.table,
        count=4,
        seed=33,
    )
