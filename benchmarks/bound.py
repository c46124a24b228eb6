"""Search for a mode in a layer whose stress is above the bound of the modes that a coarse grid drops.

    python benchmarks/bound.py --layers 100000 --seed 1
    python benchmarks/bound.py --layers 100000 --seed 1 --coated

draws layers with q height from 0.01 to 10, ν from −0.9 to 0.5, both bottoms, any depth, friction from 0 to 1
(on a bonded bottom) in any direction, and prints the maximum stress of any kind over its bound; with
``--coated`` half-spaces under coatings of q height from 1e-4 to 30, with a ratio of the moduli from 1e-4 to
1e4, to a depth of three heights. The phase is searched in steps of five degrees.
"""

import numpy as np
from measuring import parser_of

import asperity as asp
from asperity.core.types import Array
from asperity.stress.planes.truncation import envelope_of

PHASE = np.radians(np.arange(0.0, 180.0, 5.0))


def largest_field(layer: asp.Solid, q: float, depth: float, friction: float, angle: float) -> float:
    """Largest component, principal stress, largest shear or von Mises stress of a unit mode."""
    cosine, sine = np.cos(PHASE), np.sin(PHASE)
    poisson = layer.poisson if layer.base is None or depth <= 1 else layer.base.poisson
    z, along, shear = (float(kernel) for kernel in layer.kernels(q, depth)[:3])
    tensor = np.zeros((PHASE.size, 3, 3))

    def add(i: int, j: int, values: Array) -> None:
        tensor[:, i, j] += values
        if i != j:
            tensor[:, j, i] += values

    for i, amplitude in enumerate((along, poisson * (z + along), z)):
        add(i, i, -amplitude * cosine)
    add(0, 2, shear * sine)
    if friction:
        n, m, x, across, turn = (float(kernel) for kernel in layer.shear_kernels(q, depth))
        for i, amplitude in enumerate((m, poisson * (n + m), n)):
            add(i, i, -friction * np.cos(angle) * amplitude * sine)
        add(0, 2, friction * np.cos(angle) * x * cosine)
        add(1, 2, friction * np.sin(angle) * across * cosine)
        add(0, 1, -friction * np.sin(angle) * turn * sine)
    low, middle, high = np.linalg.eigvalsh(tensor).T
    von_mises = np.sqrt(0.5 * ((low - middle) ** 2 + (middle - high) ** 2 + (high - low) ** 2))
    return float(max(np.abs(tensor).max(), -low.min(), high.max(), von_mises.max()))


def main() -> None:
    """Print the largest ratio."""
    parser = parser_of(__doc__)
    parser.add_argument("--layers", type=int, default=100_000)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--coated", action="store_true")
    options = parser.parse_args()
    random, worst = np.random.default_rng(options.seed), 0.0
    for _ in range(options.layers):
        scaled, share = 10 ** random.uniform(-2, 1), random.uniform() ** random.choice([0.2, 1.0, 5.0])
        bottom = str(random.choice(["bonded", "frictionless"]))
        layer = asp.Solid(1.0, random.uniform(-0.9, 0.5), 1.0, bottom)
        if options.coated:
            base = asp.Solid(10 ** random.uniform(-4, 4), random.uniform(-0.9, 0.5))
            bottom, scaled, share = "bonded", 10 ** random.uniform(-4, 1.5), 3 * share
            layer = asp.Solid(1.0, layer.poisson, 1.0, base=base)
        friction = random.uniform() if bottom == "bonded" else 0.0
        found = largest_field(layer, scaled, share, friction, random.uniform(0, np.pi))
        decayed = (1 + scaled * share) * np.exp(-scaled * share)
        worst = max(worst, found / (envelope_of(layer, layer.poisson, friction, share) * decayed))
    print(f"{options.layers} layers, seed {options.seed}: maximum stress over its bound {worst:.4f}")


if __name__ == "__main__":
    main()
