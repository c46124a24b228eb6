# Once for all jobs that call compiled functions: they need less memory then, and do not compile side by side.
# It runs only where its output is missing, and so has no inputs: a job that runs again would hide from Snakemake
# what else is new to the jobs after it, of which it is an ancient() input. A changed function is compiled by the
# jobs that call it.
PARTS = ("contact", "stress")


rule compiled:
    output:
        f"{RESULTS}/compiled/{{part}}.txt",
    log:
        f"{RESULTS}/log/compiled/{{part}}.log",
    benchmark:
        f"{RESULTS}/benchmark/compiled/{{part}}.tsv"
    wildcard_constraints:
        part="|".join(PARTS),
    priority: 1
    threads: 1
    resources:
        mem_mb=memory("compiled"),
        disk_mb=disk("compiled"),
        runtime=minutes("compiled"),
    script:
        "../scripts/compiled.py"


COMPILED = ancient(expand(rules.compiled.output, part=PARTS))
