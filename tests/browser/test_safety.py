"""Attacks on the server of the page, and processes that must end."""

import http.client
import json
import os
import socket
import subprocess
import sys
import time
from importlib.resources import files
from pathlib import Path
from urllib.parse import quote

import psutil
import pytest
from running_app import App
from samples import status

from asperity.core.system import process_name

MAP = files("asperity.engineering") / "maps" / "ground_1.x3p"

UPGRADE = {
    "Connection": "Upgrade",
    "Upgrade": "websocket",
    "Sec-WebSocket-Version": "13",
    "Sec-WebSocket-Key": "AAAAAAAAAAAAAAAAAAAAAA==",
}


def ask(app, path="", method="GET", body=None, **headers):
    """Status, headers and content of the reply to one request with the cookie; the path is below the page."""
    headers = {"Cookie": app.cookie} | {name.replace("_", "-"): value for name, value in headers.items()}
    connection = http.client.HTTPConnection("127.0.0.1", app.port, timeout=20)
    connection.request(method, path if path.startswith("//") else app.path + path, body, headers)
    reply = connection.getresponse()
    content = b"" if reply.status == 101 else reply.read()
    connection.close()
    return reply.status, reply.headers, content


def upload(app, name, content, **headers):
    """Upload a file as the page does."""
    return ask(app, f"upload?name={quote(name)}", "PUT", content, **headers)


def test_only_this_computer_is_listened_to(app):
    listening = [
        each.laddr.ip
        for each in psutil.Process(app.process.pid).net_connections("inet")
        if each.status == psutil.CONN_LISTEN
    ]
    assert listening == ["127.0.0.1"]


def test_token_host_and_origin_are_needed(app):
    own = f"http://127.0.0.1:{app.port}"
    status, headers, _ = ask(app)
    assert status == 200
    assert "default-src 'self'" in headers["Content-Security-Policy"]
    for other in ("", "asperity=wrong"):
        status, _, content = ask(app, Cookie=other)
        assert (status, b"can be opened once" in content) == (403, True)
        assert ask(app, "events", Cookie=other, **UPGRADE)[0] == 403
        assert upload(app, "a.npy", b"1", Cookie=other)[0] == 403
    assert ask(app, "//")[0] == 404
    assert ask(app, "//events", **UPGRADE)[0] == 404
    assert ask(app, "//static/js/bokeh.min.js")[0] == 404
    status, _, content = ask(app, Host="evil.example")  # as after DNS rebinding
    assert (status, b"--host-header 'evil.example'" in content) == (403, True)
    for path, more in (("", {}), ("events", UPGRADE), ("ws", UPGRADE), ("answer/0/all.zip", {})):
        assert ask(app, path, Origin="http://evil.example", **more)[0] == 403
    assert upload(app, "a.npy", b"1", Origin="http://evil.example")[0] == 403
    assert ask(app, "events", Origin=own, **UPGRADE)[0] == 101


@pytest.mark.parametrize(
    "path",
    [
        "answer/0/../../../etc/passwd",
        "answer/0/%2e%2e%2fcase.yaml",
        "answer/99/all.zip",
        "answer/-1/all.zip",
        "static/../../../../etc/passwd",
        "static/%2e%2e/%2e%2e/server/server.py",
    ],
)
def test_no_other_file_is_served(app, path):
    assert ask(app, path)[0] in (403, 404)


def test_an_uploaded_file_stays_in_its_folder(app):
    status, _, path = upload(app, "../../../evil<b>.npy", b"not a map")
    assert (status, Path(path.decode()).read_bytes()) == (200, b"not a map")
    assert list(app.folder.rglob("evil*")) == [Path(path.decode())]
    assert Path(path.decode()).parents[1] == app.folder / "answers" / "maps"


def test_a_large_upload_is_refused(app):
    from asperity.app.server import LARGEST_UPLOAD

    with socket.create_connection(("127.0.0.1", app.port), timeout=20) as connection:
        head = (
            f"PUT {app.path}upload?name=a HTTP/1.1\r\nHost: 127.0.0.1:{app.port}\r\n"
            f"Cookie: {app.cookie}\r\nContent-Length: {2 * LARGEST_UPLOAD}\r\n\r\n"
        )
        connection.sendall(head.encode())
        assert b" 400 " in connection.recv(100)


def test_messages_of_another_form_are_ignored():
    from asperity.app.session import Session

    session = Session.__new__(Session)
    for message in (None, 3, [], {"do": "__init__"}, {"do": 5}, {"do": ["start"]}, {"set": ["a"]}):
        if not (isinstance(message, dict) and "set" in message):
            session.act(message)
    told = []
    session.set = lambda values, socket: told.append(values)
    session.act({"set": {"map.unit": "um", "out": "/etc", "map.points": 5, "__class__": "x"}})
    assert told == [{"map.unit": "um"}]


