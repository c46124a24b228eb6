"""``asperity stress``: stress inside the solid under a contact."""

from __future__ import annotations

import argparse
from functools import partial

from asperity.cli.arguments import section
from asperity.cli.compiling import compile_visibly, stress_small
from asperity.cli.files import check_out, read_result, write_result
from asperity.pipeline.stress import compute_stress
from asperity.results import dataset
from asperity.runtime.progress import ProgressBar


def run(options: argparse.Namespace) -> None:
    """Analyse the stress, write it, and print the largest von Mises stress and its depth."""
    check_out([options.out], [options.contact])
    contact = read_result(options.contact, "contact")
    settings = dataset.settings_of(contact)
    own = settings["layer"]["poisson"]
    chosen = {"poisson": [own], **section(options, "stress")}
    if contact.attrs["solid"] != "half-space" and chosen["poisson"] != [own]:
        raise ValueError(
            f"--poisson {' '.join(f'{nu:g}' for nu in chosen['poisson'])}: only {own:g} is accepted, "
            f"the ratio of the layer on which the contact was solved"
        )
    compile_visibly("stress", partial(stress_small, settings["layer"], chosen))
    with ProgressBar(f"stress {settings['name']}") as progress:
        result = compute_stress(contact, settings["layer"], chosen, progress=progress)
    write_result(result, options.out, "Stress under rough surface", settings | {"stress": chosen})
    for nu in result["poisson"].values:
        of_ratio = result.sel(poisson=nu)
        print(
            f"poisson {nu:g}: largest von Mises stress {float(of_ratio['largest_von_mises'].max()):.6g} E* "
            f"at depth {float(of_ratio['reference_depth']):.6g}"
        )
