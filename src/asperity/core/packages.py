"""Packages that the library and the study need, and the extra of ``pip install`` that brings each.

This module imports nothing that may be missing.
"""

from collections.abc import Iterable
from importlib.util import find_spec

BASE = ""
"""Key of the packages that ``pip install asperity`` installs without an extra."""

ENGINES = ("ducc0", "pyfftw", "scipy")
"""Engines of the Fourier transforms, by the names of their modules; the first is the default."""

_MODULES = {
    BASE: "ducc0 jinja2 lazy_loader netCDF4 numba llvmlite numpy pandas pint psutil pydantic scipy "
    "tqdm xarray xlsxwriter yaml",
    "plot": "matplotlib",
    "maps": "SurfaceTopography h5py olefile tifffile",
    "study": "docutils mpmath pygments skfem snakemake",
}
"""Extra → modules that are imported."""

_OTHER_NAMES = {"lazy_loader": "lazy-loader", "skfem": "scikit-fem", "yaml": "pyyaml"}
"""Module → package that provides it, if that has another name."""

PACKAGES = {
    extra: {module: _OTHER_NAMES.get(module, module) for module in modules.split()}
    for extra, modules in _MODULES.items()
}
"""Extra → module that is imported → package that provides it. Each extra includes all before it."""

ALTERNATIVES = {
    "fftw": {"pyfftw": "pyfftw"},
    "flow": {"pyamg": "pyamg"},
    "app": {"bokeh": "bokeh"},
}
"""Extras outside that order, in the same form; each is needed only for the option that names it."""

NAMES = {
    module: name for names in (*PACKAGES.values(), *ALTERNATIVES.values()) for module, name in names.items()
}
"""Module → package that provides it."""

NEEDED = tuple(module for modules in PACKAGES.values() for module in modules if module != ENGINES[0])
"""All modules except `ALTERNATIVES` and the default engine, which is checked when it is chosen."""


class MissingPackageError(ModuleNotFoundError):
    """Raised if a package is not installed; the message names it and the extra to install."""


def absent(modules: Iterable[str] = NEEDED) -> list[str]:
    """Modules that are not installed, by default of `NEEDED`."""
    return [module for module in modules if find_spec(module) is None]


def require(modules: Iterable[str] = NEEDED) -> None:
    """Raise `MissingPackageError` if one of the modules is not installed."""
    if missing := absent(modules):
        raise MissingPackageError(message(missing), name=missing[0])


def install_command(missing: Iterable[str]) -> str:
    """Command that installs the packages of missing modules."""
    missing = set(missing)
    held = [extra for extra, modules in PACKAGES.items() if missing & modules.keys()][-1:]
    alone = [extra for extra, modules in ALTERNATIVES.items() if missing & modules.keys()]
    extras = ",".join(filter(None, [*held, *alone]))
    return f'pip install "asperity[{extras}]"' if extras else "pip install asperity"


def message(missing: Iterable[str]) -> str:
    """One line that names the packages of missing modules, and the command that installs them."""
    missing = list(missing)
    names = ", ".join(NAMES[module] for module in missing)
    return f"not installed: {names}; install with: {install_command(missing)}"
