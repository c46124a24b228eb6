from asperity.claims import resolutions, roles
from asperity.statements import DATASETS

CONTINUUM_SEEDS = config["seeds"][:2]
SUMMARY = f"{RESULTS}/summary/{{}}/seed{{}}.json"

# Role → summaries of its surface, one for each seed; and the same for each resolution of the continuum study.
CLAIM_MEMBERS = {
    role: [SUMMARY.format(name, seed) for seed in config["seeds"]]
    for role, name in roles(config["studies"], SURFACES).items()
}
FINER_MEMBERS = {
    nodes: {role: [SUMMARY.format(name, seed) for seed in CONTINUUM_SEEDS] for role, name in names.items()}
    for nodes, names in resolutions(SURFACES).items()
}


rule summary:
    input:
        surface=f"{RESULTS}/surface/{{surface}}/seed{{seed}}.nc",
        contact=f"{RESULTS}/contact/{{surface}}/seed{{seed}}.nc",
        body=f"{RESULTS}/body/{{surface}}/seed{{seed}}.nc",
        code=code("summary"),
    output:
        f"{RESULTS}/summary/{{surface}}/seed{{seed}}.json",
    log:
        f"{RESULTS}/log/summary/{{surface}}/seed{{seed}}.log",
    benchmark:
        f"{RESULTS}/benchmark/summary/{{surface}}/seed{{seed}}.tsv"
    script:
        "../scripts/summary.py"


rule summaries:
    input:
        [file for files in CLAIM_MEMBERS.values() for file in files],


rule claims:
    input:
        summaries=sorted(
            {
                file
                for members in (CLAIM_MEMBERS, *FINER_MEMBERS.values())
                for files in members.values()
                for file in files
            }
        ),
        validation=[
            f"{RESULTS}/validation/{name}.nc" for name in DATASETS if name in config.get("validation", {})
        ],
        style="src/asperity/figures/style.mplstyle",
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
    params:
        members=CLAIM_MEMBERS,
        finer=FINER_MEMBERS,
        seeds=config["seeds"],
        nodes=min(s["points"] * s["wavelength_short"] for s in SURFACES.values()),
    script:
        "../scripts/claims.py"
