"""Attacks on the server of the page, and processes that must end."""

import http.client
import json
import os
import signal
import socket
import subprocess
import sys
from importlib.resources import files

import psutil
import pytest
from running_app import App

MAP = files("asperity.engineering") / "maps" / "ground_1.x3p"

UPGRADE = {
    "Connection": "Upgrade",
    "Upgrade": "websocket",
    "Sec-WebSocket-Version": "13",
    "Sec-WebSocket-Key": "AAAAAAAAAAAAAAAAAAAAAA==",
}


def ask(app, path="", method="GET", body=None, **headers):
    """Status, headers and content of the reply to one request; the path is below the path of the token."""
    connection = http.client.HTTPConnection("127.0.0.1", app.port, timeout=20)
    token = app.address.rsplit("/", 2)[1]
    headers = {name.replace("_", "-"): value for name, value in headers.items()}
    connection.request(method, path if path.startswith("//") else f"/{token}/{path}", body, headers)
    reply = connection.getresponse()
    content = b"" if reply.status == 101 else reply.read()
    connection.close()
    return reply.status, reply.headers, content


def upload(app, name, content, key="map.file", **headers):
    """Upload a file as the page does."""
    body = (
        f'--x\r\nContent-Disposition: form-data; name="map"; filename="{name}"\r\n\r\n'.encode()
        + content
        + b"\r\n--x--\r\n"
    )
    return ask(app, f"upload/{key}", "POST", body, Content_Type="multipart/form-data; boundary=x", **headers)


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
    assert ask(app, "//")[0] == 404
    assert ask(app, "//events", **UPGRADE)[0] == 404
    assert ask(app, "//static/js/bokeh.min.js")[0] == 404
    assert ask(app, Host="evil.example")[0] == 403  # as after DNS rebinding
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
    assert upload(app, "../../../evil<b>.npy", b"not a map")[0] == 200
    assert [path.name for path in app.folder.rglob("evil*")] == ["evil_b_.npy"]
    assert not list(app.folder.glob("evil*"))
    # A key that is no setting is ignored.
    assert upload(app, "a.npy", b"1", key="out")[0] == 200


def test_a_large_upload_is_refused(app):
    from asperity.app.server import LARGEST_UPLOAD

    with socket.create_connection(("127.0.0.1", app.port), timeout=20) as connection:
        token = app.address.rsplit("/", 2)[1]
        head = (
            f"POST /{token}/upload/map.file HTTP/1.1\r\nHost: 127.0.0.1:{app.port}\r\n"
            f"Content-Type: multipart/form-data; boundary=x\r\nContent-Length: {2 * LARGEST_UPLOAD}\r\n\r\n"
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


def test_no_process_is_left_when_the_server_is_killed(tmp_path):
    app = App(tmp_path, MAP)
    children = psutil.Process(app.process.pid).children(recursive=True)
    assert children
    app.process.send_signal(signal.SIGKILL)
    app.process.wait(20)
    _, alive = psutil.wait_procs(children, timeout=20)
    assert not [each for each in alive if each.status() != psutil.STATUS_ZOMBIE]
    app.process.stdout.close()


def test_it_ends_by_itself_without_a_connection(tmp_path):
    app = App(tmp_path, "--stop-after", "1 s")
    assert app.process.wait(30) == 0
    app.process.stdout.close()


def test_wrong_arguments_are_refused_in_one_line(app, tmp_path):
    def line(*arguments):
        found = subprocess.run(
            [sys.executable, "-m", "asperity", "app", *arguments],
            capture_output=True,
            text=True,
            cwd=tmp_path,
        )
        assert found.returncode
        return found.stderr

    assert line("--port", str(app.port)).startswith(f"asperity: --port {app.port}: cannot be used")
    assert line("none.x3p") == "asperity: none.x3p: no such file or folder\n"
    assert "--stop-after = 'soon': a time > 0" in line("--stop-after", "soon")
