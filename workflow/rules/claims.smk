from asperity.study.config.reader import load
from asperity.study.config.study import PAPER
from asperity.paper.claims.sources import DATASETS, deltas, roles

# The statements are about the surfaces of the paper: a surface of another name has no role in them.
ROLES = roles(STUDIES, {name: SURFACES[name] for name in load(PAPER)["surfaces"] if name in SURFACES})
DELTAS = deltas(ROLES, SURFACES, config["interpretations"].get("delta", []))
ROLES_OF_DELTA = ROLES | {role: name for found in DELTAS.values() for role, name in found.items()}
CLAIMED = sorted({name for by_role in (ROLES_OF_DELTA, *RESOLUTIONS.values()) for name in by_role.values()})
# Of every choice, the study's own option first.
INTERPRETATIONS = config["interpretations"] | {
    "lateral": [config["layer"]["lateral"], *OTHER_LATERALS],
    "delta": [*DELTAS],
}
OTHERS = {
    name: [f"{RESULTS}/interpretations/{name}/statistics/{surface}.nc" for surface in CLAIMED]
    for name in OTHER_LATERALS
}


rule claims:
    input:
        statistics=[f"{RESULTS}/statistics/{surface}.nc" for surface in CLAIMED],
        validation=[f"{RESULTS}/validation/{name}.nc" for name in DATASETS if name in config["validation"]],
        others=[file for files in OTHERS.values() for file in files],
    output:
        table=f"{RESULTS}/claims.csv",
        interpretations=f"{RESULTS}/interpretations.csv",
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
    resources:
        **needs("claims"),
    params:
        code=DRAWING,
        roles=ROLES_OF_DELTA,
        resolutions=RESOLUTIONS,
        others=OTHERS,
        interpretations=INTERPRETATIONS,
        seeds=config["seeds"],
        nodes=min((s["points"] * s["wavelength_short"] for s in SURFACES.values()), default=0),
    script:
        "../scripts/claims.py"
