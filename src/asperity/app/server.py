"""The server of the page, on the loopback interface alone.

Its address works once: it sets a cookie, without which nothing is served.
"""

import json
import os
import re
import secrets
import shutil
import time
import zipfile
from collections.abc import Mapping
from contextlib import suppress
from pathlib import Path
from tempfile import TemporaryDirectory, TemporaryFile, gettempdir
from typing import IO, Any

from bokeh.server.server import BaseServer
from bokeh.server.tornado import BokehTornado
from bokeh.server.util import bind_sockets
from tornado.httpserver import HTTPServer
from tornado.httputil import HTTPServerRequest
from tornado.ioloop import IOLoop, PeriodicCallback
from tornado.web import OutputTransform, RequestHandler
from tornado.websocket import WebSocketClosedError, WebSocketHandler

from asperity.app import form
from asperity.app.session import TEMPLATES, Session
from asperity.app.worker import Worker
from asperity.core.errors import DatasetError, shown
from asperity.core.system import has_ended, process_name
from asperity.engineering.folder import MANIFEST, names_in, remove_unfinished
from asperity.settings.materials import table

LOOPBACK = "127.0.0.1"

COOKIE = "asperity"

TEMPORARY = "asperity-app-"
"""Prefix of the name of the temporary folder of a server, before the name of its process."""

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
    """Answers requests with its cookie, whose ``Host``, and ``Origin`` if there is one, name this server.

    Attributes
    ----------
    hosts : tuple of str
        Accepted names of this server, with their ports.
    cookie : str
    tokens : set of str
        Ends of addresses that have not been opened yet.
    """

    hosts: tuple[str, ...] = ()

    def __init__(self, *arguments: Any, **settings: Any) -> None:
        super().__init__(*arguments, **settings)
        self.cookie, self.tokens = secrets.token_urlsafe(24), set[str]()

    def address(self) -> str:
        """A new address of the page, which can be opened once."""
        token = secrets.token_urlsafe(16)
        self.tokens.add(token)
        return f"http://{self.hosts[0]}{self.prefix}/once-{token}"

    def find_handler(self, request: HTTPServerRequest, **kwargs: Any) -> Any:
        if reason := self._refusal(request):
            return self.get_handler_delegate(request, _Refused, {"reason": reason})
        return super().find_handler(request, **kwargs)

    def _refusal(self, request: HTTPServerRequest) -> str:
        """Reason why a request is not answered; empty if it is."""
        host, origin = request.headers.get("Host", ""), request.headers.get("Origin")
        if host not in self.hosts:
            own, name = " and ".join(self.hosts), shown(host)
            return f"asperity app answers {own}, not {name}: for a tunnel or proxy add --host-header {name}"
        if origin is not None and origin.partition("://")[2] not in self.hosts:
            return "asperity app answers no page of another server"
        cookie = request.cookies.get(COOKIE)
        is_known = cookie is not None and secrets.compare_digest(cookie.value, self.cookie)
        if is_known or request.path.rpartition("/once-")[2] in self.tokens:
            return ""
        return (
            "an address of asperity app can be opened once, in one browser: open the last one in its terminal"
        )


class _Refused(RequestHandler):
    """Says why a request is not answered."""

    def initialize(self, reason: str) -> None:
        self.reason = reason

    def prepare(self) -> None:
        self.set_status(403)
        self.set_header("Content-Type", "text/plain; charset=utf-8")
        self.finish(f"{self.reason}\n")


class _Once(RequestHandler):
    """Sets the cookie in the browser in which an address is opened, and goes on to the page."""

    def get(self, token: str) -> None:
        application: Any = self.application
        application.tokens.discard(token)
        self.set_cookie(COOKIE, application.cookie, path="", httponly=True, samesite="Lax")  # for this folder
        self.redirect("./")
        if not application.tokens:
            with suppress(OSError):  # nobody reads the output
                print(f"{application.address()}  for another browser", flush=True)


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
    """Takes a map that is dropped on the page, and replies with its path."""

    def put(self) -> None:
        folder = self.session.folder / "maps" / secrets.token_hex(4)
        folder.mkdir(parents=True)
        path = folder / safe_name(self.get_query_argument("name"))
        path.write_bytes(self.request.body)
        self.set_header("Content-Type", "text/plain; charset=utf-8")
        self.write(str(path))


