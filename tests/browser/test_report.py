"""The report in a real browser: values under the pointer, sorted tables, the depth slider, and its print."""

import base64
import re

import numpy as np
import pytest

import asperity as asp

EDGE, NODES, NAME = 2e-4, 128, "<img src=x onerror=alert(1)>"

UNDER_POINTER = """
const [selector, u, v] = arguments;
const shown = document.querySelector(selector);
const edge = shown.getBoundingClientRect();
const place = { clientX: edge.left + u * edge.width, clientY: edge.top + v * edge.height };
shown.dispatchEvent(new PointerEvent("pointermove", place));
"""

COLUMN = """
const rows = [...document.querySelector(".scroll table").rows].slice(1);
return rows.map((row) => row.cells[1].innerText);
"""


@pytest.fixture(scope="module")
def answer():
    height = asp.self_affine((NODES, NODES), 0.8, 1e-4, 1e-5, rms_height=1e-7, seed=1, length=EDGE)
    surface = asp.HeightMap(height, (EDGE, EDGE), periodic=True, unit="m", name=NAME)
    steel = asp.Body(young="210 GPa", poisson=0.3, yield_stress="1 GPa")
    return asp.run(surface, steel, mean_pressure="50 MPa")


@pytest.fixture(scope="module")
def page(chromium, answer, tmp_path_factory):
    folder = tmp_path_factory.mktemp("report")
    asp.write_answer(answer, folder)
    chromium.get_log("browser")  # messages of other pages are read away
    chromium.get((folder / "report.html").as_uri())
    return chromium


def text_at(page, *place):
    """Values that the page shows for a pointer at a place of an element."""
    page.execute_script(UNDER_POINTER, *place)
    page.execute_async_script(  # what is unpacked, and shown in the next frame
        "requestAnimationFrame(() => requestAnimationFrame(arguments[0]))"
    )
    return page.execute_script(
        "const it = document.querySelector('.read'); return it.hidden ? '' : it.textContent"
    )


def test_the_value_under_the_pointer_is_that_of_the_map(page, answer):
    image = "img[alt^='Contact pressure']"
    script = f'return JSON.parse(document.querySelector("{image} + script").textContent)[0].box'
    left, top, right, bottom = page.execute_script(script)
    row, column = np.unravel_index(answer.contact.pressure.argmax(), (NODES, NODES))
    u = left + (column + 0.5) / NODES * (right - left)
    v = bottom - (row + 0.5) / NODES * (bottom - top)
    found = re.fullmatch(
        r"contact pressure (\S+) MPa at x (\S+) µm, y (\S+) µm", text_at(page, image, u, v)
    ).groups()
    expected = answer.contact.max_pressure / 1e6, column * EDGE / NODES * 1e6, row * EDGE / NODES * 1e6
    np.testing.assert_allclose(np.array(found, float), expected, rtol=6e-3, atol=0.1)
    assert text_at(page, image, 0.001, 0.001) == ""


def test_tables_sort_by_click_and_by_keyboard(page):
    from selenium.webdriver.common.keys import Keys

    original = page.execute_script(COLUMN)
    heading = page.find_elements("css selector", ".scroll th button")[1]
    page.execute_script("arguments[0].click()", heading)
    rising = page.execute_script(COLUMN)
    assert sorted(rising) == sorted(original)
    areas = [float(text.split()[0]) for text in rising]  # all in µm²
    assert areas == sorted(areas)
    assert page.execute_script("return arguments[0].parentNode.ariaSort", heading) == "ascending"
    heading.send_keys(Keys.ENTER)
    assert page.execute_script(COLUMN) == rising[::-1]
    assert page.execute_script("return document.querySelectorAll('[aria-sort]').length") == 1


def test_numbers_sort_in_their_units(page):
    texts = ["2 MPa", "800 kPa", "1.5 ± 0.1 GPa", "3 µm²", "1 mm²", "infinite", "x"]
    found = page.execute_script("return arguments[0].map((text) => numberIn(text) ?? 'none')", texts)
    assert found[:5] == pytest.approx([2e6, 8e5, 1.5e9, 3e-12, 1e-6])
    assert page.execute_script("return numberIn('infinite') === Infinity && numberIn('x') === null")


def test_the_slider_moves_the_plane_to_the_largest_stress(page, answer):
    part = answer.bodies["lower"]
    depths = [depth for depth, _ in part.depth_planes]
    number = int(np.argmax([np.abs(values).max() for _, values in part.depth_planes]))
    assert part.planes["von_mises"][0] == pytest.approx(depths[number])
    page.execute_script(
        "const input = document.querySelector('.depths input'); input.value = arguments[0];"
        "input.dispatchEvent(new Event('input'))",
        number,
    )
    values = part.depth_planes[number][1]
    assert values.shape == (NODES, NODES)
    row, column = np.unravel_index(values.argmax(), values.shape)
    text = text_at(page, ".depths canvas", (column + 0.5) / NODES, 1 - (row + 0.5) / NODES)
    assert float(re.match(r"von Mises stress (\S+) MPa", text)[1]) == pytest.approx(
        values.max() / 1e6, rel=6e-3
    )
    assert values.max() == pytest.approx(part.largest_von_mises, rel=0.1)


def test_print_and_looks(page):
    printed = base64.b64decode(page.execute_cdp_cmd("Page.printToPDF", {})["data"])
    assert 0 < len(re.findall(rb"/Type\s*/Page\b(?!s)", printed)) <= 6
    for width in (1280, 390):
        size = {"width": width, "height": 1000, "deviceScaleFactor": 1, "mobile": False}
        page.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", size)
        assert page.execute_script("return document.documentElement.scrollWidth") <= width
    page.execute_cdp_cmd("Emulation.clearDeviceMetricsOverride", {})
    dark = {"features": [{"name": "prefers-color-scheme", "value": "dark"}]}
    page.execute_cdp_cmd("Emulation.setEmulatedMedia", dark)
    back = page.execute_script("return getComputedStyle(document.body).backgroundColor")
    assert max(map(int, re.findall(r"\d+", back))) < 60
    page.execute_cdp_cmd("Emulation.setEmulatedMedia", {"features": []})
    assert page.execute_script("return document.querySelector('h1').textContent") == NAME
    assert not page.get_log("browser")
