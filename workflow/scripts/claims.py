"""Rule claims: what the paper says, beside what is measured, and whether it holds."""

import csv
from pathlib import Path

from asperity.paper.claims.statements import CLAIMS, HEADLINES
from asperity.paper.claims.verdicts import COLUMNS, Evidence, continuum_markdown, decide, markdown, rows
from asperity.paper.figures.claims import draw
from asperity.paper.figures.style import save, style
from asperity.pipeline.summary import read
from asperity.results import dataset
from asperity.runtime.logs import log_to
from asperity.runtime.progress import ProgressBar


def members(files):
    """Role → file of each seed, read."""
    return {role: [read(file) for file in each] for role, each in files.items()}


with log_to(snakemake.log[0]), ProgressBar("claims"), style(snakemake.input.style):
    params = snakemake.params
    validation = {Path(file).stem: dataset.read(file) for file in snakemake.input.validation}
    evidence = Evidence(members(params.members), validation)
    finer = {nodes: Evidence(members(files)) for nodes, files in params.finer.items()}
    findings = decide(CLAIMS, evidence, finer)
    with open(snakemake.output.table, "w", newline="", encoding="utf-8") as file:
        table = csv.DictWriter(file, COLUMNS, lineterminator="\n")
        table.writeheader()
        table.writerows(rows(findings, params.nodes))
    text = markdown(findings, params.seeds, params.nodes) + continuum_markdown(HEADLINES, finer)
    Path(snakemake.output.text).write_text(text, encoding="utf-8")
    save(draw(findings), *snakemake.output.picture)
