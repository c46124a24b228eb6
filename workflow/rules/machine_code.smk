# Machine code of the numba functions, compiled once for all jobs that call them: these jobs then need less memory, and
# do not compile the same functions side by side. The rule has no inputs: functions changed later are compiled by the
# jobs that call them. Its output must be a plain input of these jobs. Of an ancient() one, Snakemake would not look at
# them in a run in which this rule itself is new or was cut off, and would end as if they were made.
PARTS = ("contact", "stress")


rule machine_code:
    output:
        f"{RESULTS}/machine_code/{{part}}.txt",
    log:
        f"{RESULTS}/log/machine_code/{{part}}.log",
    wildcard_constraints:
        part="|".join(PARTS),
    priority: PRIORITIES["machine_code"]
    threads: 1
    resources:
        mem_mb=memory("machine_code"),
        disk_mb=disk("machine_code"),
        runtime=minutes("machine_code"),
    script:
        "../scripts/machine_code.py"


MACHINE_CODE = expand(rules.machine_code.output, part=PARTS)
