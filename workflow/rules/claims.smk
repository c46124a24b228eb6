from asperity.config.reader import load
from asperity.config.study import PAPER
from asperity.paper.claims.sources import DATASETS, deltas, roles, with_deltas

# The statements are about the surfaces of the paper: a surface of another name has no role in them.
ROLES = roles(STUDIES, {name: SURFACES[name] for name in load(PAPER)["surfaces"] if name in SURFACES})
DELTAS = deltas(ROLES, SURFACES, config["readings"].get("delta", []))
ROLES_OF_DELTA = with_deltas(ROLES, DELTAS)
CLAIMED = sorted({name for by_role in (ROLES_OF_DELTA, *RESOLUTIONS.values()) for name in by_role.values()})
# Of every choice, the study's own option first.
READINGS = config["readings"] | {"lateral": [config["layer"]["lateral"], *OTHER_LATERALS], "delta": [*DELTAS]}
OTHERS = {
    name: [f"{RESULTS}/readings/{name}/statistics/{surface}.nc" for surface in CLAIMED]
    for name in OTHER_LATERALS
}


rule claims:
    input:
        statistics=[f"{RESULTS}/statistics/{surface}.nc" for surface in CLAIMED],
        validation=[f"{RESULTS}/validation/{name}.nc" for name in DATASETS if name in config["validation"]],
        others=[file for files in OTHERS.values() for file in files],
        style=STYLE,
        machine_code=MACHINE_CODE,
        code=code("claims"),
    output:
        table=f"{RESULTS}/claims.csv",
        readings=f"{RESULTS}/readings.csv",
        text=f"{RESULTS}/claims.md",
        page=report(
            f"{RESULTS}/claims.html",
            caption="../report/claims.rst",
            category="Claims",
            labels={"claims": "table"},
        ),
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
    threads: 1
    resources:
        mem_mb=memory("claims"),
        disk_mb=disk("claims"),
        runtime=minutes("claims"),
    params:
        roles=ROLES_OF_DELTA,
        resolutions=RESOLUTIONS,
        others=OTHERS,
        readings=READINGS,
        seeds=config["seeds"],
        nodes=min((s["points"] * s["wavelength_short"] for s in SURFACES.values()), default=0),
    script:
        "../scripts/claims.py"
