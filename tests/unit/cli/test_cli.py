"""The command line: streams, faults, missing packages, slow imports."""

import os
import shlex
import subprocess
import sys

import pytest
from project import ROOT, hide

from asperity.cli.main import main
from asperity.core.packages import message

STEEL = ROOT / "tests/data/steel.x3p"


def test_closed_streams_take_no_output():
    """As of `>&-`: neither a traceback, nor a file that is opened later in their place."""
    code = f"import os, sys; from asperity.cli.main import main; main(['info', {str(STEEL)!r}]); os.fstat(1)"
    command = ["sh", "-c", '"$0" -c "$1" <&- >&-', sys.executable, code]
    found = subprocess.run(command, capture_output=True, text=True)
    assert (found.returncode, found.stderr) == (0, "")


@pytest.mark.parametrize("fault", [lambda: {}["mean"], lambda: None + 1, lambda: int("x"), lambda: 1 / 0])
def test_own_faults_have_a_traceback(monkeypatch, capsys, fault):
    """A refusal, which a raise statement makes, is one line."""
    monkeypatch.setattr("asperity.cli.commands.info.run", lambda _: fault())
    assert main(["info", str(STEEL)]) == 1
    first, *_, last = capsys.readouterr().err.splitlines()
    assert first.startswith("Traceback")
    assert last.startswith("asperity: an error of asperity itself")


HELP = "import sys; from asperity.cli.parser import make_parser; make_parser('').format_help(); "
FIGURES = "import sys; from asperity.paper.figures import known; known(); "


@pytest.mark.parametrize(("code", "library"), [(HELP, "numpy"), (FIGURES, "matplotlib")])
def test_help_does_not_wait_for_libraries(code, library):
    code += f"sys.exit({library!r} in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code]).returncode == 0


@pytest.mark.parametrize(
    ("name", "command", "program"),
    [
        ("numba", "asperity --version", "asperity"),
        ("yaml", "asperity.settings check config/config.yaml", "config"),
        ("matplotlib", "asperity view a.nc gap", "asperity"),
        ("SurfaceTopography", f"asperity info {shlex.quote(str(STEEL.with_suffix('.gwy')))}", "asperity"),
    ],
)
def test_a_missing_package_is_one_line(tmp_path, name, command, program):
    path = os.pathsep.join([str(hide(tmp_path / "dark", name)), str(ROOT / "src")])
    command, environment = [sys.executable, "-m", *shlex.split(command)], os.environ | {"PYTHONPATH": path}
    found = subprocess.run(command, cwd=ROOT, env=environment, capture_output=True, text=True)
    assert (found.returncode, found.stdout, found.stderr) == (1, "", f"{program}: {message([name])}\n")
