"""Processes, memory and processor time, as the operating system provides them.

The only module of the package that depends on the operating system. Peaks of memory are found in ``/proc``
on Linux, with `resource` on macOS, with psutil on Windows; all else is asked of psutil. psutil is imported
when it is needed: without it the command line still says what is missing.
"""

from __future__ import annotations

import sys
from pathlib import Path

try:
    import resource
except ImportError:  # Windows
    resource = None  # type: ignore[assignment]

GROUP_LIMITS = ("/sys/fs/cgroup/memory.max", "/sys/fs/cgroup/memory/memory.limit_in_bytes")
"""Files with the memory limit of a control group (versions 2 and 1), also that of a container."""

STATUS = Path("/proc/self/status")
"""File in which Linux tells, as VmHWM, the peak of the resident memory of this process."""

RESET = Path("/proc/self/clear_refs")
"""File to which "5" is written to reset that peak."""


def is_running(process: int) -> bool:
    """True if there is a process of this number."""
    import psutil

    return psutil.pid_exists(process)


def available_memory() -> float:
    """Memory that this process may use, in MB: that of the machine or of its control group, if less."""
    import psutil

    limits = [path.read_text(encoding="ascii").strip() for path in map(Path, GROUP_LIMITS) if path.is_file()]
    machine = psutil.virtual_memory().total
    return min([machine, *(float(limit) for limit in limits if limit.isdigit())]) / 1e6


def peak_memory() -> float:
    """Largest resident memory of this process since `reset_peak_memory`, in MB.

    `getrusage` also counts the process from which this one was forked, before it started its own program:
    the file of Linux is better.
    """
    if STATUS.is_file():
        lines = dict(line.split(":", 1) for line in STATUS.read_text(encoding="utf-8").splitlines())
        return 1024 * int(lines["VmHWM"].split()[0]) / 1e6
    if resource is not None:
        unit = 1 if sys.platform == "darwin" else 1024
        return unit * resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e6
    import psutil

    return psutil.Process().memory_info().peak_wset / 1e6


def reset_peak_memory() -> None:
    """Forget the peak of the resident memory so far; only Linux can, elsewhere it is that since the start."""
    if RESET.exists():
        RESET.write_text("5", encoding="ascii")
