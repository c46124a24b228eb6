"""Times that a person waits for on the page, printed: ``pytest -s tests/browser/test_times.py``.

With ASPERITY_NODES=1024, as in `make bench`, on a map of so many points on an edge, and with the answer and
that of the command; without, until the map is treated, as `test_page` does the rest.
"""

import os
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
from running_app import App
from test_page import Page

sys.path.append(str(Path(__file__).parents[1] / "data"))
from foreign_files import write_x3p

import asperity as asp

NODES = int(os.environ.get("ASPERITY_NODES", "64"))
PIXEL = 5e-7

TREATED = "[...document.querySelectorAll('#info li')].some((each) => each.textContent.includes('{}'))"

COLOURS = """
const mapper = Bokeh.documents[0].roots().find((each) => each.name === "map_image").right[0].color_mapper;
return [mapper.low, mapper.high];
"""

CHOOSE = """
const field = document.getElementById("map.detrend");
field.value = "curvature";
field.dispatchEvent(new Event("input", { bubbles: true }));
"""


@pytest.fixture(scope="module")
def surface(tmp_path_factory):
    """A map of an instrument, with a bow and spikes, in nanometres."""
    edge = NODES * PIXEL
    height = asp.self_affine((NODES, NODES), 0.8, edge / 5, 4 * PIXEL, rms_height=2e-7, seed=1, length=edge)
    y, x = np.mgrid[:NODES, :NODES] / NODES - 0.5
    height += 1e-6 * (x**2 + y**2)
    height.flat[np.random.default_rng(1).integers(height.size, size=25)] += 8e-6
    path = tmp_path_factory.mktemp("map") / "seal.x3p"
    write_x3p(path, np.rint(1e9 * height).astype(int), type="I", increment="1e-9", pixel=f"{PIXEL:.9e}")
    return path


def test_times(chromium, surface, tmp_path, request):
    """Each step is waited for by what it shows; a minute each is the limit, as of a page that hangs."""
    times, since, is_measured = {}, time.monotonic(), "ASPERITY_NODES" in os.environ

    def passed(name):
        nonlocal since
        times[name] = time.monotonic() - since
        since = time.monotonic()

    app = App(tmp_path, "--out", "answers") if is_measured else request.getfixturevalue("app")
    try:
        passed("server start")
        page = Page(chromium, tmp_path)
        page.open(app.address)
        app.next_address()
        page.until("Bokeh.documents[0].is_idle")
        passed("open")
        page.drop(surface.read_bytes(), surface.name)
        page.until(f"document.getElementById('info').textContent.includes('{NODES} x {NODES}')")
        passed("upload to description")
        page.until("document.getElementById('doubt-map.despike').querySelector('button')")
        page.until("Bokeh.documents[0].roots()[0].renderers[0].data_source.data.image[0]")
        (low, high), shown = page.run(COLOURS), np.ptp(page.image("map_image")["values"])
        assert high - low < 0.7 * shown  # a few spikes do not take the colours
        since = time.monotonic()
        page.click("#doubt-map\\.despike button")
        assert page.run("return document.activeElement.id") == "map.despike"
        page.until(TREATED.format("spikes: "))
        passed("despike")
        assert page.run("return document.activeElement.id") == "map.despike"
        page.run(CHOOSE)
        page.until(TREATED.format("curvature of"))
        passed("level")
        page.until("Bokeh.documents[0].is_idle")
        heights = page.image("map_image")["values"]
        assert heights.shape == (NODES, NODES)
        if is_measured:
            page.type("body.material", "100Cr6")
            page.type("load.mean_pressure", "50 MPa")
            page.click("[data-key='choose.counter_body'][value='flat']")
            page.until("!document.getElementById('start').disabled")
            since = time.monotonic()
            page.answer()
            passed("compute")
            known = {*chromium.downloads.glob("*.zip")}
            page.run("document.querySelector('a[download]').click()")
            while not (found := {*chromium.downloads.glob("*.zip")} - known):
                time.sleep(0.05)
            passed(f"zip of {found.pop().stat().st_size / 1e6:.0f} MB")
            folder = next(tmp_path.glob("**/contact.nc")).parent
            for number in (2, 3):
                page.run("act('open', arguments[0])", str(folder))
                page.until(f"document.querySelectorAll('[data-do=show] option').length === {number}")
            page.run("act('beside', '0')")
            page.until("document.querySelector('article.both')")
            passed("open two answers")
            command = [sys.executable, "-m", "asperity", "run", "case.yaml", "--out", tmp_path / "by_command"]
            subprocess.run(command, cwd=folder, capture_output=True, check=True)
            passed("compute, by the command")
    finally:
        if is_measured:
            app.close()
    print("\n" + "\n".join(f"{name:<24}{value:6.2f} s" for name, value in times.items()))
