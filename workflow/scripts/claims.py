"""Rule claims: statements of the paper, the numbers that decide them, and the verdicts."""

from pathlib import Path

from asperity.paper.claims import overview, report
from asperity.paper.claims.evidence import Evidence
from asperity.paper.claims.statements import CLAIMS, HEADLINES
from asperity.paper.claims.verdicts import decide
from asperity.results import dataset
from asperity.runtime.logs import log_to
from asperity.runtime.progress import ProgressBar
from asperity.views.style import save, style

params, output = snakemake.params, snakemake.output
with log_to(snakemake.log[0], snakemake.output), ProgressBar("claims"), style(snakemake.input.style):
    statistics, validation = (
        {Path(file).stem: dataset.read(file) for file in files}
        for files in (snakemake.input.statistics, snakemake.input.validation)
    )
    study = Evidence({role: statistics[name] for role, name in params.roles.items()}, validation)
    finer = {
        nodes: Evidence({role: statistics[name] for role, name in names.items()})
        for nodes, names in params.resolutions.items()
    }
    findings, limits = decide(CLAIMS, study, finer), report.continuum_table(HEADLINES, finer)
    dataset.write_table(report.frame(findings, params.nodes), output.table)
    text = report.markdown(findings, params.seeds, params.nodes, limits)
    dataset.write_text(output.text, text)
    dataset.write_text(output.page, report.page(findings, limits))
    save(overview.draw(findings), *output.picture)
