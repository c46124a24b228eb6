"""Surroundings of a job of the workflow: its log file, the engine of its Fourier transforms, its progress."""

from __future__ import annotations

import logging
import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from asperity.study.runtime.progress import ProgressBar


@contextmanager
def job(snakemake: Any) -> Iterator[ProgressBar]:
    """Run the block as a job of Snakemake, and give it its progress to report to.

    Parameters
    ----------
    snakemake : snakemake.script.Snakemake
        What Snakemake gives to a script: the job has a log, and may have a parameter ``fft_engine``.
    """
    log_to(snakemake.log[0])
    with ProgressBar(" ".join([snakemake.rule, *snakemake.wildcards])) as progress:
        if engine := snakemake.params.get("fft_engine"):
            from asperity.fourier import fft_engine  # takes time, and figures need no transforms

            with fft_engine(engine):
                yield progress
        else:
            yield progress


def log_to(path: str | os.PathLike[str]) -> None:
    """Send everything that this process and its programs print, log and warn of to a file, until it ends."""
    Path(path).parent.mkdir(parents=True, exist_ok=True)
    with open(path, "w", encoding="utf-8") as file:
        for stream in (sys.stdout, sys.stderr):
            stream.flush()
            os.dup2(file.fileno(), stream.fileno())
    logging.basicConfig(stream=sys.stderr, format="%(asctime)s %(levelname)s %(message)s")
    logging.getLogger("asperity").setLevel(logging.INFO)
    logging.captureWarnings(True)
