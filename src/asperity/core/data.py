"""YAML files of the package."""

from importlib.resources import files
from typing import Any


def packaged_yaml(package: str, name: str) -> Any:
    """Content of a YAML file beside the modules of a package, read by the fast reader where there is one."""
    import yaml  # without it, the caller says which package is missing

    text = (files(package) / name).read_text(encoding="utf-8")
    return yaml.load(text, Loader=getattr(yaml, "CSafeLoader", yaml.SafeLoader))
