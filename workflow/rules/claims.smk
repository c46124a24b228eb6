rule summary:
    input:
        surface=f"{RESULTS}/surface/{{surface}}/seed{{seed}}.nc",
        contact=f"{RESULTS}/contact/{{surface}}/seed{{seed}}.nc",
        stress=f"{RESULTS}/stress/{{surface}}/seed{{seed}}.nc",
        code=code("summary"),
    output:
        f"{RESULTS}/summary/{{surface}}/seed{{seed}}.json",
    log:
        f"{RESULTS}/log/summary/{{surface}}/seed{{seed}}.log",
    benchmark:
        f"{RESULTS}/benchmark/summary/{{surface}}/seed{{seed}}.tsv"
    threads: 1
    resources:
        mem_mb=memory("summary"),
        disk_mb=disk("summary"),
        runtime=minutes("summary"),
    script:
        "../scripts/summary.py"


rule summaries:
    input:
        lambda wildcards: [file for files in claim_members().values() for file in files],


rule claims:
    input:
        summaries=lambda wildcards: sorted(
            {
                file
                for members in (claim_members(), *finer_members().values())
                for files in members.values()
                for file in files
            }
        ),
        validation=claim_datasets,
        style="src/asperity/paper/figures/style.mplstyle",
        machine_code=MACHINE_CODE,
        code=code("claims"),
    output:
        table=report(
            f"{RESULTS}/claims.csv",
            caption="../report/claims.rst",
            category="Claims",
            labels={"claims": "table"},
        ),
        text=f"{RESULTS}/claims.md",
        picture=[
            report(
                f"{RESULTS}/claims.png",
                caption="../report/claims.rst",
                category="Claims",
                labels={"claims": "picture"},
            ),
            f"{RESULTS}/claims.pdf",
        ],
    log:
        f"{RESULTS}/log/claims.log",
    benchmark:
        f"{RESULTS}/benchmark/claims.tsv"
    threads: 1
    resources:
        mem_mb=memory("claims"),
        disk_mb=disk("claims"),
        runtime=minutes("claims"),
    params:
        members=lambda wildcards: claim_members(),
        finer=lambda wildcards: finer_members(),
        seeds=config["seeds"],
        nodes=min(s["points"] * s["wavelength_short"] for s in SURFACES.values()),
    script:
        "../scripts/claims.py"
