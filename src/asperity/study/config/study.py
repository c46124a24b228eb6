"""The configuration of one study: its files merged, checked and completed, and its folder of results.

Only what the files of a study ask for is computed. A file with ``based_on: config/config.yaml``, or with
the name of another study, is a variant of that study: the settings of the base hold where the file gives
none.
"""

import os
import re
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from asperity.core.errors import ConfigError, shown
from asperity.core.packages import absent, message
from asperity.study.config.check import check, check_files
from asperity.study.config.reader import load, merged
from asperity.study.config.schema import LOAD_LABELS, schema, setting

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
        Settings given on the command line, which override the files. Their ``results`` may be any folder: the
        user has typed it. That of a file, which may be from someone else, lies in the project.

    Raises
    ------
    ConfigError
        If a file cannot be read, or a setting is not accepted.
    """
    given = dict(given or {})
    files = list(files) or [PAPER]
    layers = [load(path) for path in files]
    config: dict[str, Any] = {}
    for layer in (*layers, {key: value for key, value in given.items() if key != "results"}):
        config = merged(config, layer)
    config = with_loads(with_base(config))
    config.pop("results", None)
    if "results" in layers[-1]:  # those of the files beneath are the folders of other studies
        config["results"] = layers[-1]["results"]
    elif "results" not in given:
        config["results"] = f"results/{Path(files[-1]).stem}"
        if not re.match(setting("results")["pattern"], config["results"]):
            raise ConfigError(
                f"results: missing; {shown(Path(files[-1]).name)} cannot name the folder, "
                f"one such as results/mine is needed"
            )
    config = check(config)
    # Without NumPy the study is only planned here; its jobs run in another environment.
    if (missing := absent([config["fft_engine"]])) and not absent(["numpy"]):
        raise ConfigError(f"fft_engine = {shown(config['fft_engine'])}: {message(missing)}")
    if "results" in given:
        folder = given["results"]
        if not isinstance(folder, str) or not _ANY_FOLDER.match(folder):
            raise ConfigError(
                f"results = {shown(folder)}: a folder is needed, without braces, of at most 1000 characters"
            )
        # With slashes as in a Snakefile, also on Windows.
        config["results"] = Path(os.path.normpath(os.path.expanduser(folder))).as_posix()
    elif config["results"] == "results" and os.path.realpath(files[-1]) != os.path.realpath(PAPER):
        raise ConfigError(
            f"results = 'results': {files[-1]} needs a folder below it, such as results/mine; "
            f"this one holds the results of the paper"
        )
    if "studies" not in config:
        names = [*config.get("surfaces", {}), *config.get("measured", {})]
        if len(names) > (most := _most_surfaces(ALL_SURFACES)):
            raise ConfigError(
                f"studies: missing; with {len(names)} surfaces, studies of at most {most} of them are "
                f"needed, such as {{first: [{', '.join(names[:2])}]}}"
            )
        config["studies"] = {ALL_SURFACES: names}
    check_files(config)
    return config


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
    ConfigError
        If ``based_on`` names no configuration, or one of the files `above`.
    """
    config = dict(config)
    if (base := config.pop("based_on", None)) is None:
        return config
    if not isinstance(base, str):
        raise ConfigError(f"based_on = {shown(base)}: {setting('based_on')['accepts']} is needed")
    if base in above:
        raise ConfigError(f"based_on = {shown(base)}: a file that is not based on itself is needed")
    try:
        beneath = load(base)
    except ConfigError as error:
        raise ConfigError(f"based_on = {shown(base)}: {error}") from error
    return merged(with_base(beneath, (*above, base)), config)


def with_loads(config: Mapping[str, Any]) -> dict[str, Any]:
    """A configuration in which every surface has a copy for each load, if section ``contact`` lists loads.

    A surface with a load of its own stays as it is.

    Raises
    ------
    ConfigError
        If a load is not accepted, or a study has more copies than figures can show.
    """
    contact = config.get("contact")
    contact = contact if isinstance(contact, Mapping) else {}
    kinds = [kind for kind in LOAD_LABELS if isinstance(contact.get(kind), list)]
    if not kinds or not contact[kinds[0]]:
        return dict(config)
    kind, values = kinds[0], contact[kinds[0]]
    for value in values:
        check({**config, "contact": {**contact, kind: value}})
    config = {**config, "contact": {**contact, kind: values[0]}}
    if kind == "area_fraction":
        config["contact"].setdefault("path_area_fractions", sorted({*values}))
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
            raise ConfigError(
                f"contact.{kind} = {shown(values)}: study {study} would have {len(names)} surfaces, "
                f"at most {most} are accepted; fewer loads or surfaces are needed"
            )
    return config


def _most_surfaces(study: str) -> int:
    """Largest number of surfaces of a study."""
    studies = schema()["properties"]["studies"]
    return studies["properties"].get(study, studies["additionalProperties"])["maxItems"]
