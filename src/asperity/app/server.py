"""The server of the page: on the loopback interface alone, under an address that holds a token."""

from __future__ import annotations

import json
import os
import secrets
import time
import zipfile
from collections.abc import Mapping
from contextlib import suppress
from pathlib import Path
from tempfile import TemporaryDirectory, TemporaryFile
from typing import IO, Any

from bokeh.server.server import BaseServer
from bokeh.server.tornado import BokehTornado
from bokeh.server.util import bind_sockets
from tornado.httpserver import HTTPServer
from tornado.httputil import HTTPServerRequest
from tornado.ioloop import IOLoop, PeriodicCallback
from tornado.web import ErrorHandler, OutputTransform, RequestHandler
from tornado.websocket import WebSocketClosedError, WebSocketHandler

from asperity.app import form
from asperity.app.session import TEMPLATES, Session
from asperity.app.worker import Worker
from asperity.engineering.folder import MANIFEST, names_in
from asperity.settings.materials import table

LOOPBACK = "127.0.0.1"

LARGEST_UPLOAD = 100 * 2**20
"""Bytes of a map that is dropped on the page; larger ones are named by their path."""

POLICY = (
    "default-src 'self'; script-src 'self' 'unsafe-inline' 'unsafe-eval'; style-src 'self' 'unsafe-inline'; "
    "img-src 'self' data: blob:; font-src 'self' data:; frame-ancestors 'none'; base-uri 'none'; "
    "form-action 'none'"
)
"""Content-Security-Policy of the page: everything comes from this server."""

REPORT_POLICY = "sandbox; default-src 'none'; img-src data:; style-src 'unsafe-inline'"
"""Policy of the report of an answer, which may be from someone else: no script runs in it."""

WATCHED_EVERY = 500
"""Milliseconds between two looks at computations and connections."""


class _Headers(OutputTransform):
    """Adds headers for safety to every response."""

    def transform_first_chunk(self, status_code: int, headers: Any, chunk: bytes, finishing: bool) -> Any:
        headers.setdefault("Content-Security-Policy", POLICY)
        headers["X-Content-Type-Options"] = "nosniff"
        headers["Referrer-Policy"] = "no-referrer"
        headers["Cross-Origin-Resource-Policy"] = "same-origin"
        return status_code, headers, chunk


class _Application(BokehTornado):
    """Answers only requests whose ``Host``, and ``Origin`` if they have one, name this server."""

    hosts: tuple[str, ...] = ()

    def find_handler(self, request: HTTPServerRequest, **kwargs: Any) -> Any:
        origin = request.headers.get("Origin")
        is_own = origin is None or origin in [f"http://{host}" for host in self.hosts]
        if request.headers.get("Host") not in self.hosts or not is_own:
            return self.get_handler_delegate(request, ErrorHandler, {"status_code": 403})
        return super().find_handler(request, **kwargs)


class _OfSession:
    """Gives a handler the session."""

    def initialize(self, session: Session) -> None:
        self.session = session


class _Events(_OfSession, WebSocketHandler):
    """Messages between a tab and the session."""

    def open(self, *_: str, **__: str) -> None:
        self.tell(self.session.state())
        self.session.sockets.add(self)

    def tell(self, message: Mapping[str, Any]) -> None:
        """Send a message, unless the tab is being closed."""
        with suppress(WebSocketClosedError):
            self.write_message(dict(message))

    def on_close(self) -> None:
        self.session.sockets.discard(self)
        self.session.last_seen = time.monotonic()

    def on_message(self, message: str | bytes) -> None:
        try:
            found = json.loads(message)
        except ValueError:
            return
        self.session.act(found, self)


class _Upload(_OfSession, RequestHandler):
    """Takes maps that are dropped on the page."""

    def post(self, key: str) -> None:
        paths = []
        for each in self.request.files.get("map", []):
            if len(each["body"]) > LARGEST_UPLOAD:
                self.send_error(413)
                return
            folder = self.session.folder / "maps" / secrets.token_hex(4)
            folder.mkdir(parents=True)
            path = folder / safe_name(each["filename"])
            path.write_bytes(each["body"])
            paths.append(str(path))
        self.session.act({"set": {key: "\n".join(paths)}} if paths else {})


