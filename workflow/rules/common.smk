import ast
import os
import re
from functools import cache
from pathlib import Path


@cache
def imported(source):
    """Sources of the library that one names in its imports, with the packages they lie in."""
    with open(source, "rb") as file:
        found = [
            node for node in ast.walk(ast.parse(file.read())) if isinstance(node, ast.Import | ast.ImportFrom)
        ]
    names = {alias.name for node in found if isinstance(node, ast.Import) for alias in node.names}
    for node in found:
        if isinstance(node, ast.ImportFrom) and node.module:
            names |= {node.module, *(f"{node.module}.{alias.name}" for alias in node.names)}
    return {source for name in names for source in sources_of(name)}


@cache
def sources_of(module):
    """Source of a module of the library, and those of the packages around it."""
    parts = module.split(".")
    places = [Path("src").joinpath(*parts[: end + 1]) for end in range(len(parts))]
    candidates = [source for place in places for source in (place.with_suffix(".py"), place / "__init__.py")]
    return [str(source) for source in candidates if source.exists()]


@cache
def code(script, *modules):
    """Sources of the library that a script imports, directly or not: a change of one reruns it.

    `modules` are those the script imports by a name that it is given.
    """
    found, ahead = set(), [f"workflow/scripts/{script}.py", *(s for m in modules for s in sources_of(m))]
    while ahead:
        source = ahead.pop()
        if source not in found:
            found.add(source)
            ahead += imported(source)
    return sorted(source for source in found if source.startswith("src/"))


def contact_settings(wildcards):
    """Section contact, without the load-area curve where no figure shows it."""
    studies = config["studies"]
    if wildcards.surface in {*studies["hurst"], *studies["measured"]}:
        return config["contact"]
    return {**config["contact"], "path_area_fractions": []}


def earlier_results(jobs):
    """Result files of earlier runs that these jobs read."""
    made = {file for job in jobs for file in job.output}
    read = {file for job in jobs for file in job.input if file.endswith(".nc")}
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
    from asperity.accuracy.resources import announce  # not in the process of every job

    ahead = [(job.rule.name, COSTS[job.rule.name](job.wildcards)) for job in jobs if job.rule.name in COSTS]
    if ahead:
        at_once = workflow.cores if workflow.local_exec else workflow.nodes
        print(announce(ahead, at_once), file=sys.stderr, flush=True)
