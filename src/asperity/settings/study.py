"""The configuration of one study: its files merged, checked and completed, and its folder of results.

A study computes only the results that its files ask for. A file with ``based_on: config/config.yaml``, or
with the name of another study, is a variant of that study: the settings of the base hold where the file gives
none.
"""

import os
import re
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from asperity.core.errors import InputError, shown
from asperity.core.packages import absent, message
from asperity.settings.check import check
from asperity.settings.configuration import Configuration
from asperity.settings.model import Problem, SettingsError, accepted, entry_of
from asperity.settings.reader import load, merged
from asperity.settings.sections import LOAD_LABELS, maps_of

PAPER = "config/config.yaml"
"""Configuration of the paper, relative to the folder of the project."""

ALL_SURFACES = "all"
"""Name of the study of all surfaces, if a configuration names no study."""

_ANY_FOLDER = re.compile(r"[^{}\x00-\x1f\x7f]{1,1000}\Z")
"""Names of folders that Snakemake takes as they are; it takes braces for wildcards."""


def read_study(files: Sequence[str | Path], given: Mapping[str, Any] | None = None) -> dict[str, Any]:
    """Configuration of a study, complete and checked.

    Parameters
    ----------
    files : sequence of paths
        Configuration, then overlays; without any, the configuration of the paper.
    given : mapping, optional
        Settings given on the command line, which override the files. Their ``results`` may be any folder, as
        the user has typed it. The folder that a file names, which may be from someone else, lies in the
        project.

    Raises
    ------
    InputError
        If a file cannot be read, or settings are not accepted; it has a line for each of them.
    """
    given = dict(given or {})
    files = list(files) or [PAPER]
    layers = [load(path) for path in files]
    config: dict[str, Any] = {}
    for layer in (*layers, {key: value for key, value in given.items() if key != "results"}):
        config = merged(config, layer)
    config = with_loads(with_base(config))
    config.pop("results", None)
    if "results" in layers[-1]:  # the files beneath name folders of other studies
        config["results"] = layers[-1]["results"]
    config = check(config)
    config.setdefault("results", f"results/{Path(files[-1]).stem}")
    if "studies" not in config:
        config["studies"] = {ALL_SURFACES: [*config["surfaces"], *config["measured"]]}
    config["results"] = given.get("results", config["results"])
    if found := [*_problems(config, files[-1], "results" in given)]:
        raise SettingsError("", found)
    if "results" in given:  # with slashes as in a Snakefile, also on Windows
        config["results"] = Path(os.path.normpath(os.path.expanduser(config["results"]))).as_posix()
    return config


def _problems(config: Mapping[str, Any], path: str | Path, is_given: bool) -> Iterator[tuple[str, str]]:
    """Key and rest of the message for everything that a complete configuration lacks on this machine.

    `path` is the last of its files. With `is_given` the command line names the folder of results.
    """
    results, names = config["results"], config["studies"].get(ALL_SURFACES, ())
    if is_given:
        if not isinstance(results, str) or not _ANY_FOLDER.match(results):
            needed = "a folder is needed, without braces, of at most 1000 characters"
            yield "results", f" = {shown(results)}: {needed}"
    elif not re.match(entry_of(Configuration, "results")["pattern"], results):
        cannot = f"{shown(Path(path).name)} cannot name the folder"
        yield "results", f": missing; {cannot}, one such as results/mine is needed"
    elif results == "results" and os.path.realpath(path) != os.path.realpath(PAPER):
        needed = f"{path} needs a folder below it, such as results/mine"
        yield "results", f" = 'results': {needed}; this one holds the results of the paper"
    # Without NumPy the study is only planned here; its jobs run in another environment.
    if (missing := absent([config["fft_engine"]])) and not absent(["numpy"]):
        yield "fft_engine", f" = {shown(config['fft_engine'])}: {message(missing)}"
    if len(names) > (most := _most_surfaces(ALL_SURFACES)):
        needed = f"studies of at most {most} of them are needed, such as {{first: [{', '.join(names[:2])}]}}"
        yield "studies", f": missing; with {len(names)} surfaces, {needed}"
    for key, entry in maps_of(config).items():
        if not os.path.isfile(entry["file"]):
            yield f"{key}.file", f" = {shown(entry['file'])}: no such file"


def with_base(config: Mapping[str, Any], above: Sequence[str] = ()) -> dict[str, Any]:
    """A configuration merged onto the file that ``based_on`` names, and onto the files on which that is
    based.

    Parameters
    ----------
    config : mapping
    above : sequence of str
        Files whose ``based_on`` has led to this configuration.

    Raises
    ------
    InputError
        If ``based_on`` names no configuration, or one of the files `above`.
    """
    config = dict(config)
    if (base := config.pop("based_on", None)) is None:
        return config
    if not isinstance(base, str):
        needed = accepted(entry_of(Configuration, "based_on"))
        raise InputError("", [f"based_on = {shown(base)}: {needed} is needed"])
    if base in above:
        raise InputError("", [f"based_on = {shown(base)}: a file that is not based on itself is needed"])
    try:
        beneath = load(base)
    except InputError as error:
        raise InputError(f"based_on = {shown(base)}", error.lines) from error
    return merged(with_base(beneath, (*above, base)), config)


def with_loads(config: Mapping[str, Any]) -> dict[str, Any]:
    """A configuration in which every surface has a copy for each load, if section ``contact`` lists loads.

    A surface with a load of its own stays as it is.

    Raises
    ------
    SettingsError
        If a load is not accepted, or a study has more copies than figures can show.
    """
    contact = config.get("contact")
    contact = contact if isinstance(contact, Mapping) else {}
    kinds = [kind for kind in LOAD_LABELS if isinstance(contact.get(kind), list)]
    if not kinds or not contact[kinds[0]]:
        return dict(config)
    kind, values = kinds[0], contact[kinds[0]]
    found: dict[Problem, None] = {}
    for value in values:
        try:
            check({**config, "contact": {**contact, kind: value}})
        except SettingsError as error:
            found |= dict.fromkeys(error.found)
    if found:
        raise SettingsError("", found)
    config = {**config, "contact": {**contact, kind: values[0]}}
    if kind == "contact_area_fraction":
        config["contact"].setdefault("path_contact_area_fractions", sorted({*values}))
    copies: dict[str, list[str]] = {}
    for section in ("surfaces", "measured"):
        config[section], listed = {}, config.get(section, {})
        for name, surface in listed.items():
            made = {name: surface}
            if "contact" not in surface:
                made = {
                    f"{name}_load{number}": {
                        **surface,
                        "label": f"{surface['label']}, {LOAD_LABELS[kind]}{value:g}",
                        "contact": {kind: value},
                    }
                    for number, value in enumerate(values, start=1)
                }
            config[section] |= made
            copies[name] = [*made]
    config["studies"] = {
        study: [copy for name in names for copy in copies[name]]
        for study, names in config.get("studies", {ALL_SURFACES: [*copies]}).items()
    }
    for study, names in config["studies"].items():
        if len(names) > (most := _most_surfaces(study)):
            needed = f"at most {most} are accepted; fewer loads or surfaces are needed"
            text = f" = {shown(values)}: study {study} would have {len(names)} surfaces, {needed}"
            raise SettingsError("", [(f"contact.{kind}", text)])
    return config


def _most_surfaces(study: str) -> int:
    studies = entry_of(Configuration, "studies")
    return studies["properties"].get(study, studies["additionalProperties"])["maxItems"]
