"""Stress inside an elastic solid pressed against a rough surface.

The public names are listed in ``__init__.pyi`` and imported when first used.
"""

from importlib.util import find_spec

__version__ = "0.2.0"

# Without lazy_loader there are no public names; the command line and the study can still report that.
if find_spec("lazy_loader"):
    import lazy_loader

    __getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
