from asperity.settings.reader import load
from asperity.settings.study import PAPER
from asperity.paper.claims.sources import CHOICES, DATASETS, surfaces_by_delta, roles

# The statements are about the surfaces of the paper: a surface of another name has no role in them.
ROLES = roles(STUDIES, {name: SURFACES[name] for name in load(PAPER)["surfaces"] if name in SURFACES})
DELTAS = surfaces_by_delta(ROLES, SURFACES)
ROLES_OF_DELTA = ROLES | {role: name for found in DELTAS.values() for role, name in found.items()}
CLAIMED = sorted({*ROLES_OF_DELTA.values()})
# The study's own option of every choice comes first.
INTERPRETATIONS = CHOICES | {
    "lateral": [config["layer"]["lateral"], *OTHER_LATERALS],
    "delta": [*DELTAS],
}


rule claims:
    input:
        statistics=[f"{RESULTS}/statistics/{surface}.nc" for surface in CLAIMED],
        validation=[f"{RESULTS}/validation/{name}.nc" for name in DATASETS if name in config["validation"]],
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
    conda:
        "../envs/asperity.yaml"
    resources:
        **needs("claims"),
    params:
        code=code_of("claims.py"),
        roles=ROLES_OF_DELTA,
        interpretations=INTERPRETATIONS,
    script:
        "../scripts/claims.py"
