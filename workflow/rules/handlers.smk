# Before the run: checks, and an announcement of what it takes. After it: where the results are.
# What fails in between is told by the logger plugin (src/snakemake_logger_plugin_asperity).
from snakemake.logging import logger

from asperity.runtime.preflight import claim, require_memory, require_space, require_undamaged
from asperity.runtime.snakemake_internals import jobs_at_once, jobs_to_run, memory_limit, runs_locally


def memory_needs(jobs, limit):
    """First file that each job makes → memory in MB that the job needs.

    Snakemake reduces what a job declares to the limit: then the rule is asked again.
    """
    needs = {job.output[0]: job.resources.get("mem_mb", 0) for job in jobs if job.output}
    return needs | {
        job.output[0]: COSTS[job.rule](job.wildcards).memory / 1e6
        for job in jobs
        if job.rule in COSTS and limit is not None and needs[job.output[0]] >= limit
    }


def earlier_results(jobs):
    """Result files of earlier runs that these jobs read."""
    made = {file for job in jobs for file in job.output}
    read = {file for job in jobs for file in job.input if file.endswith(".nc")}
    return sorted(file for file in read - made if os.path.exists(file))


def announce_run(jobs):
    """Print how many jobs there are, and the time and memory that they take."""
    # Imported here, as it takes time: on a cluster every job reads this file.
    from asperity.accuracy.resources import announce

    ahead = [(job.rule, COSTS[job.rule](job.wildcards)) for job in jobs if job.rule in COSTS]
    if ahead:
        logger.info(announce(ahead, jobs_at_once(workflow)))


onstart:
    jobs = jobs_to_run(workflow)
    try:
        CLAIM = claim(RESULTS)
        if runs_locally(workflow):
            limit = memory_limit(workflow)
            require_memory(memory_needs(jobs, limit), limit)
        require_space(RESULTS, sum(job.resources.get("disk_mb", 0) for job in jobs))
        require_undamaged(earlier_results(jobs))
    except PreflightError as error:
        sys.exit(f"study: {error}")
    announce_run(jobs)


onsuccess:
    places = {
        "figures": f"{RESULTS}/figures",
        "claims": f"{RESULTS}/claims.md",
        "validation": f"{RESULTS}/validation/table.md",
        "ensemble": f"{RESULTS}/ensemble/table.md",
    }
    found = [f"{name} in {path}" for name, path in places.items() if os.path.exists(path)]
    logger.info("; ".join(["study: done", *found]))
