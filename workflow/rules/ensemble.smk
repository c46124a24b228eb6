# Means over random surfaces to a given error (multilevel Monte Carlo). A pilot and rounds of planning ask for samples:
# files of a few seeds of one surface on one grid, which all numbers and all targets share.
rule ensemble_samples:
    input:
        machine_code=MACHINE_CODE,
        code=code("ensemble_samples"),
    output:
        f"{SAMPLES}/{{surface}}/nodes{{nodes}}/seeds{{first}}-{{last}}.nc",
    log:
        f"{RESULTS}/log/ensemble/samples/{{surface}}/nodes{{nodes}}/seeds{{first}}-{{last}}.log",
    wildcard_constraints:
        nodes=r"\d+(\.\d+)?",
        first=r"\d+",
        last=r"\d+",
    threads: 1
    resources:
        mem_mb=memory("ensemble_samples"),
        disk_mb=disk("ensemble_samples"),
        runtime=minutes("ensemble_samples"),
    params:
        surface=surface_settings,
        layer=config["layer"],
        contact={**config["contact"], "path_area_fractions": []},
        stress=config["stress"],
        readings={name: config["readings"][name] for name in ("lateral", "shear", "patch_nodes")},
        fft_engine=FFT_ENGINE,
    script:
        "../scripts/ensemble_samples.py"


checkpoint ensemble_plan:
    input:
        samples=lambda wildcards: leaves_of_lists(planned_files(wildcards)),
        code=code("ensemble_plan"),
    output:
        f"{RESULTS}/ensemble/{{claim}}/error{{error}}/plan{{round}}.json",
    log:
        f"{RESULTS}/log/ensemble/{{claim}}/error{{error}}/plan{{round}}.log",
    wildcard_constraints:
        claim=NUMBER_NAME,
        error=r"[0-9.e-]+",
        round=r"[1-9]\d*",
    threads: 1
    resources:
        mem_mb=memory("ensemble_plan"),
        disk_mb=disk("ensemble_plan"),
        runtime=minutes("ensemble_plan"),
    params:
        files=planned_files,
        surfaces=lambda wildcards: ensemble_surfaces(wildcards.claim),
        wavelengths=lambda wildcards: ensemble_wavelengths(wildcards.claim),
        settings=ENSEMBLE,
        times=lambda wildcards: ensemble_times(wildcards.claim),
        earlier=lambda wildcards: earlier_plan(
            wildcards.claim, wildcards.error, int(wildcards.round) - 1
        ).as_entries(),
    script:
        "../scripts/ensemble_plan.py"


rule ensemble_result:
    input:
        samples=lambda wildcards: leaves_of_lists(final_files(wildcards)),
        plan=final_plan,
        style="src/asperity/views/style.mplstyle",
        code=code("ensemble_result"),
    output:
        data=f"{RESULTS}/ensemble/{{claim}}/error{{error}}/result.nc",
        table=f"{RESULTS}/ensemble/{{claim}}/error{{error}}/table.csv",
        text=f"{RESULTS}/ensemble/{{claim}}/error{{error}}/result.md",
        picture=report(
            f"{RESULTS}/ensemble/{{claim}}/error{{error}}/cost.png",
            caption="../report/ensemble.rst",
            category="Ensembles",
            labels={"number": "{claim}", "error": "{error}"},
        ),
    log:
        f"{RESULTS}/log/ensemble/{{claim}}/error{{error}}/result.log",
    wildcard_constraints:
        claim=NUMBER_NAME,
        error=r"[0-9.e-]+",
    threads: 1
    resources:
        mem_mb=memory("ensemble_result"),
        disk_mb=disk("ensemble_result"),
        runtime=minutes("ensemble_result"),
    params:
        files=final_files,
        surfaces=lambda wildcards: ensemble_surfaces(wildcards.claim),
    script:
        "../scripts/ensemble_result.py"


rule ensemble:
    input:
        data=expand(
            rules.ensemble_result.output.data, claim=ENSEMBLE["claims"], error=f"{ENSEMBLE['error']:g}"
        ),
        style="src/asperity/views/style.mplstyle",
        code=code("ensemble"),
    output:
        table=f"{RESULTS}/ensemble/table.csv",
        text=f"{RESULTS}/ensemble/table.md",
        picture=[
            report(
                f"{RESULTS}/ensemble/cost.png",
                caption="../report/ensemble.rst",
                category="Ensembles",
                labels={"number": "all", "error": f"{ENSEMBLE['error']:g}"},
            ),
            f"{RESULTS}/ensemble/cost.pdf",
        ],
    log:
        f"{RESULTS}/log/ensemble/table.log",
    threads: 1
    resources:
        mem_mb=memory("ensemble"),
        disk_mb=disk("ensemble"),
        runtime=minutes("ensemble"),
    params:
        claims=ENSEMBLE["claims"],
    script:
        "../scripts/ensemble.py"


rule ensemble_gains:
    input:
        samples=lambda wildcards: leaves_of_lists(sampled_files()),
        results=rules.ensemble.input.data,
        code=code("ensemble_gains"),
    output:
        table=f"{RESULTS}/ensemble/gains.csv",
        text=f"{RESULTS}/ensemble/gains.md",
    log:
        f"{RESULTS}/log/ensemble/gains.log",
    threads: 1
    resources:
        mem_mb=memory("ensemble_gains"),
        disk_mb=disk("ensemble_gains"),
        runtime=minutes("ensemble_gains"),
    params:
        files=lambda wildcards: sampled_files(),
        roles=ROLES_OF_DELTA,
        laterals=[name for name in config["readings"]["lateral"] if name != config["layer"]["lateral"]],
        error=ENSEMBLE["error"],
        fewest=ENSEMBLE["pilot"],
    script:
        "../scripts/ensemble_gains.py"
