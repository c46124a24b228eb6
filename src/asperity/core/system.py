"""Processes and memory, as the operating system provides them.

psutil is imported when it is needed: without it the command line still says what is missing.
"""

from __future__ import annotations

from pathlib import Path

GROUP_LIMITS = ("/sys/fs/cgroup/memory.max", "/sys/fs/cgroup/memory/memory.limit_in_bytes")
"""Files with the memory limit of a control group (versions 2 and 1), also that of a container."""


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
