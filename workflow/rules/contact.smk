rule contact:
    input:
        surface=f"{RESULTS}/surface/{{surface}}/seed{{seed}}.nc",
        machine_code=MACHINE_CODE,
        wisdom=fft_wisdom,
        code=code("contact"),
    output:
        f"{RESULTS}/contact/{{surface}}/seed{{seed}}.nc",
    log:
        f"{RESULTS}/log/contact/{{surface}}/seed{{seed}}.log",
    priority: PRIORITIES["contact"]
    threads: 1
    resources:
        mem_mb=memory("contact"),
        disk_mb=disk("contact"),
        runtime=minutes("contact"),
    params:
        layer=config["layer"],
        contact=contact_settings,
        fft_engine=FFT_ENGINE,
    script:
        "../scripts/contact.py"
