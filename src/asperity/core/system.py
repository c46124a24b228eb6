"""Processes and memory, as the operating system provides them.

psutil is imported when it is needed: without it the command line still names missing packages.
"""

import hashlib
import os
import re
import shlex
import socket
import subprocess
import sys
from contextlib import suppress
from pathlib import Path

GROUP_LIMITS = ("/sys/fs/cgroup/memory.max", "/sys/fs/cgroup/memory/memory.limit_in_bytes")
"""Files with the memory limit of a control group (versions 2 and 1), such as a container."""


COMPILED_PARTS = ("contact", "stress")
"""Parts that are compiled side by side, see `asperity.study.preflight_and_manifest.warm_up`."""

COMPILING = "ASPERITY_COMPILING"
"""Environment variable of the processes that compile a part."""

SAME_START = 2.0
"""Tolerance in s on the start time of a process: the clock may have been set."""


def process_name() -> str:
    """Host, number and start of this process, as a part of the name of a file."""
    import psutil

    return f"{_host()}.{os.getpid()}.{psutil.Process().create_time():.0f}"


def has_ended(name: str) -> bool:
    """True if a name from `process_name` is of a process of this host that has ended.

    A later process with the same number, as after a restart, has another start time.
    """
    import psutil

    host, process, start = name.rsplit(".", 2)
    if host != _host():
        return False
    try:
        found = psutil.Process(int(process))
        is_same = abs(found.create_time() - float(start)) <= SAME_START
        return not is_same or found.status() == psutil.STATUS_ZOMBIE
    except psutil.NoSuchProcess:
        return True
    except psutil.AccessDenied:
        return False


def _host() -> str:
    """Name of this host in characters that file names may have."""
    return re.sub(r"[^A-Za-z0-9-]", "_", socket.gethostname())[:40]


def sha256_of(path: str | os.PathLike[str]) -> str:
    """SHA-256 checksum of a file."""
    with open(path, "rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


def is_locked(path: str | os.PathLike[str]) -> bool:
    """True if another program has locked a file, as HDF5 does while it writes."""
    try:
        import fcntl  # not on Windows

        with open(path, "rb") as file:
            fcntl.flock(file, fcntl.LOCK_SH | fcntl.LOCK_NB)
    except (ImportError, OSError) as error:
        return isinstance(error, BlockingIOError)
    return False


def flush(path: Path) -> None:
    """Flush a file, or the entries of a folder if the system can, to the disk (fsync)."""
    if path.is_dir():
        with suppress(OSError):  # of systems that cannot open folders
            folder = os.open(path, os.O_RDONLY)
            try:
                os.fsync(folder)
            finally:
                os.close(folder)
    else:
        with open(path, "rb+") as file:
            os.fsync(file.fileno())


def available_memory() -> float:
    """Memory that this process may use, in MB: all of the machine, or the limit of its control group."""
    import psutil

    limits = [path.read_text(encoding="ascii").strip() for path in map(Path, GROUP_LIMITS) if path.is_file()]
    machine = psutil.virtual_memory().total
    return min([machine, *(float(limit) for limit in limits if limit.isdigit())]) / 1e6


def is_compiled(*caches: str | os.PathLike[str]) -> bool:
    """True if numba has compiled something since the library was installed or edited.

    Parameters
    ----------
    *caches : path
        Further folders with machine code, besides the folders of the modules, where numba keeps it if it can.
    """
    package = Path(__file__).parents[1]
    code, modules = (
        max((path.stat().st_mtime for folder in folders for path in Path(folder).rglob(pattern)), default=0.0)
        for folders, pattern in (((package, *caches), "*.nbi"), ((package,), "*.py"))
    )
    return code > modules


def compile_in_parallel() -> None:
    """Compile the library in a process for each part; errors there are ignored."""
    given = os.environ | {COMPILING: "1", "PYTHONPATH": os.pathsep.join(filter(None, sys.path))}
    code = "from asperity.study.preflight_and_manifest import warm_up; warm_up({!r})"
    python = sys.executable
    if not Path(python).is_file():  # snakemake puts a path with blanks in quotes
        python = shlex.split(python)[0]
    parts = [
        subprocess.Popen(
            [python, "-c", code.format(part)],
            env=given,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
        )
        for part in COMPILED_PARTS
    ]
    for part in parts:
        part.wait()
