"""Families of surfaces that engineers press, and contacts drawn from them.

A family gives the relief of a surface: heights from 0, the nodes that touch first, to about 1. A contact
multiplies the relief by a height and adds an offset. Its settings are drawn from `FAMILY_LEVELS`, or given
one by one. The study of stability, the random search and the tests draw from here.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from asperity.core.types import Array
from asperity.elasticity.solid import Solid
from asperity.elasticity.two_bodies import Solids, TwoBodies

# Surfaces


class Nodes:
    """Positions of the nodes of a cell of edge 1, from its middle node, and random numbers.

    Parameters
    ----------
    shape : (ny, nx)
    size : float
        Radius or width of the feature of a family, over the edge of the cell.
    seed : int
    """

    def __init__(self, shape: tuple[int, int], size: float, seed: int) -> None:
        y, x = (np.arange(n) / n - (n // 2) / n for n in shape)
        self.y, self.x = np.meshgrid(y, x, indexing="ij")
        self.radius = np.hypot(self.y, self.x)
        self.square = np.maximum(abs(self.y), abs(self.x))
        self.size = size
        self.random = np.random.default_rng(seed)

    @property
    def rough(self) -> Array:
        """Waves of random phases, of lengths from half of the cell to eight nodes."""
        ny, nx = shape = self.x.shape
        wave = np.hypot(np.fft.fftfreq(ny, 1 / ny)[:, None], np.arange(nx // 2 + 1))
        inside = (wave >= 2) & (wave <= max(3, min(shape) / 8))
        spectrum = np.exp(2j * np.pi * self.random.random(wave.shape)) * inside / np.maximum(wave, 1) ** 1.8
        return unit(np.fft.irfft2(spectrum, shape))

    @property
    def middle(self) -> Array:
        """True at the middle node."""
        return self.radius == 0


def unit(values: Array) -> Array:
    """Values moved and scaled to the range from 0 to 1; zeros if they are all the same."""
    values = values - values.min()
    return values / (values.max() or 1.0)


def plateaus(nodes: Nodes) -> Array:
    """A rough surface whose lowest part is worn flat; `size` of all nodes are worn."""
    rough = nodes.rough
    return unit(np.maximum(rough, np.quantile(rough, nodes.size)))


def spikes(nodes: Nodes) -> Array:
    """Single nodes at random places, low by the whole relief."""
    low = nodes.random.random(nodes.x.shape) < 0.02
    low.flat[nodes.random.integers(low.size)] = True
    return np.where(low, 0.0, 1 + 0.01 * nodes.random.random(low.shape))


FAMILIES: dict[str, Callable[[Nodes], Array]] = {
    "round punch": lambda n: 1.0 * (n.radius >= n.size),
    "square punch": lambda n: 1.0 * (n.square >= n.size),
    "ring": lambda n: 1.0 * ((n.radius >= n.size) | (n.radius < 0.6 * n.size)),
    "terraces": lambda n: np.floor(3.999 * np.minimum(n.radius / n.size, 1)) / 3,
    "steps": lambda n: np.floor((n.x + 0.5) * (2 + round(10 * n.size))) / (1 + round(10 * n.size)),
    "groove": lambda n: 1.0 * (abs(n.x) < n.size / 2),
    "grating": lambda n: 1.0 * ((8 * n.x + 4) % 1 >= n.size),
    "pit": lambda n: 1.0 * (n.radius < n.size),
    "pits": lambda n: 1.0 * (np.cos(6 * np.pi * n.x) * np.cos(6 * np.pi * n.y) > 1 - 2 * n.size),
    "worn plateaus": plateaus,
    "seal": lambda n: np.minimum(((n.radius - n.size) / (0.3 * n.size)) ** 2, 1),
    "worn seal": lambda n: np.clip(abs(n.radius - n.size) / (0.2 * n.size) - 0.5, 0, 1),
    "ridge": lambda n: np.minimum((n.x / n.size) ** 2, 1),
    "sphere": lambda n: np.minimum((n.radius / n.size) ** 2, 1),
    "cone": lambda n: np.minimum(n.radius / n.size, 1),
    "pyramid": lambda n: np.minimum(n.square / n.size, 1),
    "tilt": lambda n: unit(n.x),
    "rough": lambda n: n.rough,
    "8-bit map": lambda n: unit(np.round(255 * n.rough)),
    "10 levels": lambda n: unit(np.round(9 * n.rough)),
    "noise": lambda n: unit(n.random.standard_normal(n.x.shape)),
    "spikes": spikes,
    "checkerboard": lambda n: np.indices(n.x.shape).sum(axis=0) % 2.0,
    "one node lower": lambda n: 1.0 * ~n.middle,
    "one node higher": lambda n: 1.0 * n.middle,
    "flat": lambda n: 0 * n.x,
}
"""Relief of each family on some nodes."""

# Solids

SOLIDS: dict[str, Solids] = {
    "half-space": Solid(1.0, 0.3),
    "incompressible": Solid(1.0, 0.5),
    "layer": Solid(1.0, 0.3, 0.2),
    "frictionless": Solid(1.0, 0.3, 0.1, "frictionless"),
    "thin": Solid(1.0, 0.3, 1e-3),
    "very thin": Solid(1.0, 0.2, 1e-5),
    "thin, ν = ½": Solid(1.0, 0.5, 1e-2),
    "free bottom": Solid(1.0, 0.3, 0.3, "free"),
    "sheet": Solid(1.0, 0.3, 0.03, "free"),
    "two bodies": TwoBodies(Solid(1.0, 0.3), Solid(0.1, 0.4, 0.02)),
    "two half-spaces": TwoBodies(Solid(1.0, 0.3), Solid(0.2, 0.45)),
    "hard film": Solid(1.0, 0.2, 0.01, base=Solid(0.01, 0.49)),
    "very hard film": Solid(1.0, 0.3, 1e-3, base=Solid(1e-5, 0.3)),
    "soft coating": Solid(1.0, 0.4, 0.03, base=Solid(20.0, 0.3)),
    "rubber film": Solid(1.0, 0.5, 3e-3, base=Solid(1e5, 0.3)),
    "stack": Solid.stack([(0.01, 1.0, 0.2), (0.005, 0.1, 0.5), (0.02, 3.0, 0.3)], base=Solid(0.2, 0.3)),
    "stack, rigid base": Solid.stack([(0.01, 1.0, 0.3), (0.03, 0.1, 0.4)], bottom="frictionless"),
    "coated bodies": TwoBodies(
        Solid(1.0, 0.3, 0.02, base=Solid(0.1, 0.3)), Solid(0.5, 0.5, 0.1, base=Solid(5.0, 0.3))
    ),
}
HALF_SPACES = ("half-space", "incompressible", "two half-spaces")
"""Solids that a free boundary accepts."""


# Contacts


@dataclass(frozen=True)
class FamilyCase:
    """A contact of a surface of a family.

    `relief` is the height by which the relief is multiplied, over the edge of the cell; `offset` the height
    of the lowest nodes, over `relief`; `imposed` is ``("load", p̄/E*)``, ``("force", F/E*)``, ``("area",
    fraction)``, or ``("approach", part)`` of the way from the lowest to the mean height; `hardness` is over
    an imposed mean pressure, else over E* times the relief, None in an elastic contact; `precision` is the
    type of the fields and the tolerance.
    """

    family: str
    shape: tuple[int, int] = (32, 32)
    relief: float = 1.0
    offset: float = 0.0
    imposed: tuple[str, float] = ("load", 1e-3)
    boundary: str = "periodic"
    solid: str = "half-space"
    hardness: float | None = None
    precision: tuple[str, float] = ("float64", 1e-6)
    size: float = 0.4
    seed: int = 1


FAMILY_LEVELS: dict[str, tuple[Any, ...]] = {
    "shape": (
        *((1, 1), (1, 7), (2, 3), (5, 5)),
        *((31, 31), (32, 32), (33, 33), (16, 64), (53, 18), (101, 101), (128, 128)),
    ),
    "relief": (1e-6, 1e-3, 1.0, 1e3, 1e6),
    "offset": (0.0, -1e3, 1e6, 1e13),
    "imposed": (
        *(("load", 10.0**exponent) for exponent in range(-10, 1)),
        ("force", 1e-4),
        *(("area", fraction) for fraction in (1e-9, 0.1, 0.5, 1.0)),
        *(("approach", part) for part in (1e-6, 0.03, 0.5, 0.999)),
    ),
    "boundary": ("periodic", "free"),
    "solid": tuple(SOLIDS),
    "hardness": (None, 1.001, 2.0, 30.0),
    "precision": (("float64", 1e-6), ("float64", 1e-10), ("float32", 1e-4), ("float32", 1e-6)),
}
"""Levels of each setting: even, odd, prime and oblong grids, and loads over ten decades."""

SIZES = (0.1, 0.2, 0.3, 0.4)


def drawn(random: np.random.Generator, family: str, **given: Any) -> FamilyCase:
    """A contact with some settings given; each of the others is drawn, or its default half of the times.

    A free boundary has a half-space.
    """
    settings = {name: levels[random.integers(len(levels))] for name, levels in FAMILY_LEVELS.items()}
    settings = {name: value for name, value in settings.items() if random.random() < 0.5} | given
    size, seed = SIZES[random.integers(len(SIZES))], int(random.integers(100))
    case = FamilyCase(family, size=size, seed=seed, **settings)
    if case.boundary == "free" and case.solid not in HALF_SPACES:
        change = {"boundary": "periodic"} if "solid" in given else {"solid": "half-space"}
        return replace(case, **change)
    return case


def family_levels() -> Iterator[tuple[str, Any]]:
    """Setting and value of every level."""
    return ((name, value) for name, values in FAMILY_LEVELS.items() for value in values)


def family_height(case: FamilyCase) -> Array:
    """Height of the indenter of a case."""
    relief = FAMILIES[case.family](Nodes(case.shape, case.size, case.seed))
    return case.relief * (relief + case.offset)


def family_arguments(case: FamilyCase) -> tuple[Array, Solids, dict[str, Any], dict[str, Any]]:
    """Height, solid, the imposed quantity, and the other keywords of `asperity.solve_contact`."""
    height, solid = family_height(case), SOLIDS[case.solid]
    kind, value = case.imposed
    modulus = solid.effective_modulus
    imposed = {
        "load": {"mean_pressure": value * modulus},
        "force": {"force": value * modulus},
        "area": {"contact_area_fraction": value},
        "approach": {"approach": float(height.min() + value * (height.mean() - height.min()))},
    }[kind]
    dtype, rtol = case.precision
    settings: dict[str, Any] = {"boundary": case.boundary, "dtype": dtype, "rtol": rtol}
    if case.hardness is not None:
        unit_of_hardness = value if kind in ("load", "force") else case.relief
        settings["hardness"] = case.hardness * unit_of_hardness * modulus
    return height, solid, imposed, settings
