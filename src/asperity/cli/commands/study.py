"""``asperity study init``: a folder in which the study of the paper runs."""

from __future__ import annotations

import argparse

from asperity.core.errors import one_line
from asperity.core.packages import absent, install_command
from asperity.study.runtime.study_folder import make_study_folder

_NEXT = """\
next:
    cd {folder}
    snakemake --cores 2 --configfile config/quick.yaml    # every rule on small cells, one minute
    snakemake --cores 2 --configfile config/mine.yaml     # a study of your own, to change
    snakemake --cores 2                                   # the paper; figures in results/figures
config/README.md describes every setting"""


def run(options: argparse.Namespace) -> None:
    """Write the folder, and print the commands that run the study."""
    folder = one_line(str(make_study_folder(options.folder)))
    print(f"{folder}: Snakefile, config, profiles and workflow of the study")
    if missing := absent():
        print(f"first:\n    {install_command(missing)}")
    print(_NEXT.format(folder=folder))
