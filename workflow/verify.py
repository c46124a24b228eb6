"""Compare the results of a study with the manifest of its last run (`make verify`).

    python workflow/verify.py [results]

Names every file that is missing, changed or extra; exit status 1 if one is missing or changed.
"""

import argparse
import sys
from pathlib import Path

from asperity.core.errors import DatasetError
from asperity.study.runtime.manifest import MANIFEST, compare, read_manifest


def main() -> None:
    """Compare all files of a folder."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("results", nargs="?", type=Path, default="results", help="folder (%(default)s)")
    folder = parser.parse_args().results
    if not (folder / MANIFEST).is_file():
        sys.exit(f"verify: {folder}: no {MANIFEST}; name the folder of a study that has run to its end")
    try:
        found = list(compare(folder))
    except (DatasetError, OSError) as error:
        sys.exit(f"verify: {error}")
    for name, what in found:
        print(f"verify: {folder / name}: {what}", file=sys.stderr)
    if any(what != "extra" for _, what in found):
        sys.exit("verify: delete what is changed and run the study again, which makes what is missing")
    print(f"verify: {len(read_manifest(folder))} files in {folder} are as they were written")


if __name__ == "__main__":
    main()
