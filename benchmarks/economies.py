"""Processor time that each economy of the calculation saves, measured by turning it off.

    python benchmarks/economies.py [--points 512]

Eight nodes on the shortest wavelength, a tenth of the cell in contact, four Poisson's ratios. Each time is
the shortest of some repetitions, on one thread.
"""

import argparse
import tempfile
from pathlib import Path

import one_thread  # noqa: F401

# isort: split

import numpy as np
import xarray as xr
from contact_run import rough
from timing import seconds

import asperity as asp
from asperity.elasticity.layer import COMPONENTS
from asperity.pipeline.solid import solid
from asperity.results import dataset

RATIOS = (0.0, 0.25, 0.33, 0.5)
SLAB = {"height": 1.0, "bottom": "bonded", "poisson": 0.33, "lateral": "confined"}


def press(height, layer):
    return asp.solve(height, layer, area_fraction=0.1)


def layer_of(half_space_tolerance, poisson=0.33):
    return solid({**SLAB, "poisson": poisson, "half_space_tolerance": half_space_tolerance})[0]


def half_space(height):
    """The slab as a half-space, and as the layer that it is, for one Poisson's ratio."""

    def analyse(tolerance):
        contact = press(height, layer_of(tolerance))
        asp.analyse_stress(contact, asp.depth_grid(contact.grid, 1.0), tolerance=1e-4)

    return lambda: analyse(0.05), lambda: analyse(0.0)


def every_ratio(height):
    """One contact and one stream of planes for all Poisson's ratios, and one of each for every ratio."""

    def together():
        contact = press(height, layer_of(0.05))
        asp.analyse_stress(contact, asp.depth_grid(contact.grid, 1.0), RATIOS, tolerance=1e-4)

    def apart():
        for poisson in RATIOS:
            contact = press(height, asp.Layer(1 - poisson**2, poisson))
            asp.analyse_stress(contact, asp.depth_grid(contact.grid, 1.0), tolerance=1e-4)

    return together, apart


def coarse_planes(height):
    """Deep planes on coarse grids, and all planes on the grid of the contact."""
    contact = press(height, layer_of(0.05))
    depths = asp.depth_grid(contact.grid, 1.0)
    return (
        lambda: asp.analyse_stress(contact, depths, RATIOS, tolerance=1e-4),
        lambda: asp.analyse_stress(contact, depths, RATIOS, tolerance=0),
    )


def on_demand(height):
    """One component of the stress, and all six."""
    contact = press(height, layer_of(0.05))
    depths = asp.depth_grid(contact.grid, 1.0)

    def planes(fields):
        for _ in asp.stress_planes(contact, depths, fields=fields, tolerance=1e-4):
            pass

    return lambda: planes(("zz",)), lambda: planes(COMPONENTS)


def no_field_written(height, folder):
    """The result alone, and the stress field of every plane in a second file; the paths of both files."""
    contact = press(height, layer_of(0.05))
    depths = asp.depth_grid(contact.grid, 1.0)
    paths = folder / "kept.nc", folder / "field.nc"

    def kept():
        data = asp.analyse_stress(contact, depths, tolerance=1e-4)
        dataset.write(data, paths[0], title="economies", settings={})

    def everything():
        kept()
        field = np.empty((depths.size, len(COMPONENTS), *contact.grid.shape))
        for number, plane in enumerate(asp.stress_planes(contact, depths, None, COMPONENTS, tolerance=0)):
            field[number] = np.stack([plane.fields[name][0] for name in COMPONENTS])
        encoding = {"stress": {"zlib": True, "complevel": 1, "shuffle": True}}
        xr.Dataset({"stress": (("plane", "component", "y", "x"), field)}).to_netcdf(
            paths[1], engine="netcdf4", encoding=encoding
        )

    return kept, everything, paths


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--points", type=int, default=512)
    parser.add_argument("--repetitions", type=int, default=2)
    chosen = parser.parse_args()
    points = chosen.points
    height = rough(points, 0.8)
    economies = {
        "half-space where the layer cannot be told apart": half_space(height),
        "one contact and one stream for four Poisson's ratios": every_ratio(height),
        "deep planes on coarse grids": coarse_planes(height),
        "one component where one is asked for": on_demand(height),
    }
    for use, _ in economies.values():
        use()  # compiles
    print("| economy | seconds | without it | saves |\n|---|---|---|---|")
    for name, calls in economies.items():
        short, long = (seconds(call, chosen.repetitions) for call in calls)
        print(f"| {name} | {short:.2f} | {long:.2f} | {100 * (1 - short / long):.0f} % |")
    with tempfile.TemporaryDirectory() as folder:
        kept, everything, paths = no_field_written(height, Path(folder))
        short, long = seconds(kept, 1), seconds(everything, 1)
        one, both = paths[0].stat().st_size, sum(path.stat().st_size for path in paths)
        name = "no stress field written"
        print(f"| {name} | {short:.2f} | {long:.2f} | {100 * (1 - short / long):.0f} % |")
        print(f"| {name}, MB | {one / 1e6:.1f} | {both / 1e6:.0f} | {100 * (1 - one / both):.1f} % |")


if __name__ == "__main__":
    main()
