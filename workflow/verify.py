"""Check every file of a study's results and name the damaged ones (`make verify`).

    python workflow/verify.py [results] [--cores N]

Every file of results is compared with the fingerprint that the log of its job holds; a result file of NetCDF
without one with that in the file itself. Snakemake's records of the jobs, by which it sees that a setting has
changed, must be readable. Logs and folders of other studies below the folder are left out. Ends with
exit status 1 and one line for each damaged file.
"""

from __future__ import annotations

import argparse
import json
import os
import sys
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from pathlib import Path

from asperity.errors import DatasetError
from asperity.runtime.interrupts import Interrupted, interruptible
from asperity.runtime.preflight import LOCK, OWNER
from asperity.runtime.snakemake_internals import record_of
from asperity.runtime.written import LOGS, is_as_written, require_as_written, written

INTERRUPTED = "verify: interrupted; run the same command again"


def files_of(folder: Path) -> Iterator[Path]:
    """Files of results of one study, without those of studies in folders below."""
    for place, below, names in os.walk(folder):
        top = Path(place) == folder
        below[:] = sorted(
            name for name in below if not (Path(place) / name / OWNER).exists() and not (top and name == LOGS)
        )
        yield from (
            Path(place) / name
            for name in sorted(names)
            if ".unfinished" not in name and name not in (OWNER, LOCK)
        )


def damage(stated: dict[str, str], path: Path) -> str:
    """One line about a damaged file; empty if it is whole."""
    try:
        require_as_written(path, stated)
    except DatasetError as error:
        return str(error)
    return ""


def damaged_records(paths: list[Path]) -> list[str]:
    """One line for every file whose record by Snakemake is missing or cannot be read.

    There are none for results that were made elsewhere.
    """
    records = {path: record for path in paths if (record := record_of(path)) is not None}
    if not any(record.exists() for record in records.values()):
        return []
    return [
        f"{record}: damaged record of {path}; delete {path} and run again"
        for path, record in records.items()
        if not _is_readable(record)
    ]


def _is_readable(record: Path) -> bool:
    """True for a record of Snakemake that is a group of keys in JSON."""
    try:
        return bool(json.loads(record.read_bytes()))
    except (OSError, ValueError):
        return False


def verify(folder: Path, cores: int | None) -> str:
    """Check all files of a folder; one line about them, or `SystemExit` with one for each damaged file."""
    stated = written(folder)
    # The largest files last would leave all but one processor idle.
    paths = sorted(files_of(folder), key=lambda path: path.stat().st_size, reverse=True)
    if not any(path.suffix == ".nc" for path in paths):
        sys.exit(f"verify: {folder}: no results; name the folder of a study")
    with ThreadPoolExecutor(cores) as pool:
        whole = list(pool.map(partial(is_as_written, stated=stated), paths))
    # One after another, as the NetCDF library is made for one thread.
    damaged = [damage(stated, path) for path, known in zip(paths, whole, strict=True) if not known]
    damaged += damaged_records([path for path in paths if os.path.normpath(path) in stated])
    if lines := sorted(filter(None, damaged)):
        sys.exit("\n".join(f"verify: {line}" for line in lines))
    return f"verify: {len(paths)} files in {folder} are as they were written"


def main() -> None:
    """Check all files of a folder."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("results", nargs="?", type=Path, default="results", help="folder (%(default)s)")
    parser.add_argument("--cores", type=int, default=os.cpu_count())
    chosen = parser.parse_args()
    try:
        with interruptible(INTERRUPTED, last=True):
            print(verify(chosen.results, chosen.cores))
    except Interrupted as interrupted:
        print(INTERRUPTED, file=sys.stderr)
        sys.exit(interrupted.status)


if __name__ == "__main__":
    main()
