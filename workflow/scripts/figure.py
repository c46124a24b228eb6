"""Rule figure: a picture from its datasets, and its caption."""

from importlib import import_module
from pathlib import Path

from asperity.paper.figures.captions import caption
from asperity.paper.figures.style import save, style
from asperity.results import dataset
from asperity.runtime.logs import log_to


def read(files):
    """The datasets of a tree of files."""
    if isinstance(files, str):
        return dataset.read(files)
    return {name: read(branch) for name, branch in files.items()}


with log_to(snakemake.log[0]), style(snakemake.input.style):
    stages = {stage: read(files) for stage, files in snakemake.params.stages.items()}
    name = snakemake.wildcards.figure.split("_")[0]
    figure = import_module(f"asperity.paper.figures.{name}").draw(**stages)
    save(figure, snakemake.output.png, snakemake.output.pdf)
    Path(snakemake.output.caption).write_text(caption(name, stages), encoding="utf-8")
