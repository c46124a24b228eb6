"""Stress inside an elastic solid pressed against a rough surface.

The public names are listed in ``__init__.pyi`` and imported when first used.
"""

from importlib.util import find_spec
from typing import Any

from asperity.core.version import __version__ as __version__

# Without lazy_loader the public names are missing; the command line and the study can still report that.
if find_spec("lazy_loader"):
    import lazy_loader

    _attribute, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)

    def __getattr__(name: str) -> Any:
        """Return a public name, or raise an error that says which package to install."""
        try:
            return _attribute(name)
        except ModuleNotFoundError as error:
            from asperity.core.packages import NAMES, MissingPackageError, message

            module = (error.name or "").split(".")[0]
            if module not in NAMES or isinstance(error, MissingPackageError):
                raise
            raise MissingPackageError(message([module]), name=module) from error
