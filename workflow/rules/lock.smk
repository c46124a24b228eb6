# Lock of the results of a run. Snakemake's own lock outlives a process that is killed; the profiles turn it off.
import atexit
import sys
from contextlib import ExitStack
from pathlib import Path

from asperity.core.errors import DatasetError
from asperity.results.atomic import locked


def lock(folder):
    """Keep other runs from writing into a folder until this process ends; end it if another one does already."""
    held = ExitStack()
    try:
        held.enter_context(locked(Path(folder)))
    except DatasetError as error:
        sys.exit(f"study: {error}")
    atexit.register(held.close)
