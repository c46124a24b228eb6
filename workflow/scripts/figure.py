"""Rule figure: a picture from its datasets, and its caption."""

from asperity.runtime.preloaded import run_in_copy

run_in_copy()


from asperity.paper.figures import caption, draw
from asperity.results import dataset
from asperity.results.atomic import write_text
from asperity.runtime.logs import log_to
from asperity.views.style import save, style


def read(tree, name=""):
    """The datasets of a tree of files, with the labels of their surfaces."""
    if not isinstance(tree, str):
        return {name: read(branch, name) for name, branch in tree.items()}
    labels = snakemake.params.labels
    return dataset.read(tree).assign_attrs({"label": labels[name]} if name in labels else {})


with log_to(snakemake.log[0], snakemake.output), style(snakemake.input.style):
    params = snakemake.params
    module, results = params.module, read(params.results)
    save(draw(module, results), snakemake.output.png, snakemake.output.pdf)
    text = caption(module, results, numbered=not params.own)
    write_text(snakemake.output.caption, text)
