import os
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
