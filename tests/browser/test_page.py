"""The page in a real browser: a newcomer's way from a map to the largest stress, and what may go wrong."""

import base64
import json
import re
import time
import zipfile
from importlib.resources import files

import numpy as np
import pandas as pd
import pytest

MAP = files("asperity.engineering") / "maps" / "ground_1.x3p"

DROP = """
const bytes = Uint8Array.from(atob(arguments[0]), (sign) => sign.charCodeAt(0));
const data = new DataTransfer();
data.items.add(new File([bytes], arguments[1]));
document.dispatchEvent(new DragEvent("drop", { dataTransfer: data, bubbles: true, cancelable: true }));
"""

IMAGE = """
const root = Bokeh.documents[0].roots().find((each) => each.name === arguments[0]);
const drawn = root.renderers.find((each) => each.glyph.type === "Image").data_source.data;
const image = drawn.image[0];
if (!image) return null;
const frame = { x: drawn.x[0], y: drawn.y[0], dw: drawn.dw[0], dh: drawn.dh[0] };
return { shape: image.shape, values: [...image], title: root.title.text, unit: root.right[0].title, ...frame };
"""
"""The values of a picture, as the page draws them."""

TITLE = "Bokeh.documents[0].roots().find((each) => each.name === 'plane').title.text"


class Page:
    """The page as its reader uses it."""

    def __init__(self, chromium):
        self.chromium = chromium

    def open(self, address):
        self.chromium.get(address)
        self.until("Bokeh.documents.length && Bokeh.documents[0].roots().length === 12")
        self.until("socket.readyState === 1")

    def run(self, script, *arguments):
        return self.chromium.execute_script(script, *arguments)

    def until(self, condition, seconds=40):
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            if found := self.run(f"return {condition}"):
                return found
            time.sleep(0.05)
        raise AssertionError(f"{condition}: not within {seconds} s; {self.text('notice')}")

    def text(self, name):
        return self.run("return document.getElementById(arguments[0]).textContent.trim()", name)

    def type(self, key, text):
        """Type into a field as a user does, in place of its text."""
        self.run(
            "const field = document.getElementById(arguments[0]); field.focus(); field.select();"
            "document.execCommand(arguments[1] ? 'insertText' : 'delete', false, arguments[1]);",
            *(key, text),
        )

    def click(self, selector):
        self.run("document.querySelector(arguments[0]).click()", selector)

    def image(self, name):
        found = self.run(IMAGE, name)
        return found | {"values": np.reshape(found["values"], found["shape"])}

    def drop(self, content, name):
        self.run(DROP, base64.b64encode(content).decode(), name)

    def answer(self, number):
        """Compute, and wait until answer `number` is shown."""
        self.until("!document.getElementById('start').disabled")
        self.click("#start")
        self.until(f"document.querySelector('article[aria-label=\"Answer {number}\"]')")


@pytest.fixture(scope="module")
def page(chromium, app):
    found = Page(chromium)
    found.open(app.address)
    return found


def test_from_a_dropped_map_to_the_largest_stress(page):
    assert "What happens here" in page.run("return document.querySelector('.empty-only').innerText")
    page.drop(MAP.read_bytes(), "ground <img src=x onerror=alert(1)>.x3p")
    page.until("document.body.classList.contains('has-map')")
    assert page.image("map_image")["values"].shape == (96, 128)
    assert "96 x 128" in page.text("info")
    page.type("body.material", "100Cr6")
    page.type("load.mean_pressure", "50 MPa")
    page.answer(1)
    page.until("document.getElementById('peaks').textContent.includes('GPa')")
    page.click("#peaks input")
    page.until("document.querySelector('#peaks tr.marked')")
    peak, unit, depth = re.search(r"1\s*([\d.]+) (GPa)([\d.]+) µm", page.text("peaks")).groups()
    page.until(TITLE + f".includes('{depth[:3]}')")
    plane = page.image("plane")
    assert plane["unit"] == unit
    # The peak lies between nodes, and its plane is that of the interpolated maximum.
    assert plane["values"].max() == pytest.approx(float(peak), rel=0.02)
