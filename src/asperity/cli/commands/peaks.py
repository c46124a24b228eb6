"""``asperity peaks``: distributions of the stress peaks of one surface, over its seeds."""

import argparse

import xarray as xr

from asperity.cli.files import check_out, read_stage
from asperity.cli.parser import section
from asperity.core.errors import one_line
from asperity.results.dataset import grid_of, height_of, settings_of, write_result
from asperity.results.variables import in_cell_lengths
from asperity.stress.peaks.selection import selection_for
from asperity.study.progress_and_log import ProgressBar
from asperity.study.stages.statistics import SeedResults, surface_statistics
from asperity.surface.roughness import surface_dataset

_PERCENTS = (50.0, 90.0, 99.0)


def run(options: argparse.Namespace) -> None:
    """Pool the peaks of all seeds, write their distributions, and print percentiles."""
    check_out([("--out", options.out)], [*options.stress, *options.contact])
    if len(options.contact) != len(options.stress):
        given = f"{len(options.contact)} for {len(options.stress)} given"
        raise ValueError(f"--contact: one for each stress is needed, {given}")
    seeds, all_settings = [], []
    for stress_path, contact_path in zip(options.stress, options.contact, strict=True):
        stress, contact = read_stage(stress_path, "stress"), read_stage(contact_path, "contact")
        made_from = {key: value for key, value in settings_of(stress).items() if key != "stress"}
        if made_from != settings_of(contact):
            text = "not made from the contact beside it; give both in the same order"
            raise ValueError(f"{stress_path}: {text}")
        stress, own = in_cell_lengths(stress, settings_of(stress))
        contact, _ = in_cell_lengths(contact, {})
        height = height_of(contact)
        surface = surface_dataset((height - height.mean()).values, grid_of(contact))
        seeds.append(SeedResults(own["seed"], surface, contact, stress))
        all_settings.append(own)
    chosen = section(options, "statistics")
    settings = all_settings[0] | {"statistics": chosen, "seed": [own["seed"] for own in all_settings]}
    with ProgressBar(one_line(f"peaks {settings['name']}")):
        result = surface_statistics(seeds, **chosen)
    write_result(result, options.out, f"Statistics of rough surface {settings['name']}", settings)
    print(_percentiles(result))


def _percentiles(result: xr.Dataset) -> str:
    """Number of peaks and percentiles of their magnitude, for every quantity and Poisson's ratio."""
    head = "".join(f"{percent:>5.0f} %" for percent in _PERCENTS)
    lines = [
        f"quantity    poisson   peaks{head}  (magnitudes over E* times rms gradient,",
        f"{'':26}{'':{len(head)}}  peaks as the figures count them)",
    ]
    for quantity in result["quantity"].values:
        for nu in result["poisson"].values:
            chosen = result.sel(quantity=quantity, poisson=nu, selection=selection_for(quantity))
            counted = int(chosen["peak_counts"].sum())
            values = chosen["peak_percentile"].sel(percent=list(_PERCENTS)).values
            numbers = "".join(f"{value:>7.3f}" for value in values)
            lines.append(f"{quantity:<12}{nu:>7g}{counted:>8}{numbers}")
    return "\n".join(lines)
