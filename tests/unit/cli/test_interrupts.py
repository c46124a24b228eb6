"""Ctrl-C and SIGTERM: every command ends with one line, its exit status, and no file half written."""

import os
import shlex
import signal
from importlib import import_module

import numpy as np
import pytest

import asperity as asp
from asperity.cli.main import INTERRUPTED, main

COMMANDS = {
    "run": "{map} --unit um --physical-size 16um 16um --set 'map.orientation=peaks up' --young 1GPa "
    "--poisson 0.3 --contact-area-fraction 0.1 --out {out}/x",
    "export": "{contact} --field xx:0-0.1 {out}/x.vti",
    "view": "{contact} pressure --out {out}/x.png",
    "plan": "'{{hurst: 0.8, wavelength_long: 0.125, wavelength_short: 0.03125}}'",
}


def signalling(number, genuine):
    """A function that sends this process a signal before it does what it did."""

    def function(*arguments, **options):
        signal.raise_signal(number)
        return genuine(*arguments, **options)

    return function


@pytest.mark.parametrize(
    ("command", "number"), [*((command, signal.SIGINT) for command in COMMANDS), ("export", signal.SIGTERM)]
)
def test_signal_ends_a_command(command, number, chain, tmp_path, capfd, monkeypatch, without_pictures):
    """After the computation, before a file gets its name or the answer is printed."""
    np.savetxt(tmp_path / "map.txt", np.random.default_rng(1).normal(size=(16, 16)))
    files, out = {**chain, "map": tmp_path / "map.txt"}, tmp_path / "out"
    out.mkdir()
    if command == "plan":
        module = import_module("asperity.cli.commands.plan")
        monkeypatch.setattr(module, "print", signalling(number, print), raising=False)
    for name in ("rename", "replace"):
        monkeypatch.setattr(os, name, signalling(number, getattr(os, name)))
    words = [word.format(**files, out=out) for word in shlex.split(COMMANDS[command])]
    handlers = [signal.getsignal(number) for number in (signal.SIGINT, signal.SIGTERM)]
    assert main([command, *words]) == 128 + number
    assert capfd.readouterr().err.splitlines()[-1] == f"asperity: {INTERRUPTED}"
    assert not [path for path in out.rglob("*") if path.is_file()]
    assert [signal.getsignal(number) for number in (signal.SIGINT, signal.SIGTERM)] == handlers


def test_interrupted_write_leaves_nothing(chain, tmp_path, monkeypatch):
    """The library: the file as it was before, and nothing half written."""
    contact, path = asp.read_result(chain["contact"]), tmp_path / "contact.nc"
    asp.write_result(contact, path, "Contact")
    before = path.read_bytes()
    for name in ("rename", "replace"):
        monkeypatch.setattr(os, name, signalling(signal.SIGINT, getattr(os, name)))
    handler = signal.signal(signal.SIGINT, signal.default_int_handler)  # ignored in a job in the background
    try:
        with pytest.raises(KeyboardInterrupt):
            asp.write_result(2 * contact, path, "Contact")
    finally:
        signal.signal(signal.SIGINT, handler)
    assert os.listdir(tmp_path) == ["contact.nc"]
    assert path.read_bytes() == before
