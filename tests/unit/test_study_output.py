"""Terminal output of a study: the logger plugin, given the messages that Snakemake sends it."""

import io
import logging
from types import SimpleNamespace

import pytest

pytest.importorskip("snakemake_interface_logger_plugins")
from snakemake_interface_logger_plugins.common import LogEvent

from snakemake_logger_plugin_asperity import LogHandler


class Terminal(io.StringIO):
    def isatty(self):
        return True


class Output:
    """The handler of one run, and what it has printed."""

    def __init__(self, monkeypatch, stream=None, **settings):
        self.stream = stream or io.StringIO()
        monkeypatch.setattr("sys.stderr", self.stream)
        chosen = {"stdout": False, "verbose": False, "dryrun": False} | settings
        self.handler = LogHandler(SimpleNamespace(**chosen), None)

    def send(self, text=None, event=None, level=logging.INFO, **fields):
        record = logging.LogRecord("snakemake", level, "", 0, text, None, None)
        record.__dict__ |= {"event": event} | fields
        self.handler.emit(record)

    def run(self, jobs):
        """Begin a run of so many jobs."""
        self.send("Workflow has started!", LogEvent.WORKFLOW_STARTED)
        self.send("Job stats: …", LogEvent.RUN_INFO, stats={"contact": jobs, "total": jobs})

    def start(self, number, name="contact", message=None):
        self.send(
            f"Rule: {name}",
            LogEvent.JOB_INFO,
            jobid=number,
            rule_name=name,
            rule_msg=message,
            wildcards={"surface": f"s{number}"},
        )

    def finish(self, number, total):
        self.send("Finished", LogEvent.JOB_FINISHED, job_id=number)
        self.send(None, LogEvent.PROGRESS, done=number, total=total)

    def fail(self, log, message=None, **fields):
        told = {"output": ["results/a.nc"], "log": [str(log)], "rule_msg": message, "indent": False}
        self.send("Error in rule contact", LogEvent.JOB_ERROR, logging.ERROR, **told | fields)

    @property
    def lines(self):
        return self.stream.getvalue().splitlines()


@pytest.fixture
def output(monkeypatch):
    return Output(monkeypatch)


def failed_log(folder, error="asperity.errors.DatasetError: results/b.nc: damaged"):
    log = folder / "job.log"
    log.write_text(f"begun\nTraceback (most recent call last):\n  File …\n{error}\ntook 1 s\n")
    return log


def test_a_run_takes_ten_lines_of_progress_without_a_terminal(output):
    output.send("Building DAG of jobs...")
    output.run(100)
    for number in range(1, 101):
        output.send("Select jobs to execute...")
        output.start(number)
        output.finish(number, 100)
    assert output.lines == [f"study: {n} of 100 jobs done ({n} %)" for n in range(10, 101, 10)]


def test_a_terminal_shows_one_line_with_the_running_jobs(monkeypatch):
    output = Output(monkeypatch, Terminal())
    output.run(2)
    output.start(1, "{odd} 100 %s")
    output.finish(1, 2)
    output.handler.close()
    shown = output.stream.getvalue()
    assert "0 of 2 jobs" in shown
    assert "{odd} 100 %s s1" in shown
    assert "1 of 2 jobs" in shown
    assert "\n" not in shown


def test_messages_of_the_study_and_of_rules_are_printed(output):
    output.run(1)
    output.send("study: done; figures in results/figures")
    output.start(1, message="compiling, once")
    output.send("Nothing to be done (all requested files are present and up to date).")
    assert [line.split()[:2] for line in output.lines] == [
        ["study:", "done;"],
        ["study:", "compiling,"],
        ["Nothing", "to"],
    ]


def test_a_failed_job_is_one_line_at_once_and_again_at_the_end(output, tmp_path):
    log = failed_log(tmp_path)
    output.run(10)
    output.send("RuleException:\nCalledProcessError in file …", LogEvent.ERROR, logging.ERROR)
    output.fail(log)
    line = f"study: results/b.nc: damaged [{log}]"
    assert output.lines == [line]
    output.send("Exiting because a job execution failed. Look above", level=logging.ERROR)
    output.finish(5, 10)
    output.send(
        "WorkflowError:\nAt least one job did not complete successfully.", LogEvent.ERROR, logging.ERROR
    )
    output.handler.close()
    output.handler.close()
    assert output.lines == [line, "study: 5 of 10 jobs done (50 %)", line]


def test_a_failed_job_without_an_error_in_its_log_has_the_reason_of_the_cluster(output, tmp_path):
    output.run(10)
    output.fail(tmp_path / "none.log", "SLURM status is: 'TIMEOUT'. For further error details see the log.")
    output.fail(tmp_path / "none.log")
    assert output.lines == [
        "study: results/a.nc: SLURM status is: 'TIMEOUT'.",
        "study: results/a.nc: its job was stopped; memory, disk space or the time allowed may have run out",
    ]


def test_of_a_failed_group_the_job_with_the_error_is_named(output, tmp_path):
    (tmp_path / "good.log").write_text("done\n")
    logs = [tmp_path / "good.log", failed_log(tmp_path, "ValueError: no peaks"), tmp_path / "not_begun.log"]
    jobs = [{"output": [f"{log.stem}.nc"], "log": [str(log)]} for log in logs]
    output.run(10)
    output.send("Error in group", LogEvent.GROUP_ERROR, logging.ERROR, job_error_info=jobs, aux_logs=[])
    for job in jobs:
        output.fail(job["log"][0], indent=True)
    assert output.lines == [f"study: job.nc: no peaks (ValueError) [{tmp_path / 'job.log'}]"]


def test_other_errors_and_warnings_are_printed_as_they_are(output):
    output.run(1)
    output.send("MissingOutputException in rule contact", LogEvent.ERROR, logging.ERROR)
    output.send("a warning", level=logging.WARNING)
    assert output.lines == ["MissingOutputException in rule contact", "a warning"]


@pytest.mark.parametrize("setting", ["verbose", "dryrun"])
def test_everything_is_printed_if_asked_for(monkeypatch, setting):
    output = Output(monkeypatch, **{setting: True})
    output.run(1)
    output.send("Select jobs to execute...")
    assert output.lines == ["Workflow has started!", "Job stats: …", "Select jobs to execute..."]


def test_other_commands_than_a_run_keep_their_messages(output):
    output.send("Building DAG of jobs...")
    output.send("Report created: report.html")
    assert output.lines == ["Report created: report.html"]
