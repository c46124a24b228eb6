"""Rule report_page: the figures, verdicts, checks and costs of the study on one page."""

from asperity.runtime.preloaded import run_in_copy

run_in_copy()


from pathlib import Path

from asperity.paper.figures import Description
from asperity.paper.page import write_page
from asperity.runtime.logs import log_to

with log_to(snakemake.log[0], snakemake.output):
    figures = {name: Description(**found) for name, found in snakemake.params.figures.items()}
    page = Path(snakemake.output[0])
    write_page(page, page.parent, figures, snakemake.params.study)
