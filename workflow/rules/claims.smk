from asperity.config.reader import load
from asperity.config.study import PAPER
from asperity.paper.claims.sources import DATASETS, roles

# The statements are about the surfaces of the paper: a surface of another name has no role in them.
ROLES = roles(STUDIES, {name: SURFACES[name] for name in load(PAPER)["surfaces"] if name in SURFACES})


rule claims:
    input:
        statistics=expand(
            f"{RESULTS}/statistics/{{surface}}.nc",
            surface=sorted(
                {name for by_role in (ROLES, *RESOLUTIONS.values()) for name in by_role.values()}
            ),
        ),
        validation=[f"{RESULTS}/validation/{name}.nc" for name in DATASETS if name in config["validation"]],
        style=STYLE,
        machine_code=MACHINE_CODE,
        code=code("claims"),
    output:
        table=f"{RESULTS}/claims.csv",
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
    benchmark:
        f"{RESULTS}/benchmark/claims.tsv"
    threads: 1
    resources:
        mem_mb=memory("claims"),
        disk_mb=disk("claims"),
        runtime=minutes("claims"),
    params:
        roles=ROLES,
        resolutions=RESOLUTIONS,
        seeds=config["seeds"],
        nodes=min((s["points"] * s["wavelength_short"] for s in SURFACES.values()), default=0),
    script:
        "../scripts/claims.py"
