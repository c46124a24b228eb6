"""The report in a real browser: first screen, folded parts, dark colours, narrow screens and print."""

import base64
import re

import pytest

import asperity as asp

EDGE, NODES, NAME = 2e-4, 128, "<img src=x onerror=alert(1)>"


@pytest.fixture(scope="module")
def page(chromium, tmp_path_factory):
    height = asp.self_affine((NODES, NODES), 0.8, 1e-4, 1e-5, rms_height=1e-7, seed=1, length=EDGE)
    surface = asp.HeightMap(height, (EDGE, EDGE), periodic=True, unit="m", name=NAME)
    steel = asp.Body(young="210 GPa", poisson=0.3, yield_stress="1 GPa")
    folder = tmp_path_factory.mktemp("report")
    asp.run(surface, steel, mean_pressure="50 MPa").write(folder)
    chromium.get_log("browser")  # messages of other pages are read away
    chromium.get((folder / "report.html").as_uri())
    return chromium


def show(page, width, height=900):
    size = {"width": width, "height": height, "deviceScaleFactor": 1, "mobile": False}
    page.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", size)


def test_first_screen(page):
    """Verdict, tiles, uncertainties, picture and warnings, before anything that is folded."""
    show(page, 1280)
    bottom = "return document.querySelector(arguments[0]).getBoundingClientRect().bottom"
    for each in (".verdict", ".headline", ".uncertain", ".top figure img"):
        assert page.execute_script(bottom, each) <= 900, each
    lines = "return [...document.querySelectorAll('.warning summary')].map((each) => each.offsetHeight)"
    assert max(page.execute_script(lines), default=0) < 40  # one line each
    warns = "return [...document.querySelectorAll('details.warning')].pop()?.getBoundingClientRect().bottom"
    assert (page.execute_script(warns) or 0) <= 900
    assert page.execute_script("return document.querySelectorAll('.uncertain li').length") <= 3
    folded = "return document.querySelector('.tables').checkVisibility({contentVisibilityAuto: true})"
    assert not page.execute_script(folded)
    page.find_element("xpath", "//summary[h2='All numbers']").click()
    assert page.execute_script(folded)
    page.execute_cdp_cmd("Emulation.clearDeviceMetricsOverride", {})


def test_print_and_looks(page):
    printed = base64.b64decode(page.execute_cdp_cmd("Page.printToPDF", {})["data"])
    assert 2 <= len(re.findall(rb"/Type\s*/Page\b(?!s)", printed)) <= 6
    for width in (1280, 390):
        show(page, width)
        assert page.execute_script("return document.documentElement.scrollWidth") <= width
    page.execute_cdp_cmd("Emulation.clearDeviceMetricsOverride", {})
    dark = {"features": [{"name": "prefers-color-scheme", "value": "dark"}]}
    page.execute_cdp_cmd("Emulation.setEmulatedMedia", dark)
    back = page.execute_script("return getComputedStyle(document.body).backgroundColor")
    assert max(map(int, re.findall(r"\d+", back))) < 60
    page.execute_cdp_cmd("Emulation.setEmulatedMedia", {"features": []})
    assert page.execute_script("return document.querySelector('h1').textContent") == NAME
    assert not page.get_log("browser")