class _Download(_OfSession, RequestHandler):
    """Sends everything that an answer holds as one zip, or a report in it."""

    async def get(self, number: str, name: str) -> None:
        slots = self.session.slots
        slot = slots[int(number)] if int(number) < len(slots) else None
        files = files_of(slot.folder) if slot and slot.folder and slot.state == "shown" else {}
        if (report := files.get(name)) is not None:
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
    with zipfile.ZipFile(packed, "w", compresslevel=1) as archive:
        for name, path in files.items():
            is_packed = path.suffix in (".nc", ".png", ".xlsx")  # by the formats themselves
            archive.write(path, name, zipfile.ZIP_STORED if is_packed else zipfile.ZIP_DEFLATED)
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
    host_header: str | None = None,
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
    host_header : str, optional
        A further name of this server, with its port, as a tunnel or a proxy gives it.

    Raises
    ------
    OSError
        If the port is in use.
    """
    os.environ["BOKEH_RESOURCES"] = "server"  # scripts come from this server, without a network
    sockets, port = bind_sockets(LOOPBACK, port)
    hosts = (f"{LOOPBACK}:{port}", f"localhost:{port}", *([host_header] if host_header else ()))
    _remove_abandoned(out)
    own = f"{TEMPORARY}{process_name()}-"
    with TemporaryDirectory(prefix=own, ignore_cleanup_errors=True) as temporary:
        loop = IOLoop.current()
        session = Session(loop, reader, flags, Path(out or temporary).absolute(), memory)
        template = TEMPLATES.get_template("page.html.j2")

        def fill(document: Any) -> None:
            document.template, document.title = template, "asperity"
            values = {"form": form, "materials": list(table()), "limit": LARGEST_UPLOAD}
            document.template_variables.update(values)
            session.add_tab(document)

        of_session = {"session": session}
        application = _Application(
            fill,
            prefix=secrets.token_urlsafe(16),
            extra_websocket_origins=hosts,
            extra_patterns=[
                (r"/once-([\w-]+)", _Once),
                (r"/events", _Events, of_session),
                (r"/upload", _Upload, of_session),
                (
                    r"/answer/([0-9]{1,4})/((?:[^/]+/)?report\.html|sample\.html|all\.zip)",
                    _Download,
                    of_session,
                ),
            ],
            transforms=[_Headers],
        )
        application.hosts = hosts
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
        print(f"{application.address()}\nCan be opened once. Ctrl-C ends the page.", flush=True)
        if show:
            _open_browser(application.address(), Path(temporary))
        try:
            server.run_until_shutdown()
        finally:
            session.close()


def _open_browser(address: str, folder: Path) -> None:
    """Open an address in the browser by a file of this user: arguments are seen by all users."""
    import webbrowser

    file = folder / "open.html"
    file.touch(0o600)
    file.write_text(f'<meta http-equiv="refresh" content="0; url={address}">', encoding="utf-8")
    if not webbrowser.open(file.as_uri()):
        print("No browser was found; open the address in one.", flush=True)


def _remove_abandoned(out: str | None) -> None:
    """Remove what servers that were killed have left: temporary folders, and answers without a file."""
    for folder in Path(gettempdir()).glob(f"{TEMPORARY}*"):
        found = re.fullmatch(rf"{TEMPORARY}([\w-]+\.\d+\.\d+)-\w+", folder.name)
        if found and has_ended(found[1]):
            shutil.rmtree(folder, ignore_errors=True)
    for folder in sorted(Path(out).glob("answer_*/**"), reverse=True) if out else ():
        with suppress(DatasetError, OSError):  # of a running process, or not empty
            remove_unfinished(folder)
            folder.rmdir()
