# The stages of the study. Of the jobs that are ready, jobs of a higher priority start first: the longest chain, from the
# contact to the stress on the largest grid, starts early, and small jobs fill the time left. One job makes a surface and
# its contact: starting a job takes longer than making most surfaces.
rule contact:
    input:
        map=lambda wildcards: [entry["file"] for _, entry in maps_of_surface(wildcards.surface)],
    output:
        surface=f"{RESULTS}/surface/{{surface}}/seed{{seed}}.nc",
        contact=f"{RESULTS}/contact/{{surface}}/seed{{seed}}.nc",
    log:
        f"{RESULTS}/log/contact/{{surface}}/seed{{seed}}.log",
    benchmark:
        f"{RESULTS}/benchmark/contact/{{surface}}/seed{{seed}}.tsv"
    wildcard_constraints:
        surface=any_of(sorted({*MADE.values()})),
    priority: 2
    conda:
        "../envs/asperity.yaml"
    resources:
        **needs("contact"),
    params:
        code=code_of("contact.py"),
        surface=lambda wildcards: settings_of_surface(wildcards.surface),
        layer=config["layer"],
        contact=contact_settings,
        fft_engine=FFT_ENGINE,
    script:
        "../scripts/contact.py"


# The surface of another entry, pressed under another load.
use rule contact as contact_again with:
    input:
        surface=lambda wildcards: result_of_seed("surface", wildcards.surface, wildcards.seed),
    output:
        contact=f"{RESULTS}/contact/{{surface}}/seed{{seed}}.nc",
    wildcard_constraints:
        surface=any_of(sorted({*MADE} - {*MADE.values()})),


rule stress:
    input:
        contact=rules.contact.output.contact,
    output:
        f"{RESULTS}/stress/{{surface}}/seed{{seed}}.nc",
    log:
        f"{RESULTS}/log/stress/{{surface}}/seed{{seed}}.log",
    benchmark:
        f"{RESULTS}/benchmark/stress/{{surface}}/seed{{seed}}.tsv"
    priority: 1
    conda:
        "../envs/asperity.yaml"
    resources:
        **needs("stress"),
    params:
        code=code_of("stress.py"),
        stress=stress_settings,
        laterals=laterals_of,
        quantities=OTHER_COMPONENTS,
        fft_engine=FFT_ENGINE,
    script:
        "../scripts/stress.py"


rule statistics:
    input:
        surface=results_of_seeds("surface"),
        contact=results_of_seeds("contact"),
        stress=results_of_seeds("stress"),
    output:
        statistics=f"{RESULTS}/statistics/{{surface}}.nc",
        checks=f"{RESULTS}/verification/{{surface}}.csv",
        page=report(
            f"{RESULTS}/verification/{{surface}}.html",
            caption="../report/verification.rst",
            category="Verification",
            labels=lambda wildcards: {"surface": wildcards.surface},
        ),
    log:
        f"{RESULTS}/log/statistics/{{surface}}.log",
    benchmark:
        f"{RESULTS}/benchmark/statistics/{{surface}}.tsv"
    conda:
        "../envs/asperity.yaml"
    resources:
        **needs("statistics"),
    params:
        code=code_of("statistics.py"),
        statistics=config["statistics"],
        fft_engine=FFT_ENGINE,
    script:
        "../scripts/statistics.py"
