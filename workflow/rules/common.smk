import os
import re
from functools import cache
from modulefinder import ModuleFinder


@cache
def code(script, *modules):
    """Sources of the library that a script imports, directly or not: a change of one reruns it.

    `modules` are those the script imports by a name that it is given.
    """
    finder = ModuleFinder(path=["src"])
    finder.run_script(f"workflow/scripts/{script}.py")
    for module in modules:
        finder.import_hook(module)
    return sorted(os.path.relpath(module.__file__) for module in finder.modules.values() if module.__file__)


def contact_settings(wildcards):
    """Section contact, without the load-area curve where no figure shows it."""
    studies = config["studies"]
    if wildcards.surface in {*studies["hurst"], *studies["measured"]}:
        return config["contact"]
    return {**config["contact"], "path_area_fractions": []}


def earlier_results(jobs):
    """Result files of earlier runs that these jobs read."""
    made = {file for job in jobs for file in job.output}
    read = {file for job in jobs for file in job.input if file.endswith((".nc", ".json"))}
    return sorted(file for file in read - made if os.path.exists(file))


def needs(jobs, resource):
    """What the jobs declare that they need of a resource, by the first file that each makes."""
    return {job.output[0]: job.resources.get(resource, 0) for job in jobs if job.output}


def last_words(job):
    """What ended a job, in one line: the error in its log, without the names of this project's own."""
    for log in filter(os.path.exists, job.log):
        with open(log, encoding="utf-8", errors="replace") as file:
            errors = re.findall(r"^([\w.]*Error): (.+)$", file.read(), re.MULTILINE)
        if errors:
            name, message = errors[-1]
            told = message if name.startswith("asperity.") else f"{job.output[0]}: {message} ({name})"
            return f"{told} [{log}]"
    return f"{job.output[0]}: its job was stopped; the memory or the disk may have run out"


def announce_run(jobs):
    """Say before the run what it will take."""
    from asperity.plan import announce  # not in the process of every job

    ahead = [(job.rule.name, NEEDS[job.rule.name](job.wildcards)) for job in jobs if job.rule.name in NEEDS]
    if ahead:
        at_once = workflow.cores if workflow.local_exec else workflow.nodes
        print(announce(ahead, at_once), file=sys.stderr, flush=True)
