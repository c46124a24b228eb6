"""Case files for a start, with a comment for every key, and the explanation of a key.

``templates.yaml`` has the settings of each. Keys, ranges and texts of the comments come from the settings.
"""

import textwrap
from collections.abc import Iterator, Mapping
from importlib.resources import files
from typing import Any

import yaml

from asperity.core.data import packaged_yaml
from asperity.core.errors import did_you_mean, shown
from asperity.engineering.case import Case
from asperity.engineering.case_file import leaves
from asperity.settings.materials import table
from asperity.settings.model import Entry, accepted, described, inside, item_of, keys_like

PACKAGE = "asperity.engineering"

WIDTH = 100
"""Characters of a line of comment."""

WORDS = {
    "load.radius_x": "ball radius",
    "map.form": "roller cylinder",
    "load.hertz_pressure": "bearing gear hertz",
    "body.layers.0.thickness": "coating layer thickness",
    "body.young": "e modulus",
    "film.lambda_ratio": "film_thickness lambda",
    "map.s_filter": "filter",
    "leak.pressure_difference": "leak leakage",
    "leak.viscosity": "fluid",
    "map.detrend": "level",
    "cycles.fatigue_scatter": "life",
    "load.mean_pressure": "load",
    "sliding.friction": "mu",
    "body.poisson": "nu",
    "map.orientation": "orient",
    "map.physical_size": "pixel size",
    "map.points": "resolution",
    "cycles.shifts": "rolling shakedown",
    "map.file": "roughness",
    "running_in.loads": "run_in wear",
    "map.despike": "spikes",
    "body.yield_stress": "strength",
    "sensitivity.tolerances": "tolerance",
}
"""Key of a setting → other words for it."""

ALSO = {word: key for key, words in WORDS.items() for word in words.split()}


def templates() -> dict[str, Any]:
    """Name of a template → its text and its case."""
    return packaged_yaml(PACKAGE, "templates.yaml")


def template(name: str) -> str:
    """The commented case file of a template, on maps that come with asperity.

    Raises
    ------
    ValueError
        If there is no template of this name.
    """
    known = templates()
    if name not in known:
        near = did_you_mean(name, known)
        raise ValueError(f"{shown(name)}: one of {', '.join(known)} is needed{near}")
    case, entry = known[name]["case"], described(Case)
    folder = files(PACKAGE) / "maps"
    file = case["map"]["file"]
    named = [str(folder / each) for each in file] if isinstance(file, list) else str(folder / file)
    case["map"]["file"] = named
    lines = [f"# {known[name]['text']}"]
    lines += ["# To run it: asperity run case.yaml. A question whose group is not here is left out."]
    for group in (group for group in entry["properties"] if group in case):
        lines += ["", *_lines(group, entry["properties"][group], case[group], "")]
    return "\n".join(lines) + "\n"


def _lines(name: str, entry: Entry, value: Any, indent: str) -> Iterator[str]:
    """Lines of a setting or group: a comment, and the value; keys without a value are commented out."""
    groups, known = value if isinstance(value, list) else [value], item_of(entry).get("properties")
    if not known or not all(isinstance(group, Mapping) for group in groups):
        yield from _comment(_in_words(entry), indent)
        yield f"{indent}{name}: {yaml_line(value)}"
        return
    yield from _comment(entry["description"], indent)
    yield f"{indent}{name}:{'' if value else ' {}'}"
    deeper = f"{indent}  "
    for group in groups:
        if isinstance(value, list):
            yield f"{indent}  -"
            deeper = f"{indent}    "
        for key in group:
            yield from _lines(key, known[key], group[key], deeper)
        for key, each in known.items():
            if key not in group and "properties" not in each:
                yield from _comment(_in_words(each), deeper)
                yield f"{deeper}# {key}: {yaml_line(each.get('example', each.get('default')))}"


def _comment(text: str, indent: str) -> Iterator[str]:
    yield from (f"{indent}# {line}" for line in textwrap.wrap(text, WIDTH - len(indent)))


def _in_words(entry: Entry) -> str:
    """Description of a setting, its accepted values, unit and default."""
    facts = [accepted(entry)]
    facts += [f"unit: {entry['unit']}"] if "unit" in entry else []
    default = entry.get("default_text") or (yaml_line(entry["default"]) if "default" in entry else "")
    facts += [f"default: {default}"] if default else []
    return f"{entry['description'].rstrip('.')} ({'; '.join(facts)})."


def yaml_line(value: Any) -> str:
    """A value in one line of YAML."""
    if value is None:
        return ""
    text = yaml.safe_dump(value, default_flow_style=True, sort_keys=False, allow_unicode=True, width=10_000)
    return text.removesuffix("\n").removesuffix("\n...")


def explanation(key: str) -> str:
    """Text about a setting or a group of a case: its meaning, accepted values, and default.

    Raises
    ------
    ValueError
        If there is no such key.
    """
    entry: Entry = described(Case)
    path: list[str] = []
    for part in key.split("."):
        if (below := inside(entry, part)) is None:
            known = entry.get("properties", {})
            near = did_you_mean(part, known) or f"; known here are {', '.join(known) or 'no keys'}"
            raise ValueError(f"{'.'.join([*path, part])}: unknown key{near}")
        entry, path = below, [*path, part]
    if "properties" not in entry:
        example = f"\nExample: {yaml_line({path[-1]: entry['example']})[1:-1]}" if "example" in entry else ""
        return f"{key}: {_in_words(entry)}{example}"
    width = max(map(len, entry["properties"]), default=0)
    lines = [f"  {name:<{width}}  {each['description']}" for name, each in entry["properties"].items()]
    return "\n".join([f"{key}: {entry['description']}", *lines])


def hint(word: str) -> tuple[str, str]:
    """The key of a case that a word means, such as an unknown flag, and how it is given; empty without one.

    Examples
    --------
    >>> from asperity.engineering.templates import hint
    >>> hint("--lambda")
    ('film.lambda_ratio', ', given by --set or in a case file (asperity case film)')
    """
    word = word.lstrip("-").lower().replace("-", "_")
    known = [ALSO[word]] if word in ALSO else []
    if not known and len(word) > 2:
        known = keys_like(word, described(Case))
    if named := [key for key in known if word in key.split(".")]:
        known = named
    for name, each in templates().items():
        key = next((key for key, _ in leaves(each["case"]) if key in known), "")
        if key or (known and name == word):
            return key or known[0], f", given by --set or in a case file (asperity case {name})"
    return (known[0], ", given by --set or in a case file") if known else ("", "")


def materials_in_words() -> str:
    """The materials of the table: names, state, and constants with their sources."""
    lines = []
    for material in table().values():
        also = f" ({', '.join(material.also)})" if material.also else ""
        lines += [f"{material.name}{also}: {material.group}{', ' * bool(material.state)}{material.state}"]
        for name, constant in material.constants.items():
            span = f", {constant.range[0]} to {constant.range[1]}" if constant.range else ""
            lines.append(f"  {name:<15} {constant.value}{span}  [{constant.source}]")
    return "\n".join(lines)
