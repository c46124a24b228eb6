# Before the run: a lock of the results, checks, and an announcement of time and memory. After it: the manifest, and the
# folder of the results.
import shutil

from snakemake.logging import logger
from snakemake.settings.types import DeploymentMethod

from asperity.core.errors import PreflightError
from asperity.core.packages import NEEDED, absent, message
from asperity.core.system import compile_in_parallel, is_compiled
from asperity.study.preflight_and_manifest import require_memory, require_space, write_manifest


def require_maps(jobs):
    """Read the measured maps of these jobs, so that their errors are reported before anything is computed."""
    # Imported here, as it takes time: on a cluster every job reads this file.
    from asperity.study.stages.surface import map_problems

    names = {job.wildcards.surface for job in jobs if job.rule.name == "contact"}
    found = [
        problem
        for name in sorted(names)
        for key, entry in maps_of_surface(name)
        for problem in map_problems(key, entry)
    ]
    if found:
        sys.exit("\n".join(f"config: {problem}" for problem in found))


def outputs_of_run():
    """Files of all jobs that lead to the targets of this run."""
    return [file for job in workflow.dag.jobs for file in job.output]


onstart:
    from asperity.study.cost.model import announce

    if workflow.executor_plugin.name == "slurm" and shutil.which("sbatch") is None:
        sys.exit("study: sbatch: no such command; a login node of a SLURM cluster is needed")
    # With --sdm conda the packages are in the environments of the jobs, and the checks that need them are left out.
    if missing := absent([FFT_ENGINE, *NEEDED]):
        if DeploymentMethod.CONDA not in workflow.deployment_settings.deployment_method:
            sys.exit(f"study: {message(missing)}".replace("asperity[", f"{INSTALLED_FROM}["))
    jobs = [job for job in workflow.dag.needrun_jobs() if job.rule.name in SIZES]
    if not missing:
        require_maps(jobs)
    lock(RESULTS)
    costs = {job.output[0]: cost_of(job.rule.name, job.wildcards) for job in jobs}
    try:
        Path(RESULTS).mkdir(parents=True, exist_ok=True)
        if workflow.local_exec:
            require_memory({output: cost.memory / 1e6 for output, cost in costs.items()})
        require_space(RESULTS, sum(cost.disk for cost in costs.values()) / 1e6)
    except (PreflightError, OSError) as error:
        sys.exit(f"study: {error}")
    if jobs and not missing:
        at_once = workflow.cores if workflow.local_exec else workflow.nodes
        logger.info(announce([*costs.values()], at_once))
    is_needed = workflow.local_exec and {"contact", "stress"} & {job.rule.name for job in jobs}
    if is_needed and not missing and not is_compiled():
        compile_in_parallel()


onsuccess:
    write_manifest(Path(RESULTS), outputs_of_run())
    places = {"figures": "figures", "claims": "claims.md", "validation": "validation/table.md"}
    found = [
        f"{name} in {RESULTS}/{path}" for name, path in places.items() if Path(RESULTS, path).exists()
    ]
    logger.info("; ".join(["study: done", *found]))


onerror:
    write_manifest(Path(RESULTS), outputs_of_run())
