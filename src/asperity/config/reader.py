"""Configurations and overlays as files: plain YAML, read without running anything that is in them."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import yaml

from asperity.errors import ConfigError, shown

_LARGEST_FILE = 2**20
_LARGEST_CONTENT = 100_000
_DEEPEST = 32


class _Loader(yaml.SafeLoader):
    """YAML without tags of its own, with every key of a mapping given once."""

    def construct_mapping(self, node: yaml.MappingNode, deep: bool = False) -> dict[Any, Any]:
        keys = [key.value for key, _ in node.value if key.tag != "tag:yaml.org,2002:merge"]
        twice = next((str(key) for number, key in enumerate(keys) if key in keys[:number]), None)
        if twice is not None:
            raise yaml.constructor.ConstructorError(
                None, None, f"{shown(twice)} is given twice", node.start_mark
            )
        return super().construct_mapping(node, deep)


def load(path: str | Path) -> dict[str, Any]:
    """The configuration or overlay in the YAML file `path`.

    Raises
    ------
    ConfigError
        If the file is no such thing: missing, too large, not text, not YAML, or with a key given twice.
    """
    if not Path(path).is_file():
        raise ConfigError(f"{path}: no such file")
    if Path(path).stat().st_size > _LARGEST_FILE:
        raise ConfigError(f"{path}: a configuration of at most {_LARGEST_FILE} bytes is needed")
    try:
        content = Path(path).read_bytes()
    except OSError as error:
        raise ConfigError(f"{path}: {error}") from error
    return parse(content, str(path))


def parse(content: str | bytes, name: str) -> dict[str, Any]:
    """The configuration or overlay in a YAML text, which messages call `name`.

    Raises
    ------
    ConfigError
        If the text is no such thing: not YAML, with a key given twice, or beyond all measure.
    """
    try:
        loader = _Loader(content)
        node = loader.get_single_node()
        if not isinstance(node, yaml.MappingNode):
            raise ValueError("keys with values are needed, such as `contact: {area_fraction: 0.05}`")
        _size(node, {}, 0)
        return loader.construct_document(node)
    except yaml.MarkedYAMLError as error:
        where = f" in line {error.problem_mark.line + 1}" if error.problem_mark else ""
        raise ConfigError(f"{name}: YAML is needed; {error.problem or error.context}{where}") from error
    except yaml.YAMLError as error:
        raise ConfigError(f"{name}: YAML in UTF-8 is needed; {str(error).splitlines()[0]}") from error
    except (ValueError, RecursionError) as error:
        raise ConfigError(f"{name}: {str(error).split(';')[0]}") from error


def _size(node: yaml.Node, sizes: dict[int, int], depth: int) -> int:
    """Number of values below a node, each alias counted as what it stands for."""
    if depth > _DEEPEST:
        raise ValueError(f"at most {_DEEPEST} levels are accepted, line {node.start_mark.line + 1} has more")
    if id(node) not in sizes:
        children: list[yaml.Node] = []
        if isinstance(node, yaml.MappingNode):
            children = [child for pair in node.value for child in pair]
        elif isinstance(node, yaml.SequenceNode):
            children = node.value
        sizes[id(node)] = 1 + sum(_size(child, sizes, depth + 1) for child in children)
    if sizes[id(node)] > _LARGEST_CONTENT:
        raise ValueError(
            f"at most {_LARGEST_CONTENT} values are accepted, line {node.start_mark.line + 1} has more"
        )
    return sizes[id(node)]


def merged(config: Mapping[str, Any], overlay: Mapping[str, Any]) -> dict[str, Any]:
    """A configuration with an overlay on it, as Snakemake lays it."""
    both = dict(config)
    for key, value in overlay.items():
        below = both.get(key)
        if isinstance(value, Mapping) and isinstance(below, Mapping):
            both[key] = merged(below, value)
        else:
            both[key] = value
    return both
