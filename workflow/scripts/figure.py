"""Rule figure: a picture from its datasets, and its caption."""

from pathlib import Path

from asperity.paper.figures import caption, draw
from asperity.results import dataset
from asperity.runtime.logs import log_to
from asperity.views.style import save, style


def read(tree):
    """The datasets of a tree of files."""
    if isinstance(tree, str):
        return dataset.read(tree)
    return {name: read(branch) for name, branch in tree.items()}


with log_to(snakemake.log[0]), style(snakemake.input.style):
    module, results = snakemake.params.module, read(snakemake.params.results)
    save(draw(module, results), snakemake.output.png, snakemake.output.pdf)
    Path(snakemake.output.caption).write_text(caption(module, results), encoding="utf-8")
