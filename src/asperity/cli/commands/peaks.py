"""``asperity peaks``: distributions of the stress peaks of one surface, over its seeds."""

from __future__ import annotations

import argparse

import xarray as xr

from asperity.cli.arguments import section
from asperity.cli.files import check_out, read_in_cell_lengths, read_result, write_result
from asperity.pipeline.statistics import SeedResults, surface_statistics
from asperity.results import dataset
from asperity.results.systems import in_cell_lengths
from asperity.runtime.progress import ProgressBar
from asperity.stress.peak_kinds import selection_for
from asperity.surface.roughness import roughness_parameters

_PERCENTS = (50.0, 90.0, 99.0)


def run(options: argparse.Namespace) -> None:
    """Pool the peaks of all seeds, write their distributions, and print percentiles."""
    check_out([options.out], [*options.stress, *options.contact])
    if len(options.contact) != len(options.stress):
        raise ValueError(
            f"--contact: one for each stress is needed, "
            f"{len(options.contact)} for {len(options.stress)} given"
        )
    read = [read_in_cell_lengths(path, "stress") for path in options.stress]
    beside = [read_result(path, "contact") for path in options.contact]
    for path, contact in zip(options.stress, beside, strict=True):
        stress = read_result(path, "stress")
        made_from = {key: value for key, value in dataset.settings_of(stress).items() if key != "stress"}
        if made_from != dataset.settings_of(contact):
            raise ValueError(f"{path}: not made from the contact beside it; give both in the same order")
    chosen = section(options, "statistics")
    stresses = [stress for stress, _ in read]
    contacts = [in_cell_lengths(contact, {})[0] for contact in beside]
    settings = read[0][1] | {"statistics": chosen, "seed": [each["seed"] for _, each in read]}
    results = map(SeedResults, settings["seed"], map(_surface, contacts), contacts, stresses)
    with ProgressBar(f"peaks {settings['name']}"):
        result = surface_statistics(results, **chosen)
    write_result(result, options.out, "Statistics of rough surface", settings)
    print(_percentiles(result))


def _surface(contact: xr.Dataset) -> xr.Dataset:
    """Surface that a contact was solved for, and its moments: height = gap − displacement + approach."""
    height = contact["gap"] - contact["displacement"] + contact["approach"]
    height = height - height.mean()
    measured = roughness_parameters(height.values, dataset.grid_of(contact).length)
    names = ("rms_height", "rms_gradient", "skewness", "kurtosis")
    return xr.Dataset({"height": height, **{name: getattr(measured, name) for name in names}})


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
            lines.append(
                f"{quantity:<12}{nu:>7g}{counted:>8}" + "".join(f"{value:>7.3f}" for value in values)
            )
    return "\n".join(lines)
