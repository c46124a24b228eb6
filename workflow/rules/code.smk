# Hash of the code that jobs run, which is a parameter of their rules. Another hash reruns the jobs.
import ast
import hashlib
import re
from functools import cache
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

import asperity
from asperity.core.packages import NAMES

LIBRARY = Path(asperity.__file__).parent
SCRIPTS = Path(workflow.current_basedir.get_path_or_uri(secret_free=True)).parent / "scripts"
# Files that modules read, found by their names in the modules.
DATA = [path for path in LIBRARY.rglob("*") if path.suffix in (".csv", ".j2", ".mplstyle", ".yaml")]
# Packages whose version may change a number.
WATCHED = ("numpy", "scipy", "numba", "SurfaceTopography", "mpmath", "skfem")


def imported(statements):
    """Names of modules that statements import, also inside functions; not those imported for types only."""
    for node in statements:
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            yield from (f"{node.module}.{alias.name}" for alias in node.names)
        elif not (isinstance(node, ast.If) and getattr(node.test, "id", "") == "TYPE_CHECKING"):
            for inner in ("body", "orelse", "handlers", "finalbody"):
                yield from imported(getattr(node, inner, ()))


@cache
def used_by(path):
    """Files of the library, and watched packages, that a file of code imports or names."""
    if path.suffix != ".py":
        return set()
    text = path.read_text(encoding="utf-8")
    words = set(re.findall(r'"([\w.]+)', text))
    named = [file for file in DATA if file.name in words]
    beside = {file.name for file in named if file.parent == path.parent}
    # Of files of one name in several folders, a module reads the one beside it.
    found = {file for file in named if file.parent == path.parent or file.name not in beside}
    found |= {name for name in WATCHED if any(word.startswith(f"{name}.") for word in words)}
    for name in imported(ast.parse(text).body):
        package, *parts = name.split(".")
        if package in WATCHED:
            found.add(package)
        elif package == "asperity":
            places = [LIBRARY.joinpath(*parts[: depth + 1]) for depth in range(len(parts))]
            files = [each for place in places for each in (place / "__init__.py", place.with_suffix(".py"))]
            found.update(file for file in files if file.is_file())
    return found


def files_of(script, *modules):
    """All files and watched packages that a script of the workflow uses, with modules imported by their names."""
    used, new = set(), {SCRIPTS / script, *(LIBRARY / module for module in modules)}
    while new:
        used |= new
        new = {each for path in new if isinstance(path, Path) for each in used_by(path)} - used
    return used


@cache
def code_of(script, *modules):
    """Hash of what a script of the workflow uses."""
    used = files_of(script, *modules)
    packages = {NAMES.get(each, each) for each in used if isinstance(each, str)}
    if LIBRARY / "fourier/engine.py" in used:
        packages.add(config["fft_engine"])
    if LIBRARY / "views/style.py" in used:
        packages.add("matplotlib")
    digest = hashlib.sha256()
    # By names below the two folders: where they are, and which stands first, does not reach the hash.
    files = {
        file.relative_to(SCRIPTS.parent if file.parent == SCRIPTS else LIBRARY).as_posix(): file
        for file in used
        if isinstance(file, Path)
    }
    for name, file in sorted(files.items()):
        digest.update(f"{name} {hashlib.sha256(file.read_bytes()).hexdigest()}\n".encode())
    for name in sorted(packages):
        try:
            digest.update(f"{name} {version(name)}".encode())
        except PackageNotFoundError:  # not installed where the workflow is only planned
            pass
    return digest.hexdigest()[:16]


def modules_of(figure):
    """Modules that draw a figure, which are imported by their names."""
    return [f"paper/figures/{module}.py" for module in ("cases", figure.drawing.split(".")[0])]


def any_of(names):
    """Pattern of a wildcard that matches these names; without names it matches nothing."""
    return "|".join(map(re.escape, names)) or "(?!)"
