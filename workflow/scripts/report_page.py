"""Rule report_page: the figures, verdicts, checks and costs of the study on one page."""

from pathlib import Path

from asperity.paper.figures import Description
from asperity.paper.page import write_page
from asperity.study.progress_and_log import job

with job(snakemake):
    figures = {name: Description(**found) for name, found in snakemake.params.figures.items()}
    page = Path(snakemake.output[0])
    write_page(page, page.parent, figures, snakemake.params.study)
