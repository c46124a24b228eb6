"""The report: one page that needs no network, opens without errors, and shows every picture and table."""

import base64
import contextlib
import json
import re
import shutil
import socket
import subprocess
import time
import urllib.request

import pytest
from project import QUICK, snakemake

DRIVER = shutil.which("chromedriver")
BROWSER = shutil.which("chromium") or shutil.which("google-chrome")

OPTIONS = {
    "goog:loggingPrefs": {"browser": "ALL"},
    "goog:chromeOptions": {
        "binary": BROWSER,
        "args": [
            "--headless=new",
            "--no-sandbox",
            "--disable-dev-shm-usage",
            "--window-size=1400,1000",
            # Nothing outside the page can be reached.
            "--host-resolver-rules=MAP * ~NOTFOUND, EXCLUDE localhost",
        ],
    },
}


@pytest.fixture(scope="module")
def report(quick_study):
    """The report of the quick study."""
    path = quick_study.folder / "results/quick/report.html"
    found = snakemake(quick_study.folder, *QUICK, "--report", str(path))
    assert found.returncode == 0, found.stdout + found.stderr
    return path


class Session:
    """A page in a headless browser, by the W3C's WebDriver protocol."""

    def __init__(self, port):
        self._root = f"http://localhost:{port}/session"
        found = self._ask(self._root, {"capabilities": {"alwaysMatch": OPTIONS}})
        self._root += f"/{found['sessionId']}"

    def _ask(self, url, stress):
        request = urllib.request.Request(
            url, json.dumps(stress).encode(), {"Content-Type": "application/json"}
        )
        with urllib.request.urlopen(request, timeout=120) as answer:
            return json.load(answer)["value"]

    def open(self, path):
        self._ask(f"{self._root}/url", {"url": path.as_uri()})

    def run(self, script):
        """What a script returns, given the function `done` to call."""
        return self._ask(
            f"{self._root}/execute/async", {"script": f"const done = arguments[0]; {script}", "args": []}
        )

    def quit(self):
        request = urllib.request.Request(self._root, method="DELETE")
        urllib.request.urlopen(request, timeout=60).close()

    def log(self):
        return self._ask(f"{self._root}/se/log", {"type": "browser"})


@pytest.fixture(scope="module")
def page(report):
    """The report, open in the browser."""
    if DRIVER is None or BROWSER is None:
        pytest.skip("no chromium with chromedriver on this machine")
    with socket.socket() as free:
        free.bind(("localhost", 0))
        port = free.getsockname()[1]
    with subprocess.Popen([DRIVER, f"--port={port}"], stdout=subprocess.DEVNULL) as driver:
        try:
            wait_for(port)
            session = Session(port)
            session.open(report)
            yield session
            session.quit()
        finally:
            driver.terminate()


def wait_for(port, seconds=60):
    """Until somebody listens."""
    ends = time.monotonic() + seconds
    while time.monotonic() < ends:
        with contextlib.suppress(OSError), socket.create_connection(("localhost", port), timeout=1):
            return
        time.sleep(0.1)
    raise TimeoutError(f"nobody listens at port {port}")


def results_of(report):
    """What the page holds: path → name, categories, picture or file."""
    text = report.read_text()
    return json.loads(re.search(r"var results = (\{.*?\});\n", text, re.DOTALL)[1])


def test_every_picture_and_table_of_the_study_is_in_the_page(report):
    held = {path.rsplit("/", 1)[-1] for path in results_of(report)}
    figures = {path.name for path in (report.parent / "figures").glob("*.png")}
    tables = {path.name for path in (report.parent / "verification").glob("*.html")}
    assert len(figures) > 15
    assert held >= figures | tables | {"claims.png", "claims.html"}


def test_figures_of_the_paper_are_listed_in_their_order(report):
    labels = [result["labels"] for result in results_of(report).values() if result["labels"]]
    numbers = sorted(label["figure"] for label in labels if label.get("figure", "")[:1].isdigit())
    assert len(set(numbers)) > 10
    assert numbers == sorted(numbers, key=int)


def test_nothing_is_fetched_from_elsewhere(report):
    text = report.read_text()
    assert not re.findall(r"<(?:script|link|img|iframe)[^>]*\s(?:src|href)=[\"']?(?:https?:)?//", text)


def test_the_page_opens_without_an_error(page):
    assert page.run("done(document.querySelector('#app').innerText.length)") > 100
    assert [entry["message"] for entry in page.log() if entry["level"] == "SEVERE"] == []


def test_every_picture_is_shown_when_it_is_chosen(page):
    shown = page.run("""
        const pictures = Object.entries(results).filter(([_, r]) => r.mime_type.startsWith("image/"));
        const sizes = {};
        (async () => {
            for (const [path, result] of pictures) {
                app.setView({content: "img", contentPath: result.data_uri, resultPath: path});
                const wait = Date.now() + 5000;
                let image = null;
                while (Date.now() < wait) {
                    await new Promise(resolve => setTimeout(resolve, 20));
                    image = [...document.querySelectorAll("#app img")].find(i => i.src === result.data_uri);
                    if (image && image.complete && image.naturalWidth) break;
                }
                const box = image ? image.getBoundingClientRect() : {width: 0};
                sizes[path] = image ? [image.naturalWidth, box.width] : [0, 0];
            }
            done(sizes);
        })();
    """)
    assert len(shown) > 15
    assert {path: size for path, size in shown.items() if size[0] < 500 or size[1] < 100} == {}
    assert [entry["message"] for entry in page.log() if entry["level"] == "SEVERE"] == []


def test_every_result_has_a_caption(report):
    for path, result in results_of(report).items():
        assert result["caption"].strip(), path


def test_claims_in_the_page_are_those_of_the_study(report):
    (table,) = (r for path, r in results_of(report).items() if path.endswith("claims.html"))
    assert table["mime_type"] == "text/html"  # shown as a page
    assert "Statements of the paper" in table["caption"]
    content = base64.b64decode(table["data_uri"].split(",", 1)[1])
    assert content == (report.parent / "claims.html").read_bytes()
