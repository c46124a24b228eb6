"""What jobs took, as their logs say, beside what their rules declare."""

import re

from project import QUICK, ROOT, copy_project, run

COST = ("python", "workflow/cost.py", "results/quick")
DECLARED = (*COST, "--declared", *QUICK)


def test_every_job_has_its_cost_and_takes_the_memory_that_its_rule_declares(quick_study):
    folder = quick_study.folder
    found = run(folder, *DECLARED)
    assert found.returncode == 0, found.stderr
    jobs = re.findall(r"^\| (\S+) \|.* (\S+) \|$", found.stdout, re.MULTILINE)[1:]
    logs = list((folder / "results/quick/log").rglob("*.log"))
    assert len(jobs) == len(logs) > 60
    total = run(folder, *COST).stdout.splitlines()[-1]
    assert total.startswith(f"| all | {len(logs)} | ")


def test_every_rule_with_a_script_declares_what_it_needs():
    texts = [path.read_text() for path in (ROOT / "workflow/rules").glob("*.smk")]
    rules = [rule for text in texts for rule in re.split(r"^rule ", text, flags=re.MULTILINE)[1:]]
    working = {rule.partition(":")[0]: rule for rule in rules if "script:" in rule}
    assert {"machine_code", "calculix", "contact"} <= working.keys()
    for name, rule in working.items():
        for declared in ("threads: ", "mem_mb=", "disk_mb=", "runtime="):
            assert declared in rule, name


def test_a_job_that_took_more_than_its_rule_declares_is_named(quick_study, tmp_path):
    folder = copy_project(tmp_path)
    log = folder / "results/quick/log/stress/hurst_08/seed1.log"
    log.parent.mkdir(parents=True)
    said = (quick_study.folder / log.relative_to(folder)).read_text()
    log.write_text(re.sub(r"\d+ MB of memory", "4700 MB of memory", said))
    found = run(folder, *DECLARED)
    assert found.returncode == 1
    assert re.search(
        r"^stress/hurst_08/seed1: 4700 MB measured, \d+ MB declared$", found.stderr, re.MULTILINE
    )


def test_results_without_logs_are_said_so(tmp_path):
    found = run(copy_project(tmp_path), *COST)
    assert found.returncode == 1
    assert "run the study first" in found.stderr
