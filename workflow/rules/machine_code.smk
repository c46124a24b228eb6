# Machine code of the numba functions, compiled once for all jobs that call them: these jobs then need less memory, and
# do not compile the same functions side by side. The rule has no inputs and runs only if its output is missing. If it
# ran again, Snakemake would not see what else is new to the later jobs, of which its output is an ancient() input.
# Functions changed later are compiled by the jobs that call them.
PARTS = ("contact", "stress")


rule machine_code:
    output:
        f"{RESULTS}/machine_code/{{part}}.txt",
    log:
        f"{RESULTS}/log/machine_code/{{part}}.log",
    benchmark:
        f"{RESULTS}/benchmark/machine_code/{{part}}.tsv"
    wildcard_constraints:
        part="|".join(PARTS),
    priority: 1
    threads: 1
    resources:
        mem_mb=memory("machine_code"),
        disk_mb=disk("machine_code"),
        runtime=minutes("machine_code"),
    message:
        f"compiling the functions of the {{wildcards.part}}, once for all jobs: about {job_cost('machine code').seconds:.0f} s"
    script:
        "../scripts/machine_code.py"


MACHINE_CODE = ancient(expand(rules.machine_code.output, part=PARTS))
