"""``asperity plan``: cost and error of a calculation before it is made, and settings that reach a target."""

import argparse
from dataclasses import replace

from asperity.paper.figures import surfaces_with_load_area
from asperity.study.cost.plan import PEAK_OUTPUTS, Target, assess, planned_contacts, propose, read, report

_GIB = 2**30


def run(options: argparse.Namespace) -> None:
    """Print cost and error of the given settings, or of settings proposed for a target."""
    config = read(options.config, options.contact_area_fraction)
    surfaces, accuracy = planned_contacts(config, surfaces_with_load_area(config))
    outputs = options.output or PEAK_OUTPUTS
    memory = None if options.memory is None else options.memory * _GIB
    if options.error is None and options.seconds is None and memory is None:
        found = assess(list(surfaces.values()), accuracy, options.one_surface)
    else:
        target = Target(outputs, options.error, options.seconds, memory, options.one_surface)
        surfaces = {name: replace(each, points_per_wavelength=None) for name, each in surfaces.items()}
        found = propose(list(surfaces.values()), target)
    print(report(found, surfaces, outputs, options.one_surface))
