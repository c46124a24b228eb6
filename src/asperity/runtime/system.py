"""Locks, memory and processor time, as the operating system provides them.

The only module of the package that depends on the operating system. Where a system does not tell a number,
the number is NaN (memory used) or infinite (memory available).
"""

from __future__ import annotations

import math
import os
import sys
from pathlib import Path

if sys.platform == "win32":
    import msvcrt
else:
    import fcntl
    import resource

_GROUP_LIMITS = ("/sys/fs/cgroup/memory.max", "/sys/fs/cgroup/memory/memory.limit_in_bytes")
"""Files with the memory limit of a control group (versions 2 and 1), also that of a container."""

_LOCKED_BYTE = 2**20
"""Offset of the byte that is locked on Windows, beyond the text that other processes read."""


def lock(descriptor: int) -> None:
    """Lock an open file until it is closed, which the operating system does when its process ends.

    Raises
    ------
    OSError
        If another process holds the lock.
    """
    if sys.platform == "win32":
        os.lseek(descriptor, _LOCKED_BYTE, os.SEEK_SET)
        msvcrt.locking(descriptor, msvcrt.LK_NBLCK, 1)
        os.lseek(descriptor, 0, os.SEEK_SET)
    else:
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)


def available_memory() -> float:
    """Memory that this process may use, in MB: that of the machine or of its control group, if less."""
    limits = [path.read_text().strip() for path in map(Path, _GROUP_LIMITS) if path.is_file()]
    try:
        machine = float(os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE"))
    except (AttributeError, ValueError):
        machine = math.inf
    return min([machine, *(float(limit) for limit in limits if limit.isdigit())]) / 1e6


def peak_memory() -> float:
    """Largest resident memory of this process so far, in MB.

    The memory of the largest program that the process has run is added if it is larger than the process: a
    smaller program cannot be told from the copy of the process in which it was started.
    """
    if sys.platform == "win32":
        return math.nan
    unit = 1 if sys.platform == "darwin" else 1024
    own = _resident_memory() or unit * resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    programs = unit * resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss
    return (own + programs if programs > own else own) / 1e6


def _resident_memory() -> int:
    """Peak resident memory in bytes from Linux; 0 elsewhere.

    `getrusage` also counts the process from which this one was forked, before it started its own program.
    """
    status = Path("/proc/self/status")
    if not status.is_file():
        return 0
    (line,) = (line for line in status.read_text(encoding="utf-8").splitlines() if line.startswith("VmHWM:"))
    return 1024 * int(line.split()[1])


def processor_time() -> float:
    """Processor time of this process and of the programs it has run, in seconds."""
    spent = os.times()
    return spent.user + spent.system + spent.children_user + spent.children_system
