"""The elastic solid: a layer or a half-space, its compliance, stress and displacement per pressure mode."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
