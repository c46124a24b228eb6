"""What benchmarks share: command lines, runs in a process of their own, and memory as reported by Linux."""

import argparse
import json
import subprocess
import sys
from pathlib import Path
from typing import Any


def parser_of(text: str | None) -> argparse.ArgumentParser:
    """A parser of a command line, with the docstring of the script as its help."""
    return argparse.ArgumentParser(description=text, formatter_class=argparse.RawDescriptionHelpFormatter)


def in_own_process(script: str, *arguments: object) -> dict[str, Any]:
    """The JSON in the last line that a script prints."""
    command = [sys.executable, script, *map(str, arguments)]
    run = subprocess.run(command, check=True, stdout=subprocess.PIPE, text=True)
    return json.loads(run.stdout.splitlines()[-1])


def peak_memory() -> float:
    """Largest resident memory since `reset_peak_memory`, in MB."""
    lines = Path("/proc/self/status").read_text(encoding="ascii").splitlines()
    return 1024 * int(dict(line.split(":", 1) for line in lines)["VmHWM"].split()[0]) / 1e6


def reset_peak_memory() -> None:
    """Forget the peak so far."""
    Path("/proc/self/clear_refs").write_text("5", encoding="ascii")
