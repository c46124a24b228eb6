"""``asperity wisdom``: measured plans of FFTW."""

from __future__ import annotations

import argparse

from asperity.cli.files import check_out
from asperity.pipeline.wisdom import measure_plans
from asperity.results.atomic import write_text
from asperity.runtime.progress import ProgressBar


def run(options: argparse.Namespace) -> None:
    """Measure the plans and write them."""
    check_out([options.out])
    with ProgressBar("plans of FFTW") as progress:
        write_text(options.out, measure_plans(options.points, progress))
