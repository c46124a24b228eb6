"""Stress inside an elastic solid pressed against a rough surface.

The public names are listed in ``__init__.pyi`` and imported when first used.
"""

from importlib.util import find_spec
from typing import Any

__version__ = "0.2.0"

# Without lazy_loader there are no public names; the command line and the study can still report that.
if find_spec("lazy_loader"):
    import lazy_loader

    _attribute, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)

    def __getattr__(name: str) -> Any:
        """A public name; without the packages that it needs, an error that names what to install."""
        try:
            return _attribute(name)
        except ModuleNotFoundError as error:
            from asperity.packages import NAMES, MissingPackageError, message

            module = (error.name or "").split(".")[0]
            if module not in NAMES or isinstance(error, MissingPackageError):
                raise
            raise MissingPackageError(message([module]), name=module) from error
