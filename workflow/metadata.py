"""Write the files that are made from others: environment, schema, diagram, metadata, and the address.

    python workflow/metadata.py [--address URL]

workflow/envs/asperity.yaml has the requirements of pyproject.toml, workflow/schemas/config.schema.yaml
the settings of the study, workflow/README.md some of them and the rules of the quick study. codemeta.json,
.zenodo.json and the authors in pyproject.toml say what CITATION.cff says.
With --address the address of the repository, field Repository of pyproject.toml, is replaced there and
wherever it is written.
"""

import argparse
import json
import re
import runpy
import subprocess
import sys
import tomllib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import yaml

from asperity.settings.configuration import Configuration
from asperity.settings.model import OWN_KEYWORDS, described, entry_of

ROOT = Path(__file__).parents[1]
ADDRESSED = (
    "pyproject.toml",
    "CITATION.cff",
    "examples/try_asperity.ipynb",
    "paper/metadata.yaml",
)
SHOWN = """accuracy seeds results fft_engine figures studies surfaces.NAME.hurst surfaces.NAME.rms_height
surfaces.NAME.wavelength_long surfaces.NAME.wavelength_short measured.NAME.file layer.poisson layer.height
contact.contact_area_fraction stress.poisson"""
MARK = "<!-- parameters: python workflow/metadata.py -->\n"


def project() -> dict[str, Any]:
    """Section project of pyproject.toml."""
    return tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]


def environment() -> str:
    """Environment of the jobs: all that the library needs, which a job finds beside the workflow."""
    extras = project()["optional-dependencies"]
    needed = sorted({*project()["dependencies"], *extras["maps"], *extras["study"]}, key=str.lower)
    lines = "".join(f"      - {requirement}\n" for requirement in needed)
    return f"""\
# The environment of every rule: what the library needs. A job finds the library itself by the path of
# Snakemake, which copies this file: it cannot contain a path to the checkout. Made by `make metadata`.
# In a checkout: conda env create --name asperity --file workflow/envs/asperity.yaml
#                conda run --name asperity pip install --no-deps --editable .
channels: [conda-forge, nodefaults]
dependencies:
  - python {project()["requires-python"]},<3.15
  - pip
  - pip:
{lines}"""


def codemeta() -> str:
    """Metadata of the software for registries (https://codemeta.github.io), from CITATION.cff."""
    citation = yaml.safe_load((ROOT / "CITATION.cff").read_text(encoding="utf-8"))
    paper, *_ = citation["references"]
    found = {
        "@context": "https://w3id.org/codemeta/3.0",
        "@type": "SoftwareSourceCode",
        "name": "asperity",
        "description": citation["abstract"],
        "version": citation["version"],
        "license": f"https://spdx.org/licenses/{citation['license']}",
        "codeRepository": citation["repository-code"],
        "programmingLanguage": "Python",
        "runtimePlatform": f"Python {project()['requires-python']}",
        "keywords": citation["keywords"],
        "author": [{"@type": "Organization", "name": name} for name in names(citation)],
        "referencePublication": {"@type": "ScholarlyArticle", "name": paper["title"]},
    }
    return json.dumps(found, indent=2, ensure_ascii=False) + "\n"


def names(citation: Mapping[str, Any]) -> list[str]:
    """Authors of CITATION.cff: groups by their name, persons as family name, given names."""
    return [
        author.get("name") or "{family-names}, {given-names}".format(**author)
        for author in citation["authors"]
    ]


def zenodo() -> str:
    """Metadata of the archive of a release."""
    citation = yaml.safe_load((ROOT / "CITATION.cff").read_text(encoding="utf-8"))
    found = {
        "upload_type": "software",
        "title": citation["title"],
        "description": citation["abstract"],
        "license": citation["license"],
        "access_right": "open",
        "keywords": citation["keywords"],
        "creators": [{"name": name} for name in names(citation)],
    }
    return json.dumps(found, indent=2, ensure_ascii=False) + "\n"


def pyproject() -> str:
    """pyproject.toml with the authors of CITATION.cff."""
    citation = yaml.safe_load((ROOT / "CITATION.cff").read_text(encoding="utf-8"))
    authors = ", ".join(f"{{ name = {json.dumps(name, ensure_ascii=False)} }}" for name in names(citation))
    text = (ROOT / "pyproject.toml").read_text(encoding="utf-8")
    return re.sub(r"^authors = .*$", f"authors = [{authors}]", text, count=1, flags=re.MULTILINE)


def config_schema() -> str:
    """JSON Schema of a configuration, with keywords of the standard only."""
    head = {"$schema": "https://json-schema.org/draft/2020-12/schema"}
    whole = head | standard(described(Configuration))
    text = yaml.safe_dump(whole, allow_unicode=True, sort_keys=False, width=120)
    return f"# Made by `make metadata` from src/asperity/settings/configuration.py, for editors.\n{text}"


def standard(entry: Any) -> Any:
    """An entry without keywords of asperity; the unit is added to the description."""
    if isinstance(entry, list):
        return [standard(each) for each in entry]
    if not isinstance(entry, Mapping):
        return entry
    unit = f" Unit: {entry['unit']}." if isinstance(entry.get("unit"), str) else ""
    kept = {key: value for key, value in entry.items() if key not in {*OWN_KEYWORDS, "format"}}
    made = {key: standard(value) for key, value in kept.items()}
    if "properties" in entry:
        made["properties"] = {name: standard(each) for name, each in entry["properties"].items()}
    if unit:
        made["description"] = f"{entry.get('description', '')}{unit}".strip()
    return made


def diagram() -> str:
    """Rules of the quick study as a graph that GitHub draws."""
    command = [sys.executable, "-m", "snakemake", "--rulegraph", "mermaid-js"]
    command += ["--configfile", "config/quick.yaml", "--config", "results=results/diagram", "--forceall"]
    graph = subprocess.run(command, cwd=ROOT, check=True, capture_output=True, text=True).stdout
    names = dict(re.findall(r"(id\d+)\[(\w+)\]", graph))
    arrows = sorted((names[a], names[b]) for a, b in re.findall(r"(id\d+) --> (id\d+)", graph))
    return "\n".join(["```mermaid", "flowchart TB", *(f"    {a} --> {b}" for a, b in arrows), "```", ""])


def parameters() -> str:
    """Table of the settings that most studies give."""
    made = runpy.run_path(str(Path(__file__).parents[1] / "docs/make_tables.py"))
    return made["settings_table"]((key, entry_of(Configuration, key)) for key in SHOWN.split()) + "\n"


def main() -> None:
    """Write the files."""
    parser = argparse.ArgumentParser(description="Write the files that are made from others.")
    parser.add_argument(
        "--address", help="address of the repository, such as https://github.com/NAME/asperity"
    )
    if address := parser.parse_args().address:
        old = project()["urls"]["Repository"]
        for path in (ROOT / name for name in ADDRESSED):
            text = path.read_text(encoding="utf-8")
            path.write_text(text.replace(old, address.rstrip("/")), encoding="utf-8")
    (ROOT / "workflow/schemas").mkdir(exist_ok=True)
    readme = ROOT / "workflow/README.md"
    for path, text in {
        ROOT / "workflow/envs/asperity.yaml": environment(),
        ROOT / "workflow/schemas/config.schema.yaml": config_schema(),
        ROOT / "codemeta.json": codemeta(),
        ROOT / ".zenodo.json": zenodo(),
        ROOT / "pyproject.toml": pyproject(),
        readme: f"{readme.read_text(encoding='utf-8').split(MARK)[0]}{MARK}\n{parameters()}\n{diagram()}",
    }.items():
        path.write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main()
