"""A study of a user's own makes what its configuration asks for, and nothing of the paper's."""

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
import yaml
from project import ROOT, copy_project, hide, snakemake_here

from asperity.core.errors import InputError
from asperity.core.packages import NEEDED
from asperity.settings.sections import contact_of, imposed_load
from asperity.settings.study import read_study

SURFACE = {"label": "A", "hurst": 0.8, "wavelength_long": 0.5, "wavelength_short": 0.25, "rms_height": 0.001}
PAPER = yaml.safe_load((ROOT / "config/config.yaml").read_text(encoding="utf-8"))
TWO = {"a": SURFACE, "b": {**SURFACE, "hurst": 0.3}}
OWN_FIGURES = {"spectrum", "heights", "pressure", "load_area", "peaks", "depths", "decay"}
RATIO_FIGURES = {"poisson_peaks", "poisson_depths", "poisson_decay"}


@pytest.fixture(scope="module")
def project(tmp_path_factory):
    """A copy of the project without results."""
    return copy_project(tmp_path_factory.mktemp("dry"))


def jobs(folder, *options):
    """Rule, outputs and inputs of every job in a dry run."""
    text = snakemake_here(folder, "--dry-run", *options)
    assert "This was a dry-run" in text, text
    pattern = r"^(?:local)?rule (\w+):\n(?:    input: (.*)\n)?(?:    output: (.*)\n)?"
    found = re.findall(pattern, text, re.M)
    return [(rule, outputs.split(", "), inputs.split(", ")) for rule, inputs, outputs in found]


def drawn(jobs):
    """Names of the pictures that jobs draw."""
    outputs = [Path(file) for rule, files, _ in jobs if rule.startswith("figures_") for file in files]
    return {file.name for file in outputs if file.suffix == ".png"}


def config_in(folder, name, config):
    """Options for a configuration written to a file."""
    (folder / name).write_text(yaml.safe_dump(config), encoding="utf-8")
    return "--configfile", name


def test_two_surfaces_make_their_own_jobs(project):
    config = {"seeds": [1, 2, 3, 4], "surfaces": TWO, "studies": {"both": ["a", "b", "fault"], "one": ["a"]}}
    config |= {"stress": {"poisson": [0.33, 0.5]}, "validation": {"punch": PAPER["validation"]["punch"]}}
    config |= {"measured": PAPER["measured"]}
    found = jobs(project, *config_in(project, "mine.yaml", config))
    expected = {f"{name}_{study}.png" for name in OWN_FIGURES for study in ("both", "one")}
    expected |= {"fig12.png", *(f"{name}_one.png" for name in RATIO_FIGURES)}
    assert all(outputs[0].startswith("results/mine/") for rule, outputs, _ in found if rule != "study")
    assert drawn(found) == expected
    contacts = [outputs[-1] for rule, outputs, _ in found if rule == "contact"]
    assert [file for file in contacts if "fault" in file] == ["results/mine/contact/fault/seed1.nc"]


def test_measured_maps_are_read_before_the_first_job(project):
    shutil.copy(ROOT / "tests/data/steel.npy", project)
    config = {"measured": {"steel": {"label": "steel", "file": "steel.npy"}}}
    said = snakemake_here(project, *config_in(project, "maps.yaml", config))
    lines = [line for line in said.splitlines() if line.startswith("config: ")]
    names = ("physical_size", "orientation", "periodic", "undefined")
    starts = tuple(line.split(":")[2].strip() for line in lines)
    assert starts == tuple(f"measured.steel.{name}" for name in names)
    assert not list((project / "results").rglob("*.nc"))


def test_claims_are_not_about_surfaces_of_the_user(project):
    config = {
        "based_on": "config/config.yaml",
        "surfaces": TWO,
        "studies": {"hurst": ["a", "b"], "skewness": [], "kurtosis": [], "moments": [], "measured": []},
    }
    found = jobs(project, *config_in(project, "mixed.yaml", config))
    assert all(outputs[0].startswith("results/mixed/") for rule, outputs, _ in found if rule != "study")
    (inputs,) = (inputs for rule, _, inputs in found if rule == "claims")
    read = {name.rsplit("/", 1)[-1] for name in inputs if "/statistics/" in name}
    assert read == {"hurst_08.nc"}  # of study compressibility
    figures = drawn(found)
    assert {"fig06.png", "fig13.png"} <= figures
    assert not figures & {"fig16.png", "fig17.png", "fig18.png"}


AREA = "contact_area_fraction"
REFUSED = [
    ({"results": "/scratch/x"}, {}, "results = '/scratch/x': `results` or a folder below it is needed"),
    ({"results": "results"}, {}, "this one holds the results of the paper"),
    ({}, {"results": "/tmp/{x}"}, "results = '/tmp/{x}': a folder is needed, without braces"),
    ({}, {"results": 5}, "results = 5: a folder is needed"),
    ({"surfaces": {}}, {}, "surfaces: missing; at least one is needed, here or under measured"),
    ({"layer": {"height": 1e-9}}, {}, "layer.height = 1e-09: at least 0.0625 is needed for a, 4 planes"),
    ({"surfaces": {"a": {**SURFACE, "label": r"$\frac{1}$"}}}, {}, r"surfaces.a.label = '$\\frac{1}$': math"),
    ({"contact": {"method": "gfmd", "tolerance": 1e-14}}, {}, "contact.tolerance = 1e-14: a number ≥ 1e-13"),
    ({"claims": True}, {}, "claims = true needs figures = 'paper'"),
    ({"based_on": "none.yaml"}, {}, "based_on = 'none.yaml': none.yaml: no such file"),
    ({"based_on": 5}, {}, "based_on = 5: the name of a configuration, such as"),
    ({"contact": {AREA: [0.1, 2]}}, {}, f"contact.{AREA} = 2: a number > 0 and ≤ 1"),
    ({"contact": {AREA: [0.1, 0.2, 0.3]}}, {}, f"contact.{AREA} = [0.1, 0.2, 0.3]: study a"),
    ({"surfaces": {"a": SURFACE | {"contact": {}}}}, {}, f"surfaces.a.contact = {{}}: one of {AREA}, m"),
    ({"surfaces": dict.fromkeys("abcde", SURFACE)}, {}, "studies: missing; with 5 surfaces, studies of at"),
    ({"studies": {"My": ["a"]}}, {}, "studies.'My': a name of at most 40 lower-case letters"),
]


