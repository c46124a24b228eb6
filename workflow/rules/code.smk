# Fingerprints of the code of jobs: parameters whose change reruns them.
import hashlib
import re
from functools import cache
from pathlib import Path

import asperity

LIBRARY = Path(asperity.__file__).parent
STYLE = (LIBRARY / "views/style.mplstyle").as_posix()
IMPORT = re.compile(
    r"^ *(?:from (asperity[\w.]*) import (\([^)]*\)|.*)|import (asperity[\w.]*))", re.MULTILINE
)


def code(script, *modules):
    """Fingerprint of the modules of asperity that a script imports, directly or not, and of those named."""
    found, ahead = set(), {*imported(Path("workflow/scripts", f"{script}.py"))}.union(
        *map(sources_of, modules)
    )
    while ahead:
        found |= ahead
        ahead = {source for each in ahead for source in imported(each)} - found
    contents = b"".join(source.read_bytes() for source in sorted(found))
    return hashlib.sha256(contents).hexdigest()[:16]


@cache
def imported(source):
    """Sources of the modules of asperity that a source imports."""
    modules = set()
    for package, names, module in IMPORT.findall(source.read_text(encoding="utf-8")):
        modules |= {module, package, *(f"{package}.{name}" for name in re.findall(r"\w+", names))}
    return {found for module in modules for found in sources_of(module)}


@cache
def sources_of(module):
    """Source of a module of asperity, and those of the packages around it; without one, only the latter."""
    parts = module.split(".")[1:]
    places = [LIBRARY.joinpath(*parts[:end]) for end in range(len(parts) + 1)]
    candidates = [source for place in places for source in (place.with_suffix(".py"), place / "__init__.py")]
    return [source for source in candidates if source.exists()]


def any_of(names):
    """Pattern of a wildcard that is one of these names; without names one that nothing matches."""
    return "|".join(map(re.escape, names)) or "(?!)"
