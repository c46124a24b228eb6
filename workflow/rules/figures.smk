from pathlib import Path

from asperity.paper.figures import describe_all

FIGURES = describe_all(config["studies"])


def figure_results(figure):
    """Results that a figure is drawn from: stage -> (study ->) surface or dataset -> file.

    A figure shows the statistics of all seeds, and the surface and the contact of the first one.
    """

    def result(stage, name):
        seed = f"/seed{config['seeds'][0]}" if stage in ("surface", "contact") else ""
        return f"{RESULTS}/{stage}/{name}{seed}.nc"

    return FIGURES[figure].results(config["studies"], result)


def leaves(tree):
    """The files of a tree of files."""
    return [tree] if isinstance(tree, str) else [file for branch in tree.values() for file in leaves(branch)]


def figure_labels(wildcards):
    """Number or name of a figure and its studies, as the report lists them: sorted as text."""
    figure = FIGURES[wildcards.figure]
    return {
        "figure": figure.number or figure.name,
        "study": " and ".join(figure.studies) or "validation",
    }


rule figure:
    input:
        results=lambda wildcards: leaves(figure_results(wildcards.figure)),
        style="src/asperity/views/style.mplstyle",
        code=lambda wildcards: code("figure", f"asperity.paper.figures.{FIGURES[wildcards.figure].module}"),
    output:
        png=report(
            f"{RESULTS}/figures/{{figure}}.png",
            caption="../report/figure.rst",
            category=lambda wildcards: (
                "Figures of the paper" if FIGURES[wildcards.figure].in_paper else "Supplement"
            ),
            labels=figure_labels,
        ),
        pdf=f"{RESULTS}/figures/{{figure}}.pdf",
        caption=f"{RESULTS}/figures/{{figure}}.rst",
    log:
        f"{RESULTS}/log/figure/{{figure}}.log",
    benchmark:
        f"{RESULTS}/benchmark/figure/{{figure}}.tsv"
    wildcard_constraints:
        figure="|".join(FIGURES),
    threads: 1
    resources:
        mem_mb=memory("figure"),
        disk_mb=disk("figure"),
        runtime=minutes("figure"),
    params:
        module=lambda wildcards: FIGURES[wildcards.figure].module,
        results=lambda wildcards: figure_results(wildcards.figure),
        caption=lambda wildcards, output: Path(output.caption),  # read when the report is made
    script:
        "../scripts/figure.py"


rule figures:
    input:
        expand(f"{RESULTS}/figures/{{figure}}.png", figure=FIGURES),
