"""Memory that jobs took, as their logs say, compared with what their rules declare."""

import re

from project import QUICK, ROOT, copy_project, run

COST = ("python", "workflow/cost.py", "results/quick")
DECLARED = (*COST, "--declared", *QUICK)


def test_every_job_takes_the_memory_that_its_rule_declares(quick_study):
    folder = quick_study.folder
    found = run(folder, *DECLARED)
    assert found.returncode == 0, found.stderr
    *rules, total = (int(jobs) for jobs in re.findall(r"^\| [^|]+ \| (\d+) \|", found.stdout, re.MULTILINE))
    logs = list((folder / "results/quick/log").rglob("*.log"))
    assert sum(rules) == total == len(logs)


def test_every_rule_with_a_script_declares_its_resources():
    texts = [path.read_text() for path in (ROOT / "workflow/rules").glob("*.smk")]
    rules = [rule for text in texts for rule in re.split(r"^rule ", text, flags=re.MULTILINE)[1:]]
    with_script = {rule.partition(":")[0]: rule for rule in rules if "script:" in rule}
    assert {"machine_code", "calculix", "contact"} <= with_script.keys()
    for name, rule in with_script.items():
        for declared in ("threads: ", "mem_mb=", "disk_mb=", "runtime="):
            assert declared in rule, name


def test_a_job_that_took_more_memory_than_its_rule_declares_is_named(quick_study, tmp_path):
    folder = copy_project(tmp_path)
    log = folder / "results/quick/log/stress/hurst_08/seed1.log"
    log.parent.mkdir(parents=True)
    text = (quick_study.folder / log.relative_to(folder)).read_text()
    log.write_text(re.sub(r"\d+ MB of memory", "4700 MB of memory", text))
    found = run(folder, *DECLARED)
    assert found.returncode == 1
    assert re.search(
        r"^stress/hurst_08/seed1: 4700 MB measured, \d+ MB declared$", found.stderr, re.MULTILINE
    )


def test_results_without_logs_are_an_error(tmp_path):
    found = run(copy_project(tmp_path), *COST)
    assert found.returncode == 1
    assert "run the study first" in found.stderr
