"""Rule figure: a picture from its datasets, and its caption."""

from asperity.paper.figures import Description, caption, draw
from asperity.results import dataset
from asperity.results.atomic import write_text
from asperity.study.job import job
from asperity.views.style import save, style


def read(tree, name=""):
    """The datasets of a tree of files, with the labels of their surfaces."""
    if not isinstance(tree, str):
        return {name: read(branch, name) for name, branch in tree.items()}
    labels = snakemake.params.labels
    return dataset.read(tree).assign_attrs({"label": labels[name]} if name in labels else {})


with job(snakemake), style():
    figure, results = Description(**snakemake.params.figure), read(snakemake.params.results)
    save(draw(figure, results), snakemake.output.png, snakemake.output.pdf)
    write_text(snakemake.output.caption, caption(figure, results))
