"""Samples of a number on every level, read from the files of its surfaces."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np
import xarray as xr

from asperity.paper.ensemble.numbers import values
from asperity.pipeline.blocks import SURFACE_ALONE
from asperity.pipeline.ensemble import SURFACE_NUMBERS
from asperity.results import dataset
from asperity.types import Array


class Samples(NamedTuple):
    """A number on every level, coarse to fine.

    Parameters
    ----------
    nodes : tuple of float
        Nodes on the shortest wavelength; `SURFACE_ALONE` for the surface alone, whose numbers are
        `SURFACE_NUMBERS` of all surfaces.
    values : tuple of (seeds,) or (seeds, numbers) arrays
        For seeds 1, 2, 3, …
    times : tuple of (seeds,) arrays
        Processor time of each seed, all surfaces together.
    """

    nodes: tuple[float, ...]
    values: tuple[Array, ...]
    times: tuple[Array, ...]

    @property
    def seconds(self) -> list[float]:
        """Processor time of one seed on each level: the median."""
        return [float(np.median(times)) for times in self.times]

    def first(self, seeds: Sequence[int]) -> Samples:
        """The first seeds of each level; levels without seeds are left out."""
        kept = [level for level, number in enumerate(seeds) if number]
        return Samples(
            tuple(self.nodes[level] for level in kept),
            tuple(self.values[level][: seeds[level]] for level in kept),
            tuple(self.times[level][: seeds[level]] for level in kept),
        )


def read_samples(
    name: str,
    surfaces: Mapping[str, str],
    files: Mapping[float, Mapping[str, Sequence[str]]],
) -> Samples:
    """Samples of a number.

    Parameters
    ----------
    name : str
        Of the number.
    surfaces : mapping
        Role → surface, as of `asperity.paper.ensemble.numbers.surfaces_of`.
    files : mapping
        Nodes on the shortest wavelength → surface → files of `asperity.pipeline.ensemble.sample`. Surfaces
        that the number does not depend on are not read; of two surfaces, the seeds that both have.
    """
    nodes = sorted(files)
    found, times = [], []
    for node in nodes:
        read = {surface: _joined(files[node][surface]) for surface in dict.fromkeys(surfaces.values())}
        common = min(data.sizes["seed"] for data in read.values())
        read = {surface: data.isel(seed=slice(common)) for surface, data in read.items()}
        times.append(np.sum([data["seed_seconds"].values for data in read.values()], axis=0))
        if node == SURFACE_ALONE:
            alone = [data[f"seed_{name}"].values for data in read.values() for name in SURFACE_NUMBERS]
            found.append(np.stack(alone, axis=1))
        else:
            found.append(values(name, {role: read[surface] for role, surface in surfaces.items()}))
    return Samples(tuple(nodes), tuple(found), tuple(times))


def _joined(paths: Sequence[str]) -> xr.Dataset:
    """The seeds of several files, rising."""
    return xr.concat([dataset.read(path) for path in paths], "seed", combine_attrs="override").sortby("seed")
