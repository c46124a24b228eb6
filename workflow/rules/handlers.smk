# Before the run: checks, and an announcement of what it takes. After it: where the results are.
# What fails in between is told by the logger plugin (src/snakemake_logger_plugin_asperity).
from asperity.runtime import preloaded
from asperity.runtime.interrupts import leave_jobs_to_cluster
from asperity.runtime.preflight import claim, require_memory, require_space, require_undamaged
from asperity.runtime.snakemake_internals import jobs_to_run, memory_limit, runs_locally

# Modules with which matplotlib writes PNG and PDF.
BACKENDS = "matplotlib.backends.backend_agg", "matplotlib.backends.backend_pdf"


def modules_of_scripts():
    """Modules that the scripts of all rules import, and those that they load later.

    All of them in every run, so that the memory of a job does not depend on which other jobs run.
    """
    blocks = [ast.parse(script.read_bytes()).body for script in Path("workflow/scripts").glob("*.py")]
    imports = [node for block in blocks for node in import_statements(block)]
    found = {node.module for node in imports if isinstance(node, ast.ImportFrom)}
    figures = {f"asperity.paper.figures.{figure.module}" for figure in FIGURES.values()}
    return sorted(found | figures | {"snakemake.script", *BACKENDS})


def require_maps(jobs):
    """Read the measured maps of these jobs, so that what is wrong with one is said before anything is computed."""
    # Imported here, as it takes time: on a cluster every job reads this file.
    from asperity.pipeline.surface import map_problems

    names = {job.wildcards.surface for job in jobs if job.rule == "surface"}
    found = [
        problem
        for name in sorted(names & set(MEASURED))
        for problem in map_problems(MEASURED[name], lambda setting: f"measured.{name}.{setting}")
    ]
    if found:
        sys.exit("\n".join(f"config: {problem}" for problem in found))


onstart:
    jobs = jobs_to_run(workflow)
    if runs_locally(workflow):
        preloaded.start(modules_of_scripts())
    else:
        leave_jobs_to_cluster()
    require_maps(jobs)
    try:
        claim(RESULTS)
        if runs_locally(workflow):
            limit = memory_limit(workflow)
            require_memory(memory_needs(jobs, limit), limit)
        require_space(RESULTS, sum(job.resources.get("disk_mb", 0) for job in jobs))
        require_undamaged(earlier_results(jobs), RESULTS)
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
