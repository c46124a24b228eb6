"""Rule claims: statements of the paper, the numbers that decide them, and the verdicts."""

from pathlib import Path

from asperity.paper.claims import overview, report
from asperity.paper.claims.numbers import Evidence
from asperity.paper.claims.paper import CLAIMS, HEADLINES
from asperity.paper.claims.verdicts import decide
from asperity.results import dataset
from asperity.results.atomic import write_text
from asperity.results.tables import write_table
from asperity.study.runtime.job import job
from asperity.views.style import save, style

params, output = snakemake.params, snakemake.output
with job(snakemake), style():
    statistics, validation = (
        {Path(file).stem: dataset.read(file) for file in files}
        for files in (snakemake.input.statistics, snakemake.input.validation)
    )
    others = {
        lateral: {Path(file).stem: dataset.read(file) for file in snakemake.input.others if file in files}
        for lateral, files in params.others.items()
    }

    def evidence(names, validation=None):
        """Statistics of the surfaces by their role, under every condition of the mean (q = 0) mode."""
        laterals = {
            lateral: {role: of[name] for role, name in names.items()} for lateral, of in others.items()
        }
        return Evidence({role: statistics[name] for role, name in names.items()}, validation or {}, laterals)

    study = evidence(params.roles, validation)
    finer = {nodes: evidence(names) for nodes, names in params.resolutions.items()}
    findings = decide(CLAIMS, study, finer, params.interpretations)
    limits = report.continuum_table(HEADLINES, finer)
    write_table(report.frame(findings, params.nodes), "claims", output.table)
    write_table(report.frame_of_interpretations(findings), "claims_interpretations", output.interpretations)
    write_text(output.text, report.markdown(findings, params.seeds, params.nodes, limits))
    save(overview.draw(findings), *output.picture)
