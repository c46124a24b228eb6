"""YAML files of the package."""

from importlib.resources import files
from typing import Any


def packaged_yaml(package: str, name: str) -> Any:
    """Content of a YAML file beside the modules of a package, parsed by libyaml where it is available."""
    import yaml  # the caller reports it if it is missing

    text = (files(package) / name).read_text(encoding="utf-8")
    return yaml.load(text, Loader=getattr(yaml, "CSafeLoader", yaml.SafeLoader))
