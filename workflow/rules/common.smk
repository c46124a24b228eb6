import ast
import os
import re
from functools import cache
from pathlib import Path

import asperity


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
    places = [LIBRARY.joinpath(*parts[: end + 1]) for end in range(len(parts))]
    candidates = [source for place in places for source in (place.with_suffix(".py"), place / "__init__.py")]
    return [source.as_posix() for source in candidates if source.exists()]


def any_of(names):
    """Pattern of a wildcard that is one of these names; without names one that nothing matches."""
    return "|".join(map(re.escape, names)) or "(?!)"
