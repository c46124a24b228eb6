rule body:
    input:
        contact=f"{RESULTS}/contact/{{surface}}/seed{{seed}}.nc",
        code=code("body"),
    output:
        f"{RESULTS}/body/{{surface}}/seed{{seed}}.nc",
    log:
        f"{RESULTS}/log/body/{{surface}}/seed{{seed}}.log",
    benchmark:
        f"{RESULTS}/benchmark/body/{{surface}}/seed{{seed}}.tsv"
    params:
        body=config["body"],
    script:
        "../scripts/body.py"
