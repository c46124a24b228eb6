"""Rule claims: statements of the paper, the numbers that decide them, and the verdicts."""

from pathlib import Path

import pandas as pd

from asperity.paper.claims import report
from asperity.paper.claims.numbers import Evidence
from asperity.paper.claims.verdicts import CLAIMS, decide
from asperity.results import dataset
from asperity.results.atomic import write_text
from asperity.results.tables import write_table
from asperity.study.progress_and_log import job
from asperity.views.style import save, style

files, params, output = snakemake.input, snakemake.params, snakemake.output
with job(snakemake), style():
    statistics, validation = (
        {Path(path).stem: dataset.read(path) for path in paths}
        for paths in (files.statistics, files.validation)
    )
    evidence = Evidence({role: statistics[name] for role, name in params.roles.items()}, validation)
    table = report.frame_of_interpretations(decide(CLAIMS, evidence, params.interpretations))
    write_table(table, "claims_interpretations", output.interpretations, float_format="%.5g")
    findings = report.findings_of(
        pd.read_csv(output.interpretations), CLAIMS
    )  # with the digits that are kept
    write_table(report.frame(findings), "claims", output.table)
    write_text(output.text, f"# Does the paper hold?\n\n{report.markdown(findings)}")
    save(report.picture(findings), *output.picture)