@pytest.mark.parametrize(("changes", "given", "line"), REFUSED, ids=[line[:40] for *_, line in REFUSED])
def test_a_wrong_study_is_refused_in_one_line(tmp_path, changes, given, line):
    path = tmp_path / "mine.yaml"
    path.write_text(yaml.safe_dump({"surfaces": TWO, **changes}), encoding="utf-8")
    with pytest.raises(InputError) as found:
        read_study([path], given)
    assert any(line in each for each in found.value.lines)
    assert all(each.isprintable() for each in found.value.lines)


def test_list_of_loads_presses_every_surface(project):
    config = {"surfaces": TWO, "contact": {"contact_area_fraction": [0.02, 0.1]}}
    alone = {"a": SURFACE, "b": {**SURFACE, "contact": {"contact_area_fraction": 0.05}}}
    mixed = read_study([project / config_in(project, "mixed.yaml", config | {"surfaces": alone})[1]])
    assert mixed["studies"] == {"all": ["a_load1", "a_load2", "b"]}
    study = read_study([project / config_in(project, "loads.yaml", config)[1]])
    assert study["studies"] == {"all": ["a_load1", "a_load2", "b_load1", "b_load2"]}
    assert study["surfaces"]["b_load1"]["label"] == "A, $A/A_0$ = 0.02"
    loads = [contact_of(study, name)["contact_area_fraction"] for name in study["surfaces"]]
    assert loads == [0.02, 0.1, 0.02, 0.1]
    assert study["contact"]["path_contact_area_fractions"] == [0.02, 0.1]
    found = jobs(project, "--configfile", "loads.yaml")
    made = {outputs[0] for rule, outputs, _ in found if rule == "contact"}
    again = {outputs[0]: inputs for rule, outputs, inputs in found if rule == "contact_again"}
    first = [f"results/loads/surface/{name}_load1/seed{seed}.nc" for name in "ab" for seed in study["seeds"]]
    assert made == {*first}  # each surface is made once, and pressed again from its file
    assert {file for inputs in again.values() for file in inputs} == made
    assert len(again) == len(made)


def test_a_study_is_based_on_another(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    texts = {"one": {"surfaces": TWO}, "two": {"based_on": "one.yaml", "seeds": [5]}}
    texts |= {"three": {"based_on": "two.yaml", "contact": {"mean_pressure": 0.01}}}
    texts |= {"up": {"based_on": "down.yaml"}, "down": {"based_on": "up.yaml"}}
    for name, config in texts.items():
        Path(f"{name}.yaml").write_text(yaml.safe_dump(config), encoding="utf-8")
    study = read_study(["three.yaml"])
    assert (list(study["surfaces"]), study["seeds"], study["results"]) == (["a", "b"], [5], "results/three")
    assert imposed_load(study["contact"]) == ("mean_pressure", 0.01)
    with pytest.raises(InputError, match=r"^based_on = 'down.yaml': a file that is not based on itself"):
        read_study(["up.yaml"])


def test_file_with_an_unsuitable_name_names_its_folder(tmp_path):
    path = tmp_path / "my study.yaml"
    path.write_text(yaml.safe_dump({"surfaces": TWO}), encoding="utf-8")
    with pytest.raises(InputError, match=r"results: missing; 'my study.yaml' cannot name the folder"):
        read_study([path])
    assert read_study([path], {"results": "~//x/"})["results"].endswith("/x")


# No library outside the project, and no plug-in of Snakemake, which would need pandas.
ALONE = f"""
import pkgutil, sys

sys.path = [path for path in sys.path if path != {str(ROOT / "src")!r}]
listed = pkgutil.iter_modules
pkgutil.iter_modules = lambda *given: [one for one in listed(*given) if "slurm" not in one.name]
"""


def test_snakemake_alone_plans_the_study(project, tmp_path):
    """Without the library and the packages that Snakemake does not bring; a job needs them."""
    brought = ("docutils", "jinja2", "psutil", "pydantic", "snakemake", "yaml")
    dark = hide(
        tmp_path / "dark",
        *(name for name in (*NEEDED, "snakemake_executor_plugin_slurm") if name not in brought),
    )
    with open(dark / "sitecustomize.py", "a", encoding="utf-8") as file:
        file.write(ALONE)

    def alone(*options):
        command = [sys.executable, "-m", "snakemake", *options]
        given = os.environ | {"PYTHONPATH": str(dark)}
        found = subprocess.run(command, cwd=project, env=given, capture_output=True, text=True)
        return found.returncode, found.stdout + found.stderr

    code, said = alone("--profile", "profiles/slurm", "--dry-run")
    assert (code, said.splitlines()[-1].split("; ")[-1]) == (1, 'install with: pip install "asperity[slurm]"')
    code, said = alone("--cores", "1", "--configfile", "config/quick.yaml")
    last = said.splitlines()[-1]
    assert (code, "figures_hurst" in said) == (1, True), said
    assert last.startswith("study: not installed: lazy-loader, ")
    assert last.endswith(f'install with: pip install "{project}[study]"')
