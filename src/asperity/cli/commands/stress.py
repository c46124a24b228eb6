"""``asperity stress``: stress inside the solid under a contact."""

import argparse

from asperity.cli.files import check_out, in_words, read_stage
from asperity.cli.parser import section
from asperity.core.errors import one_line
from asperity.results.dataset import settings_of, write_result
from asperity.results.variables import cell_length, in_cell_lengths, in_si
from asperity.study.progress_and_log import ProgressBar
from asperity.study.stages.stress import compute_stress


def run(options: argparse.Namespace) -> None:
    """Analyse the stress, write it, and print the largest von Mises stress and its depth."""
    check_out([("--out", options.out)], [options.contact])
    given = read_stage(options.contact, "contact")
    contact, settings = in_cell_lengths(given, settings_of(given))
    own = settings["layer"]["poisson"]
    chosen = {"poisson": [own], **section(options, "stress")}
    if contact.attrs["solid"] != "half-space" and chosen["poisson"] != [own]:
        raise ValueError(
            f"--poisson {' '.join(f'{nu:g}' for nu in chosen['poisson'])}: only {own:g} is accepted, "
            f"the ratio of the layer on which the contact was solved"
        )
    with ProgressBar(one_line(f"stress {settings['name']}")) as progress:
        by_lateral = compute_stress(contact, settings["layer"], chosen, progress=progress)
    result = by_lateral[settings["layer"]["lateral"]]
    si = given is not contact
    if si:
        result, _ = in_si(result, settings, cell_length(given), given.attrs["effective_modulus"])
    whole = settings_of(given) | {"stress": chosen}
    write_result(result, options.out, f"Stress under rough surface {settings['name']}", whole)
    for nu in result["poisson"].values:
        of_ratio = result.sel(poisson=nu)
        largest, depth = float(of_ratio["largest_von_mises"].max()), float(of_ratio["reference_depth"])
        print(
            f"poisson {nu:g}: largest von Mises stress {in_words(largest, 'Pa', si)} "
            f"at depth {in_words(depth, 'm', si)}"
        )
    if note := result.attrs.get("plastic_contact"):
        print(note)
