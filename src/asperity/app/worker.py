"""Processes that read maps, press them and compute planes of the stress, beside the server.

A worker is spawned, never forked, and is spoken to over a pipe. It leads a group of processes, those that
compute beside it, and ends with all of them when the pipe closes, as it does when the server ends.
"""

import gc
import os
import signal
import threading
from collections.abc import Callable
from contextlib import suppress
from multiprocessing import get_context
from multiprocessing.connection import Connection
from queue import Empty, SimpleQueue
from typing import Any

REPLACED = ("check", "plane", "section", "profile")
"""Requests of which only the newest is answered, and none about an answer that is given up."""

Reply = Callable[[str, Any], None]
"""Receives the name of a reply and its content, in the thread of the server."""


class Worker:
    """A process that answers requests, and its memory.

    Parameters
    ----------
    kind : str
        ``"reader"`` reads maps, cases and answers, ``"answer"`` computes an answer, and its planes.

    Attributes
    ----------
    stopped : bool
    looks : int
        Requests to take another answer that it has not followed yet: until then it replies about the last.
    """

    def __init__(self, kind: str) -> None:
        context = get_context("spawn")
        self._pipe, theirs = context.Pipe()
        self.stopped, self.looks = False, 0
        self.process = context.Process(target=_work, args=(theirs, kind), daemon=kind == "reader")
        self.process.start()
        theirs.close()

    def listen(self, reply: Reply) -> None:
        """Call a function in another thread with the name and content of each reply.

        When the process has ended, these are ``"ended"`` and its exit code.
        """
        threading.Thread(target=self._listen, args=(reply,), daemon=True).start()

    def send(self, request: str, **given: Any) -> None:
        """Ask for something; the reply comes later."""
        with suppress(OSError):  # it has ended; `reply` is called with "ended"
            self._pipe.send((request, given))

    def stop(self) -> None:
        """End the process, and those beside it, now."""
        self.stopped = True
        if self.process.is_alive():
            self.process.terminate()  # it may not lead its group yet
            self._end_group()

    def memory(self) -> int:
        """Bytes that the process uses, and those beside it."""
        import psutil

        used = 0
        with suppress(psutil.Error):
            process = psutil.Process(self.process.pid)
            for each in (process, *process.children(recursive=True)):
                used += each.memory_info().rss
        return used

    def _listen(self, reply: Reply) -> None:
        try:
            while True:
                reply(*self._pipe.recv())
        except (EOFError, OSError):
            self._end_group()
            self.process.join()
            reply("ended", self.process.exitcode)

    def _end_group(self) -> None:
        assert self.process.pid
        with suppress(ProcessLookupError):
            os.killpg(self.process.pid, signal.SIGKILL)


def _work(pipe: Connection, kind: str) -> None:
    """Answer requests until the pipe is closed; the main function of the process."""
    os.setpgid(0, 0)  # Ctrl-C does not reach the group; the server ends it
    os.environ["MPLBACKEND"] = "agg"
    requests: SimpleQueue[tuple[str, dict[str, Any]]] = SimpleQueue()
    threading.Thread(target=_receive, args=(pipe, requests), daemon=True).start()
    lock = threading.Lock()

    def reply(name: str, content: Any) -> None:
        with lock:
            pipe.send((name, content))

    gc.disable()  # an import makes no garbage, and the search for it takes a tenth of the time
    from asperity.app.answer_job import AnswerJob, Reader
    from asperity.core.errors import InputError

    gc.freeze()
    gc.enable()
    job: Any = (Reader if kind == "reader" else AnswerJob)(reply)
    waiting: list[tuple[str, dict[str, Any]]] = []
    is_idle = False
    while True:
        try:
            while True:
                waiting.append(requests.get(block=is_idle and not waiting))
        except Empty:
            pass
        if not waiting:
            is_idle = not job.work_ahead()
            continue
        is_idle = False
        name, given = waiting.pop(0)
        if name in REPLACED and any(later in (name, "look") for later, _ in waiting):
            continue
        if name == "section" and job.work_ahead():  # a section needs all planes: answer other requests first
            waiting.append((name, given))
            continue
        try:
            reply(name, getattr(job, name)(**given))
        except InputError as error:
            reply("refused", (name, error.lines, given))
        except Exception as error:  # whatever a request raises is reported, and the worker goes on
            reply("refused", (name, [str(error) or type(error).__name__], given))


def _receive(pipe: Connection, requests: SimpleQueue[Any]) -> None:
    """Put requests into a queue, and end the process when the pipe closes, even while it computes."""
    try:
        while True:
            requests.put(pipe.recv())
    except (EOFError, OSError):
        os.killpg(0, signal.SIGKILL)
