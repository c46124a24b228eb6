"""Ctrl-C and SIGTERM: every command ends with one line, its exit status, and no file half written."""

import contextlib
import os
import shlex
import signal
import subprocess
import sys

import numpy as np
import pytest
from bad_input import make_chain

from asperity.cli.main import main
from asperity.config import __main__ as checking
from asperity.runtime.interrupts import COMMAND_LINE

MAP = "{map} --unit um --physical-size 16um 16um --orientation 'peaks up'"
SPECTRUM = "--hurst 0.8 --wavelength-long 0.5 --wavelength-short 0.125 --rms-height 0.001 --points 32"
COMMANDS = {
    "run": f"{MAP} --young 1GPa --poisson 0.3 --area-fraction 0.1 --out {{out}}/x",
    "surface": f"{SPECTRUM} --out {{out}}/x.nc",
    "solve": "{surface} --out {out}/x.nc",
    "stress": "{contact} --out {out}/x.nc",
    "peaks": "{stress} --contact {contact} --resamples 10 --out {out}/x.nc",
    "info": MAP.replace("16um", "16"),
    "view": "{contact} pressure --out {out}/x.png",
    "export": "{contact} {stress} --peaks {out}/x.csv",
    "plan": "'{{hurst: 0.8, wavelength_long: 0.125, wavelength_short: 0.03125}}'",
    "plot": "9 {statistics} --out {out}/x.png",
}
SHARES = {signal.SIGINT: 0.3, signal.SIGTERM: 0.9}
"""Part of a command's function calls after which each signal comes."""


class Calls:
    """Counts the calls of functions, and sends this process a signal at one of them.

    Some libraries ignore an exception at some places: the signal comes again every thousand calls.
    """

    def __init__(self, at=None, number=None):
        self.count, self.at, self.number = 0, at, number

    def __call__(self, *_):
        self.count += 1
        if self.at is not None and self.count >= self.at and (self.count - self.at) % 1000 == 0:
            os.kill(os.getpid(), self.number)

    def __enter__(self):
        sys.setprofile(self)
        return self

    def __exit__(self, *_):
        sys.setprofile(None)


@pytest.fixture(scope="module")
def files(tmp_path_factory):
    """Results of one small surface, and a height map."""
    folder = tmp_path_factory.mktemp("chain")
    height = np.random.default_rng(1).normal(size=(16, 16))
    np.savetxt(folder / "map.txt", height)
    return {**make_chain(folder), "map": folder / "map.txt"}


@pytest.mark.parametrize("command", COMMANDS)
def test_a_signal_ends_a_command(command, files, tmp_path, capfd):
    def call(calls):
        words = [word.format(**files, out=tmp_path) for word in shlex.split(COMMANDS[command])]
        with calls:
            return main([command, *words])

    assert call(contextlib.nullcontext()) == 0  # imports its modules
    calls = Calls()
    assert call(calls) == 0
    before = sorted(tmp_path.rglob("*"))
    for number, share in SHARES.items():
        capfd.readouterr()
        assert call(Calls(int(share * calls.count), number)) == 128 + number
        assert capfd.readouterr().err.splitlines()[-1] == f"asperity: {COMMAND_LINE}"
        assert sorted(tmp_path.rglob("*")) == before


def test_a_signal_ends_the_check_of_a_configuration(monkeypatch, capfd):
    monkeypatch.setattr(checking, "_check", lambda _: signal.raise_signal(signal.SIGTERM))
    assert checking.main(["check", "mine.yaml"]) == 143
    assert capfd.readouterr().err == "config: interrupted; run the same command again\n"


IGNORING = """
import signal, sys, time
from asperity.results.dataset import atomic_write
from asperity.runtime import interrupts
interrupts.GRACE = interrupts.AGAIN = 0.1
with interrupts.interruptible("ended"), atomic_write(sys.argv[1]) as unfinished:
    unfinished.write_text("half")
    while True:
        try:
            signal.raise_signal(signal.SIGTERM) if sys.argv[2] == "once" else None
            sys.argv[2] = "never"
            time.sleep(60)
        except BaseException:
            pass
"""


def test_a_command_whose_library_ignores_the_signal_ends_too(tmp_path):
    path = tmp_path / "result.nc"
    found = subprocess.run(
        [sys.executable, "-c", IGNORING, path, "once"], capture_output=True, text=True, timeout=60
    )
    assert (found.returncode, found.stderr) == (143, "ended\n")
    assert list(tmp_path.iterdir()) == []


TERMINATED = """
import signal, sys
from asperity.results.dataset import atomic_write
from asperity.runtime.logs import log_to
with log_to(sys.argv[1]), atomic_write(sys.argv[2]) as unfinished:
    unfinished.write_text("half")
    signal.raise_signal(signal.SIGTERM)
"""


def test_a_terminated_job_deletes_what_it_has_not_finished(tmp_path):
    log = tmp_path / "job.log"
    found = subprocess.run(
        [sys.executable, "-c", TERMINATED, log, tmp_path / "result.nc"], capture_output=True, timeout=60
    )
    assert (found.returncode, found.stderr) == (143, b"")
    assert list(tmp_path.iterdir()) == [log]
    assert "MB of memory" in log.read_text()
