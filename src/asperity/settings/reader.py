"""Configurations and overlays in files: plain YAML 1.2, of which nothing is executed.

Stricter than a usual YAML reader: no tags that make objects, no key given twice, limits on size, depth and
content, so that a file from someone else does no harm. Plain scalars follow the core schema of YAML 1.2
(https://yaml.org/spec/1.2.2/#103-core-schema): PyYAML follows YAML 1.1, where ``010`` is 8, ``1:20`` is 80,
``no`` is false and ``1e-6`` is text.
"""

import os
import re
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import yaml

from asperity.core.errors import InputError, shown
from asperity.settings.sections import LOAD_LABELS, without_load

_MAX_FILE_SIZE = 2**17
"""Largest size of a file in bytes, which are read in three seconds; the paper's has four thousand."""

_MAX_SCALAR = 2000
"""Largest number of characters of a text or number: long numbers take long to convert."""

_MAX_VALUES = 100_000
"""Largest number of values in a file, each alias counted as its whole content: aliases can be nested."""

_MAX_DEPTH = 32
"""Largest number of nested levels of keys and lists; a configuration has six."""


_SCALARS = {
    "null": r"(~|null|Null|NULL|)\Z",
    "bool": r"(true|True|TRUE|false|False|FALSE)\Z",
    "int": r"[-+]?[0-9]+\Z",
    "float": r"([-+]?(\.[0-9]+|[0-9]+(\.[0-9]*)?)([eE][-+]?[0-9]+)?|[-+]?\.(inf|Inf|INF)|\.(nan|NaN|NAN))\Z",
    "merge": r"<<\Z",
}
"""Tag of a plain scalar → its pattern; any other is text. Merging of keys is kept from YAML 1.1."""


class _Loader(yaml.SafeLoader):
    """Reader of YAML 1.2 that refuses a key given twice."""

    def construct_mapping(self, node: yaml.MappingNode, deep: bool = False) -> dict[Any, Any]:
        known: set[str] = set()
        for key, _ in node.value:
            word = str(key.value)
            if word in known and key.tag != "tag:yaml.org,2002:merge":
                problem = f"{shown(word)} is given twice, again"
                raise yaml.constructor.ConstructorError(None, None, problem, key.start_mark)
            known.add(word)
        return super().construct_mapping(node, deep)


_Loader.yaml_implicit_resolvers = {
    None: [(f"tag:yaml.org,2002:{tag}", re.compile(pattern)) for tag, pattern in _SCALARS.items()]
}
# Decimal, also with a leading zero.
_Loader.add_constructor("tag:yaml.org,2002:int", lambda _, node: int(node.value))


def load(path: str | Path) -> dict[str, Any]:
    """Read a configuration or an overlay from a YAML file.

    Raises
    ------
    InputError
        If the file is missing or too large, or its content is not accepted by `parse`.
    """
    if not os.path.isfile(path):
        raise InputError(str(path), ["no such file"])
    try:
        with open(path, "rb") as file:
            content = file.read(_MAX_FILE_SIZE + 1)
    except OSError as error:
        raise InputError(str(path), [f"cannot be read ({error.strerror})"]) from error
    if len(content) > _MAX_FILE_SIZE:
        raise InputError(str(path), [f"a configuration of at most {_MAX_FILE_SIZE} bytes is needed"])
    return parse(content, str(path))


def parse(content: str | bytes, name: str) -> dict[str, Any]:
    """Read a configuration or an overlay from a YAML text.

    Parameters
    ----------
    content : str or bytes
    name : str
        Name of the text in messages.

    Raises
    ------
    InputError
        If the text is not YAML in UTF-8, is no mapping, gives a key twice, or is too large or too deep.
    """
    try:
        loader = _Loader(content)
        node = loader.get_single_node()
        if not isinstance(node, yaml.MappingNode):
            raise ValueError("keys with values are needed, such as `name: value`")
        _size(node, {}, 0)
        return loader.construct_document(node)
    except yaml.MarkedYAMLError as error:
        where = f" in line {error.problem_mark.line + 1}" if error.problem_mark else ""
        raise InputError(name, [f"YAML is needed; {error.problem or error.context}{where}"]) from error
    except yaml.YAMLError as error:
        raise InputError(name, [f"YAML in UTF-8 is needed; {str(error).splitlines()[0]}"]) from error
    except RecursionError as error:
        raise InputError(name, [f"at most {_MAX_DEPTH} levels are accepted"]) from error
    except (ValueError, AttributeError) as error:  # also of a scalar that its tag does not fit
        raise InputError(name, [str(error).split(";")[0]]) from error


def _size(node: yaml.Node, sizes: dict[int, int], depth: int) -> int:
    """Number of values in a node, each alias counted as its whole content."""
    line = node.start_mark.line + 1
    if depth > _MAX_DEPTH:
        raise ValueError(f"at most {_MAX_DEPTH} levels are accepted, line {line} has more")
    if isinstance(node, yaml.ScalarNode) and len(node.value) > _MAX_SCALAR:
        most = f"at most {_MAX_SCALAR} characters are accepted in a value"
        raise ValueError(f"{most}, line {line} has {len(node.value)}")
    if id(node) not in sizes:
        children: list[yaml.Node] = []
        if isinstance(node, yaml.MappingNode):
            children = [child for pair in node.value for child in pair]
        elif isinstance(node, yaml.SequenceNode):
            children = node.value
        sizes[id(node)] = 1 + sum(_size(child, sizes, depth + 1) for child in children)
    if sizes[id(node)] > _MAX_VALUES:
        raise ValueError(f"at most {_MAX_VALUES} values are accepted, line {line} has more")
    return sizes[id(node)]


def merged(config: Mapping[str, Any], overlay: Mapping[str, Any]) -> dict[str, Any]:
    """Configuration with an overlay on top of it, merged key by key as Snakemake does.

    The load of section ``contact`` replaces the load of the configuration, which may be another setting.
    """
    both = dict(config)
    for key, value in overlay.items():
        below = both.get(key)
        if not isinstance(value, Mapping) or not isinstance(below, Mapping):
            both[key] = value
        elif key == "contact" and value.keys() & LOAD_LABELS.keys():
            both[key] = merged(without_load(below), value)
        else:
            both[key] = merged(below, value)
    return both
