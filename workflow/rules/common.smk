import ast
import os
import re
from functools import cache
from pathlib import Path

from snakemake.logging import logger

import asperity
from asperity.runtime.snakemake_internals import jobs_at_once


def library_folder():
    """Folder of the library's packages: relative if it is in the project, as src, else where it is installed."""
    folder, project = Path(asperity.__file__).resolve().parents[1], Path.cwd().resolve()
    return folder.relative_to(project) if folder.is_relative_to(project) else folder


LIBRARY = library_folder()
STYLE = (LIBRARY / "asperity/views/style.mplstyle").as_posix()


@cache
def code(script, *modules):
    """Modules of the library that a script imports, directly or not: inputs whose change reruns the job.

    `modules` are modules that the script imports by names given to it.
    """
    script = f"workflow/scripts/{script}.py"
    found, ahead = set(), [script, *(s for m in modules for s in sources_of(m))]
    while ahead:
        source = ahead.pop()
        if source not in found:
            found.add(source)
            ahead += imported(source)
    return sorted(found - {script})


@cache
def imported(source):
    """Sources of the library's modules that a source imports, and of the packages around them."""
    with open(source, "rb") as file:
        found = [*import_statements(ast.parse(file.read()).body)]
    names = {alias.name for node in found if isinstance(node, ast.Import) for alias in node.names}
    for node in found:
        if isinstance(node, ast.ImportFrom) and node.module:
            names |= {node.module, *(f"{node.module}.{alias.name}" for alias in node.names)}
    return {source for name in names for source in sources_of(name)}


def import_statements(block):
    """Import statements of a block of code and of the blocks inside it; expressions hold none."""
    for node in block:
        if isinstance(node, ast.Import | ast.ImportFrom):
            yield node
        for inside in ("body", "orelse", "finalbody", "handlers", "cases"):
            yield from import_statements(getattr(node, inside, ()))


@cache
def sources_of(module):
    """Source of a module of the library, and those of the packages around it."""
    parts = module.split(".")
    places = [LIBRARY.joinpath(*parts[: end + 1]) for end in range(len(parts))]
    candidates = [source for place in places for source in (place.with_suffix(".py"), place / "__init__.py")]
    return [source.as_posix() for source in candidates if source.exists()]


# Of the jobs that are ready, those of a higher priority start first, and among equal ones those with the larger input:
# the longest chain, from the surface to the stress on the largest grid, starts early, and small jobs fill the time left.
PRIORITIES = {"machine_code": 4, "surface": 3, "contact": 2, "stress": 1, "validation": 1, "tradeoff": 1}


def any_of(names):
    """Pattern of a wildcard that is one of these names; without names one that nothing matches."""
    return "|".join(map(re.escape, names)) or "(?!)"


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
    read = {file for job in jobs for file in job.input if file.startswith(f"{RESULTS}/")}
    return sorted(file for file in read - made if os.path.exists(file))


def announce_run(jobs):
    """Print how many jobs there are, the time and memory they take, and whether the library is compiled."""
    # Imported here, as it takes time: on a cluster every job reads this file.
    from asperity.accuracy.resources import announce

    ahead = [(job.rule, COSTS[job.rule](job.wildcards)) for job in jobs if job.rule in COSTS]
    if ahead:
        logger.info(announce(ahead, jobs_at_once(workflow)))
    compiling = "machine_code" in [job.rule for job in jobs]
    if compiling:
        seconds = COSTS["machine_code"](None).seconds
        logger.info(f"study: compiling the library first, once for all jobs: about {seconds:.0f} s")
