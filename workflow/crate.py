"""Describe the results of a finished study as an RO-Crate (https://w3id.org/ro/crate/1.1), in their folder.

    python workflow/crate.py [results] [--configfile FILE ...]

Writes ro-crate-metadata.json beside the results: the workflow, its run, the settings, and every result file
with its title and fingerprint. Repositories such as Zenodo and WorkflowHub read it. Needs rocrate:
pip install "asperity[crate]".
"""

import argparse
import sys
from pathlib import Path

try:
    from asperity.paper.crate import write_crate
except ImportError as error:
    sys.exit(f'crate: not installed: {error.name}; pip install "asperity[crate]"')


def main() -> None:
    """Write the crate."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("results", nargs="?", type=Path, default="results", help="folder of the results")
    parser.add_argument("--configfile", nargs="*", default=[], type=Path, help="configuration of the study")
    options = parser.parse_args()
    try:
        count = write_crate(options.results, Path("workflow/Snakefile"), options.configfile)
    except (FileNotFoundError, ValueError) as error:
        sys.exit(f"crate: {error}")
    print(f"{options.results}/ro-crate-metadata.json: {count} files")


if __name__ == "__main__":
    main()
