"""Rules figures_...: pictures of the same studies from their datasets, and their captions.

Pictures are moved to their final names when all are drawn. Pictures of a job that was killed are kept, and
are not drawn again from the same results.
"""

import os
import re
import shutil
from pathlib import Path

from asperity.paper.figures import Description, caption, draw
from asperity.results import dataset
from asperity.results.atomic import write_text
from asperity.study.progress_and_log import job
from asperity.views.style import save, style


def read(tree, labels, name=""):
    """The datasets of a tree of files, with the labels of their surfaces."""
    if not isinstance(tree, str):
        return {name: read(branch, labels, name) for name, branch in tree.items()}
    return dataset.read(tree).assign_attrs({"label": labels[name]} if name in labels else {})


files, params, output = snakemake.input, snakemake.params, snakemake.output
with job(snakemake) as progress, style():
    read_now = [(file, os.stat(file).st_mtime_ns) for file in files]
    places = zip(output.png, output.pdf, output.caption, strict=True)
    moves = {}
    for (name, figure), final in zip(params.figures.items(), places, strict=True):
        folder = Path(params.drawn, f"{name}_{dataset.digest({'figure': figure, 'files': read_now})}")
        png, pdf, text = drawn = [folder / Path(place).name for place in final]
        if not text.exists():
            description = Description(**figure["description"])
            results = read(figure["results"], figure["labels"])
            folder.mkdir(parents=True, exist_ok=True)
            save(draw(description, results), png, pdf)
            # Snakemake's report takes `{{`, `{%` and `{#` for commands; `\ ` separates them and is not shown.
            write_text(text, re.sub(r"{(?=[{%#])", r"{\\ ", caption(description, results)))
        moves |= zip(drawn, final, strict=True)
        progress(len(moves), 3 * len(params.figures))
    for source, place in moves.items():
        source.replace(place)
    shutil.rmtree(params.drawn)
