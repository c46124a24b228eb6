rule body:
    input:
        contact=f"{RESULTS}/contact/{{surface}}/seed{{seed}}.nc",
        compiled=COMPILED,
        code=code("body"),
    output:
        f"{RESULTS}/body/{{surface}}/seed{{seed}}.nc",
    log:
        f"{RESULTS}/log/body/{{surface}}/seed{{seed}}.log",
    benchmark:
        f"{RESULTS}/benchmark/body/{{surface}}/seed{{seed}}.tsv"
    threads: 1
    resources:
        mem_mb=memory("body"),
        disk_mb=disk("body"),
        runtime=minutes("body"),
    params:
        body=config["body"],
    script:
        "../scripts/body.py"
