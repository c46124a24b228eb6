# Plans of FFTW for the grids of the study, measured once for all jobs: two measurements may end with different plans,
# which round differently. The rule has no code as input, so that a new version of the library keeps the plans. Jobs on
# other grids, as of the validation, take plans that FFTW estimates, which are the same in every run.
rule fft_wisdom:
    output:
        f"{RESULTS}/fft_wisdom/{{points}}.json",
    log:
        f"{RESULTS}/log/fft_wisdom/{{points}}.log",
    benchmark:
        f"{RESULTS}/benchmark/fft_wisdom/{{points}}.tsv"
    wildcard_constraints:
        points=r"\d+",
    priority: 1
    threads: 1
    resources:
        mem_mb=memory("fft_wisdom"),
        disk_mb=disk("fft_wisdom"),
        runtime=minutes("fft_wisdom"),
    script:
        "../scripts/fft_wisdom.py"
