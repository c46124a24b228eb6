from dataclasses import asdict

# One job draws the figures of the same studies one after the other, because a process needs most of its time to
# start. Figures that are drawn when a job is killed stay in the folder of parameter `drawn`.
for group, names in DRAWN_TOGETHER.items():

    rule:
        name:
            f"figures_{group}"
        input:
            [leaves(figure_results(name)) for name in names],
        output:
            png=[
                report(
                    f"{RESULTS}/figures/{name}.png",
                    caption=os.path.abspath(f"{RESULTS}/figures/{name}.rst"),
                    category=FIGURES[name].category,
                    labels=figure_labels(name),
                )
                for name in names
            ],
            pdf=expand(f"{RESULTS}/figures/{{figure}}.pdf", figure=names),
            caption=expand(f"{RESULTS}/figures/{{figure}}.rst", figure=names),
        log:
            f"{RESULTS}/log/figures/{group}.log",
        benchmark:
            f"{RESULTS}/benchmark/figures/{group}.tsv"
        conda:
            "../envs/asperity.yaml"
        resources:
            **needs(f"figures_{group}"),
        params:
            figures={
                name: {
                    "code": code_of("figures.py", *modules_of(FIGURES[name])),
                    "description": asdict(FIGURES[name]),
                    "labels": surface_labels(name),
                    "results": figure_results(name),
                }
                for name in names
            },
            drawn=f"{RESULTS}/log/figures/{group}",
        script:
            "../scripts/figures.py"


rule figures:
    input:
        expand(f"{RESULTS}/figures/{{figure}}{{suffix}}", figure=FIGURES, suffix=[".png", ".pdf", ".rst"]),
