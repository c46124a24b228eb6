"""How often the interval of a planned ensemble holds the mean, on numbers whose mean is known.

    python benchmarks/multilevel.py
    python benchmarks/multilevel.py --plans 1000

Every plan draws its own seeds of a model and goes through all rounds, from the pilot to the result. In the
model, the number of a seed on a grid of n nodes on the shortest wavelength is

    1 + 0.05/n + 0.04 (0.5 s + 0.87 r + 2 e/n),

s, r and e being normally distributed: s is known from the surface alone, which has two more numbers that tell
nothing, r is the same on all grids, e differs from grid to grid. Times are proportional to the nodes of the
grid. The table has, for each target, the share of the 95 % intervals that hold the mean on the finest grid of
their plan; the root of the mean squared difference to the limit, over the target; and the median of the gain
over plain Monte Carlo.
"""

import argparse

import numpy as np

from asperity.markup import markdown
from asperity.paper.ensemble.planning import Plan, next_plan, pilot
from asperity.paper.ensemble.result import result
from asperity.paper.ensemble.samples import Samples

LIMIT, SLOPE, SCATTER = 1.0, 0.05, 0.04
SETTINGS = {"nodes": [4, 8, 16, 32, 64], "pilot": 6}
TIMES = {0.0: 1e-3, **{float(nodes): nodes**2 / 64 for nodes in SETTINGS["nodes"]}}
WAVELENGTH = [1 / 64]
COMMON = 1.0  # stands for what is the same on all grids
TARGETS = (0.01, 0.005, 0.003)


class Model:
    """Seeds of the model, drawn when they are asked for and kept."""

    def __init__(self, number: int) -> None:
        self.numbers: dict[float, np.ndarray] = {}
        self.streams = {node: np.random.default_rng([number, int(node)]) for node in (*TIMES, COMMON)}

    def normal(self, node: float, shape: tuple[int, ...]) -> np.ndarray:
        """Normal numbers of a node, the same first ones at every call."""
        have = self.numbers.get(node, np.empty((0, *shape[1:])))
        more = self.streams[node].normal(size=(max(shape[0] - len(have), 0), *shape[1:]))
        self.numbers[node] = np.concatenate([have, more])
        return self.numbers[node][: shape[0]]

    def samples(self, plan: Plan) -> Samples:
        """Samples of all seeds of a plan."""
        alone, levels = self.normal(0.0, (plan.seeds[0], 3)), []
        for node, seeds in zip(plan.nodes[1:], plan.seeds[1:], strict=True):
            common, own = self.normal(COMMON, (seeds,)), self.normal(node, (seeds,))
            random = 0.5 * alone[:seeds, 0] + 0.87 * common + 2 * own / node
            levels.append(LIMIT + SLOPE / node + SCATTER * random)
        times = tuple(np.full(n, TIMES[node]) for node, n in zip(plan.nodes, plan.seeds, strict=True))
        return Samples(plan.nodes, (alone, *levels), times)


def planned(number: int, error: float) -> tuple[bool, float, float]:
    """Whether the interval of one plan holds the mean, its difference to the limit, and its gain."""
    model, plan = Model(number), pilot(SETTINGS["nodes"], SETTINGS["pilot"], WAVELENGTH)
    while not plan.done:
        plan = next_plan(plan, model.samples(plan), TIMES, error, SETTINGS, WAVELENGTH)
    data = result(plan, model.samples(plan))
    mean = LIMIT + SLOPE / plan.nodes[-1]
    inside = float(data["estimate_low"]) < mean < float(data["estimate_high"])
    return inside, float(data["estimate"]) - LIMIT, float(data["gain"])


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--plans", type=int, default=300, help="plans for each target (default: %(default)s)")
    plans = parser.parse_args().plans
    rows = [["target", "intervals that hold the mean", "error over target", "gain"]]
    for error in TARGETS:
        inside, off, gain = np.array([planned(number, error) for number in range(plans)]).T
        spread = np.sqrt(np.mean(off**2)) / (error * LIMIT)
        rows.append([f"{error:.1%}", f"{inside.mean():.0%}", f"{spread:.2f}", f"{np.median(gain):.1f}"])
    print(markdown(rows))


if __name__ == "__main__":
    main()
