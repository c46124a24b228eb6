# The workflow is workflow/Snakefile. Snakemake takes the default target from the file that it finds first: this one.
include: "workflow/Snakefile"


rule study:
    default_target: True
    input:
        rules.all.input,
