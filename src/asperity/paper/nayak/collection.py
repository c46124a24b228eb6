"""Samples of all surfaces of the configuration on all grids, computed where they are missing."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import xarray as xr

from asperity.paper.nayak.samples import sample
from asperity.pipeline.blocks import grid_points
from asperity.results import dataset
from asperity.runtime.progress import ProgressBar

FEWEST_SEEDS = 2
"""Seeds of a surface on its finest grid, from which its scatter is known."""


COARSEST = 4
"""Share of the coarsest grid, from which most of the scatter comes, over that of any other."""


def seeds_on(wavelength_short: float, nodes: Sequence[float], grid_nodes: int, most_seeds: int) -> list[int]:
    """Number of seeds of a surface on each grid, coarse to fine.

    All seeds of one grid have `grid_nodes` nodes together, those of the coarsest `COARSEST` times as many.
    """
    share = [grid_nodes * (COARSEST if n == min(nodes) else 1) for n in sorted(nodes)]
    several = [s // grid_points(wavelength_short, n) ** 2 for s, n in zip(share, sorted(nodes), strict=True)]
    return [max(FEWEST_SEEDS, min(most_seeds, number)) for number in several]


def collect(config: Mapping[str, Any]) -> dict[str, dict[float, xr.Dataset]]:
    """Samples of all surfaces, read from their files or computed.

    Parameters
    ----------
    config : mapping
        Configuration, as of `asperity.config.study.read_study`. The files are in the folder ``samples`` of
        its results. A file made from other settings is computed anew.

    Returns
    -------
    dict
        Surface → nodes on the shortest wavelength, rising → dataset of `asperity.paper.nayak.samples.sample`.
    """
    settings = config["nayak"]
    found: dict[str, dict[float, xr.Dataset]] = {}
    for name, surface in config["surfaces"].items():
        grids = sorted(settings["nodes"])
        seeds = seeds_on(surface["wavelength_short"], grids, settings["grid_nodes"], settings["most_seeds"])
        for nodes, count in zip(grids, seeds, strict=True):
            path = Path(config["results"]) / "samples" / name / f"nodes{nodes:g}.nc"
            band = {key: value for key, value in surface.items() if key not in ("label", "points")}
            made_from = {
                "name": name,
                "surface": band,
                "nodes": nodes,
                "seeds": count,
                "loads": settings["loads"],
            }
            found.setdefault(name, {})[nodes] = _sampled(path, made_from)
    return found


def _sampled(path: Path, made_from: dict[str, Any]) -> xr.Dataset:
    """Samples of one surface on one grid, from their file if it was made from the same settings."""
    kept = dataset.read_made_from(path, made_from)
    if kept is not None:
        return kept
    name, nodes = made_from["name"], made_from["nodes"]
    with ProgressBar(f"{name}, {nodes:g} nodes") as progress:
        seeds = range(1, made_from["seeds"] + 1)
        found = sample(made_from["surface"], nodes, seeds, made_from["loads"], progress)
    dataset.write(
        found, path, f"Contact of surface {name}, {nodes:g} nodes on its shortest wavelength", made_from
    )
    return dataset.read(path)
