"""Accuracy and cost.

`model` is the cost of a job (memory, time, files), which Snakemake is given; `plan` finds the cheapest
settings for an error; `benchmark` fits ``jobs.csv``, the coefficients of the model, to a finished study.
"""
