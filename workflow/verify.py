"""Check every result of a study against its fingerprint and name the damaged ones (`make verify`).

    python workflow/verify.py [results] [--cores N]

A result file of NetCDF is read whole and compared with the fingerprint in it; of other files only the size is
known, and an empty one is damaged. Folders of other studies below the folder are left out. Ends with exit
status 1 and one line for each damaged file.
"""

from __future__ import annotations

import argparse
import os
import sys
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

from asperity.errors import DatasetError
from asperity.results import dataset
from asperity.runtime.preflight import LOCK, OWNER

MAY_BE_EMPTY = {".log", OWNER, LOCK}
"""Names and suffixes of files that may be empty."""


def files_of(folder: Path) -> Iterator[Path]:
    """Result files of one study, without those of studies in folders below."""
    for place, below, names in os.walk(folder):
        below[:] = sorted(name for name in below if not (Path(place) / name / OWNER).exists())
        yield from (Path(place) / name for name in sorted(names) if ".unfinished" not in name)


def damage(path: Path) -> str:
    """One line about a damaged result file; empty if it is whole."""
    if path.suffix == ".nc":
        try:
            dataset.verify(path)
        except DatasetError as error:
            return str(error)
    elif not path.stat().st_size and not {path.suffix, path.name} & MAY_BE_EMPTY:
        return f"{path}: empty; delete it and run again"
    return ""


def main() -> None:
    """Check all files of a folder."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("results", nargs="?", type=Path, default="results", help="folder (%(default)s)")
    parser.add_argument("--cores", type=int, default=os.cpu_count())
    chosen = parser.parse_args()
    # The largest files last would leave all but one processor idle.
    paths = sorted(files_of(chosen.results), key=lambda path: path.stat().st_size, reverse=True)
    results = [path for path in paths if path.suffix == ".nc"]
    if not results:
        sys.exit(f"verify: {chosen.results}: no results; name the folder of a study")
    with ProcessPoolExecutor(chosen.cores) as pool:
        damaged = sorted(filter(None, pool.map(damage, paths)))
    if damaged:
        sys.exit("\n".join(f"verify: {line}" for line in damaged))
    print(f"verify: {len(results)} results in {chosen.results} are as they were written")


if __name__ == "__main__":
    main()
