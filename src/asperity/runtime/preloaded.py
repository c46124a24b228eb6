"""A process that has imported the library, and of which the jobs of a study are copies.

To import the library takes half a second, longer than most jobs calculate. The main process of a study
therefore starts one *preloaded process*. Every job sends it the path of its script; the preloaded process
makes a copy of itself (fork), and the copy runs the script. The job waits, and ends as the copy ends; if the
job is ended, so is the copy.

Jobs run their scripts themselves where there is no preloaded process: on a cluster, on systems other than
Linux, or if it could not start. The preloaded process ends with the main process, and accepts jobs of its own
user only.
"""

from __future__ import annotations

import atexit
import gc
import json
import os
import runpy
import select
import signal
import socket
import struct
import subprocess
import sys
import threading
import traceback
from collections.abc import Iterable
from contextlib import suppress
from importlib import import_module
from typing import NoReturn

from asperity.runtime.interrupts import status_after

ADDRESS = "ASPERITY_PRELOADED"
"""Environment variable with the address of the preloaded process, in hexadecimal digits."""

_STREAMS = (1, 2)
"""Standard output and error of a job, which its copy takes over."""

_BEGUN = b"b"
"""What a copy sends when it has taken a job over."""

_ONE_THREAD = dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"), "1")
"""Environment that keeps imported libraries from starting threads, which a copy would not have."""


def start(modules: Iterable[str]) -> subprocess.Popen[bytes] | None:
    """Start a preloaded process for the jobs of this process, and return it.

    None if it cannot start, as on other systems than Linux.

    Parameters
    ----------
    modules : iterable of str
        Modules that it imports. Those that cannot be imported are left to the jobs, which say so.
    """
    if sys.platform != "linux":
        return None
    try:
        with socket.socket(socket.AF_UNIX) as listening:
            listening.bind("")  # Linux chooses an address that is not a file
            listening.listen()
            process = subprocess.Popen(
                [sys.executable, "-P", "-m", __name__, str(listening.fileno()), *modules],
                stdin=subprocess.PIPE,
                pass_fds=[listening.fileno()],
                env={**os.environ, **_ONE_THREAD},
            )
            os.environ[ADDRESS] = listening.getsockname().hex()
    except OSError:
        return None
    atexit.register(process.communicate)  # closes its input, at which it ends
    return process


def run_in_copy() -> None:
    """Run the script of this process in a copy of the preloaded process, and end as the copy ends.

    Does nothing without a preloaded process, and in a copy.
    """
    if ADDRESS not in os.environ:
        return
    job = {"script": sys.argv[0], "folder": os.getcwd(), "environment": dict(os.environ)}
    with socket.socket(socket.AF_UNIX) as connection:
        try:
            connection.connect(bytes.fromhex(os.environ[ADDRESS]))
            socket.send_fds(connection, [b"\n"], _STREAMS)
            connection.sendall(json.dumps(job).encode() + b"\n")
            begun = connection.recv(1) == _BEGUN
        except OSError:
            begun = False
        if begun:
            status = connection.recv(1)
            os._exit(status[0] if status else status_after(signal.SIGKILL))


def main() -> None:
    """Import modules, and copy this process for every job until the main process ends."""
    number, *modules = sys.argv[1:]
    for module in modules:
        with suppress(Exception):
            import_module(module)
    gc.freeze()  # the memory of what is imported stays shared with the copies
    signal.signal(signal.SIGCHLD, signal.SIG_IGN)  # copies that have ended leave no trace
    with socket.socket(fileno=int(number)) as listening:
        while listening in select.select([sys.stdin, listening], [], [])[0]:
            connection, _ = listening.accept()
            with connection:
                if _user_of(connection) == os.getuid() and os.fork() == 0:
                    listening.close()
                    _run_job(connection)


def _user_of(connection: socket.socket) -> int:
    """Number of the user whose process has connected."""
    credentials = struct.Struct("3i")  # process, user, group
    found = connection.getsockopt(socket.SOL_SOCKET, socket.SO_PEERCRED, credentials.size)
    return credentials.unpack(found)[1]


def _run_job(connection: socket.socket) -> NoReturn:
    """Run the script of a job in this copy, and end the copy and the job."""
    status = 1
    try:
        signal.signal(signal.SIGCHLD, signal.SIG_DFL)
        _, streams, *_ = socket.recv_fds(connection, 1, len(_STREAMS))
        with connection.makefile("rb") as lines:
            job = json.loads(lines.readline())
        for stream, taken in zip((0, *_STREAMS), (os.open(os.devnull, os.O_RDONLY), *streams), strict=True):
            os.dup2(taken, stream)
            os.close(taken)
        os.chdir(job["folder"])
        os.environ.clear()
        os.environ.update(job["environment"])
        del os.environ[ADDRESS]
        connection.sendall(_BEGUN)
        threading.Thread(target=_end_with_job, args=(connection,), daemon=True).start()
        sys.argv = [job["script"]]
        status = _status_of(job["script"])
    finally:
        sys.stdout.flush()
        sys.stderr.flush()
        with suppress(OSError):
            connection.sendall(bytes([status]))
        os._exit(status)


def _end_with_job(connection: socket.socket) -> None:
    """Wait until the job has ended, and end this copy if it still runs."""
    with suppress(OSError):
        connection.recv(1)
    os.kill(os.getpid(), signal.SIGTERM)


def _status_of(script: str) -> int:
    """Run a script, and return the exit status that a process of its own would have."""
    try:
        runpy.run_path(script, run_name="__main__")
    except SystemExit as end:
        if end.code is None or isinstance(end.code, int):
            return (end.code or 0) & 0xFF
        print(end.code, file=sys.stderr)
        return 1
    except BaseException:
        traceback.print_exc()
        return 1
    return 0


if __name__ == "__main__":
    main()