class _Download(_OfSession, RequestHandler):
    """Sends everything that an answer holds as one zip, or its report."""

    async def get(self, number: str, name: str) -> None:
        slots = self.session.slots
        slot = slots[int(number)] if int(number) < len(slots) else None
        files = files_of(slot.folder) if slot is not None and slot.state == "shown" else {}
        report = files.get("sample.html") or files.get("report.html")
        if name == "report.html" and report is not None:
            self.set_header("Content-Type", "text/html; charset=utf-8")
            self.set_header("Content-Security-Policy", REPORT_POLICY)
            self.write(report.read_bytes())
        elif name == "all.zip" and files:
            self.set_header("Content-Type", "application/zip")
            self.set_header("Content-Disposition", f'attachment; filename="answer_{int(number) + 1}.zip"')
            with TemporaryFile() as packed:
                await IOLoop.current().run_in_executor(None, _pack, files, packed)
                while part := packed.read(2**20):
                    self.write(part)
                    await self.flush()
        else:
            self.send_error(404)


def _pack(files: Mapping[str, Path], packed: IO[bytes]) -> None:
    """Write a zip into a file, and go to the start of the file."""
    with zipfile.ZipFile(packed, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, path in files.items():
            archive.write(path, name)
    packed.seek(0)


def safe_name(name: str) -> str:
    """Name of a file without a folder, of letters, digits and a few signs."""
    last = name.replace("\\", "/").rpartition("/")[2]
    kept = "".join(sign if sign.isalnum() or sign in "._- ()" else "_" for sign in last).lstrip(".")
    return kept[-100:] or "map"


def files_of(folder: Path) -> dict[str, Path]:
    """Files that ``asperity run`` has written into a folder and its folders, none that lie elsewhere."""
    found = {}
    for place in (folder, *(each for each in sorted(folder.iterdir()) if each.is_dir())):
        for name in sorted({MANIFEST, *names_in(place)}):
            path = place / name
            if path.is_file() and path.resolve() == folder.resolve() / path.relative_to(folder):
                found[path.relative_to(folder).as_posix()] = path
    return found


def serve(
    path: str | None,
    flags: Mapping[str, str],
    reader: Worker,
    *,
    port: int = 0,
    out: str | None = None,
    stop_after: float | None = None,
    memory: float,
    show: bool = True,
) -> None:
    """Serve the page until Ctrl-C.

    Parameters
    ----------
    path : str or None
        A map, a case file, or the folder of an answer, with which the page opens.
    flags : mapping
        Dotted key of a setting → flag of ``asperity run``.
    reader : Worker
        The process that checks cases and reads maps.
    port : int
        0 for one that is free.
    out : str, optional
        Folder for answers and uploaded maps; by default one that is deleted at the end.
    stop_after : float, optional
        Seconds without a connection after which the server ends.
    memory : float
        Bytes that a computation may use.
    show : bool
        True to open the browser.

    Raises
    ------
    OSError
        If the port is in use.
    """
    os.environ["BOKEH_RESOURCES"] = "server"  # scripts come from this server, without a network
    sockets, port = bind_sockets(LOOPBACK, port)
    token = secrets.token_urlsafe(24)
    with TemporaryDirectory(prefix="asperity-app-", ignore_cleanup_errors=True) as temporary:
        loop = IOLoop.current()
        session = Session(loop, reader, flags, Path(out or temporary).absolute(), memory)
        template = TEMPLATES.get_template("page.html.j2")

        def fill(document: Any) -> None:
            document.template, document.title = template, "asperity"
            values = {"form": form, "materials": list(table()), "limit": LARGEST_UPLOAD}
            document.template_variables.update(values)
            session.add_tab(document)

        own = {"session": session}
        application = _Application(
            fill,
            prefix=token,
            extra_websocket_origins=[f"{name}:{port}" for name in (LOOPBACK, "localhost")],
            extra_patterns=[
                (r"/events", _Events, own),
                (r"/upload/([a-z_.]+)", _Upload, own),
                (r"/answer/([0-9]{1,4})/(report\.html|all\.zip)", _Download, own),
            ],
            transforms=[_Headers],
        )
        application.hosts = tuple(f"{name}:{port}" for name in (LOOPBACK, "localhost"))
        http = HTTPServer(application, max_buffer_size=LARGEST_UPLOAD + 2**20)
        http.add_sockets(sockets)
        server = BaseServer(loop, application, http)

        def watch() -> None:
            session.watch()
            if stop_after is not None and time.monotonic() - session.last_seen > stop_after:
                loop.stop()

        PeriodicCallback(watch, WATCHED_EVERY).start()
        if path is not None:
            session.do_open(path)
        address = f"http://{LOOPBACK}:{port}/{token}/"
        print(f"{address}\nCtrl-C ends it.", flush=True)
        if show:
            _open_browser(address)
        try:
            server.run_until_shutdown()
        finally:
            session.close()


def _open_browser(address: str) -> None:
    import webbrowser

    if not webbrowser.open(address):
        print("No browser was found; open the address in one.", flush=True)