def test_an_answer_of_someone_else_reads_no_other_file(tmp_path):
    from asperity.app.server import files_of

    secret = tmp_path / "secret.txt"
    secret.write_text("secret")
    folder = tmp_path / "answer"
    folder.mkdir()
    (folder / "answer.csv").write_text("a")
    os.symlink(secret, folder / "peaks.csv")
    (folder / "other").symlink_to(tmp_path)
    names = ["answer.csv", "peaks.csv", "../secret.txt", str(secret), ".."]
    (folder / ".asperity-run.json").write_text(json.dumps(dict.fromkeys(names, "")))
    (tmp_path / ".asperity-run.json").write_text(json.dumps({"secret.txt": ""}))
    assert list(files_of(folder)) == [".asperity-run.json", "answer.csv"]


def test_an_address_is_opened_once(app):
    assert ask(app)[0] == 200
    address = app.address.rpartition("/")[2]
    assert [ask(app, address, Cookie="")[0] for _ in range(2)] == [302, 403]
    app.next_address()


def test_a_further_host_is_answered_if_it_is_named(app):
    status, _, content = ask(app, Host="localhost:9999", Origin="https://localhost:9999")
    assert (status, b"cdn.bokeh.org" in content) == (200, False)
    assert ask(app, "events", Host="localhost:9999", Origin="http://localhost:9999", **UPGRADE)[0] == 101
    assert ask(app, Host="localhost:9998")[0] == 403


def test_what_a_killed_server_left_is_removed_at_the_next_start(tmp_path):
    """No process is left; the next server ends by itself without a connection.

    The browser is started with a file that the user alone can read, and which holds the address.
    """
    (tmp_path / "browser").write_text(f'#!/bin/sh\nprintf "%s" "$*" > {tmp_path}/arguments\n')
    (tmp_path / "browser").chmod(0o755)
    app = App(tmp_path, MAP, TMPDIR=str(tmp_path), BROWSER=f"{tmp_path}/browser %s")
    end = time.monotonic() + 20
    while not ((tmp_path / "arguments").exists() and (tmp_path / "arguments").read_text()):
        assert time.monotonic() < end
        time.sleep(0.05)
    argument = (tmp_path / "arguments").read_text()
    file = Path(argument.removeprefix("file://"))
    assert app.address.split("/")[3] not in argument
    assert file.stat().st_mode & 0o777 == 0o600
    assert app.page in file.read_text()
    assert upload(app, "a.npy", b"1")[0] == 200
    children = psutil.Process(app.process.pid).children(recursive=True)
    assert children
    app.process.kill()
    app.process.wait(20)
    app.process.stdout.close()
    _, alive = psutil.wait_procs(children, timeout=20)
    assert not [each for each in alive if each.status() != psutil.STATUS_ZOMBIE]
    for name in ("asperity-app-of-someone", "answer_1/.unfinished-x", "answer_2/a/.unfinished-y", "answer_3"):
        (tmp_path / name).mkdir(parents=True)
    (tmp_path / "answer_3/report.html").touch()
    (left,) = [path.parents[2] for path in tmp_path.rglob("a.npy")]
    assert file.parent == left
    other = App(tmp_path, "--out", tmp_path, "--stop-after", "1 s", TMPDIR=str(tmp_path))
    assert not left.exists()
    assert other.process.wait(30) == 0
    other.process.stdout.close()
    assert [path.name for path in tmp_path.glob("answer_*")] == ["answer_3"]
    assert [path.name for path in tmp_path.glob("asperity-app-*")] == ["asperity-app-of-someone"]


def test_only_what_an_ended_computation_made_is_removed(tmp_path):
    from asperity.app.session import remove_made
    from asperity.engineering.folder import MANIFEST
    from asperity.results.atomic import LOCK

    folder = tmp_path / "answer_1"
    for place in (folder, folder / "a", folder / "b"):
        place.mkdir()
        (place / "answer.csv").write_text("")
        (place / MANIFEST).write_text(json.dumps({"answer.csv": ""}))
        (place / LOCK.format(f"{process_name().rpartition('.')[0]}.1.abcd")).touch()  # of an earlier process
        (place / ".unfinished-x").mkdir()
    (folder / "b" / "notes.txt").write_text("mine")
    remove_made(folder)
    assert [path.relative_to(folder).as_posix() for path in folder.rglob("*")] == ["b", "b/notes.txt"]


def test_wrong_arguments_are_refused_in_one_line(app, capsys):
    taken = [sys.executable, "-m", "asperity", "app", "--port", str(app.port)]
    said = subprocess.run(taken, capture_output=True, text=True).stderr
    assert said.startswith(f"asperity: --port {app.port}: cannot be used")
    assert status("app", "none.x3p")
    assert capsys.readouterr().err == "asperity: none.x3p: no such file or folder\n"
    assert status("app", "--stop-after", "soon")
    assert "--stop-after = 'soon': a time > 0" in capsys.readouterr().err
