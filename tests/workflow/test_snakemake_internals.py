"""Facts that `asperity.runtime.snakemake_internals` takes from attributes that Snakemake does not document.

If a test fails after an update of Snakemake, the attribute that the function reads has moved: look for it in
`snakemake/workflow.py` and repair the function; nothing else of the study reads such attributes.
"""

import json
import re
from pathlib import Path

import pytest
from project import ROOT, run

from asperity.runtime.snakemake_internals import record_of

SNAKEFILE = """
import json
from asperity.runtime import snakemake_internals as internals

found = {"overlays": internals.overlays(workflow), "given": internals.settings_given(workflow)}

rule made:
    input: "input.txt"
    output: "made_{name}.txt"
    resources: mem_mb=200, disk_mb=3
    shell: "touch {output}"

onstart:
    found.update({
        "jobs": [(*job[:1], dict(job.wildcards), *job[2:]) for job in internals.jobs_to_run(workflow)],
        "local": internals.runs_locally(workflow),
        "main": internals.is_main_process(workflow),
        "at once": internals.jobs_at_once(workflow),
        "limit": internals.memory_limit(workflow),
    })
    print(json.dumps(found))
"""


@pytest.fixture(scope="module")
def found(tmp_path_factory):
    """What the functions say of a run of one job with two cores, an overlay and a memory limit."""
    folder = tmp_path_factory.mktemp("internals")
    (folder / "Snakefile").write_text(SNAKEFILE)
    (folder / "input.txt").write_text("")
    (folder / "overlay.yaml").write_text("key: 1")
    options = (
        "--cores",
        "2",
        "--configfile",
        "overlay.yaml",
        "--config",
        "other=2",
        "--resources",
        "mem_mb=1000",
    )
    ran = run(folder, "env", f"PYTHONPATH={ROOT / 'src'}", "snakemake", *options, "--", "made_one.txt")
    assert ran.returncode == 0, f"a function of snakemake_internals fails:\n{ran.stderr}"
    return json.loads(ran.stdout.splitlines()[0]) | {"record": folder / record_of(Path("made_one.txt"))}


def test_overlays_are_those_of_the_command_line(found):
    assert [path.rsplit("/", 1)[-1] for path in found["overlays"]] == ["overlay.yaml"]


def test_settings_given_are_those_of_the_command_line_alone(found):
    assert found["given"] == {"other": 2}


def test_jobs_have_their_rule_wildcards_files_and_resources(found):
    ((rule, wildcards, inputs, outputs, resources),) = found["jobs"]
    assert (rule, wildcards, inputs, outputs) == ("made", {"name": "one"}, ["input.txt"], ["made_one.txt"])
    assert (resources["mem_mb"], resources["disk_mb"]) == (200, 3)


def test_jobs_run_here_on_the_cores_given_within_the_memory_given(found):
    assert (found["local"], found["at once"], found["limit"]) == (True, 2, 1000.0)


def test_no_other_place_reads_undocumented_attributes():
    documented = {"cores", "source_path"}
    sources = [ROOT / "Snakefile", *(ROOT / "workflow").rglob("*.smk"), *(ROOT / "workflow").rglob("*.py")]
    sources += [path for path in (ROOT / "src").rglob("*.py") if path.stem != "snakemake_internals"]
    read = {name for path in sources for name in re.findall(r"\bworkflow\.([a-z]\w*)", path.read_text())}
    assert read - {"tradeoff"} <= documented


def test_this_was_the_main_process_and_its_jobs_are_recorded(found):
    assert found["main"] is True
    assert "made_one" not in found["record"].name  # encoded
    assert json.loads(found["record"].read_text())["rule"] == "made"
