"""The page in a real browser: a newcomer's way from a map to the largest stress, and what may go wrong."""

import base64
import os
import re
import shlex
import time
import zipfile
from importlib.resources import files
from pathlib import Path

import netCDF4
import numpy as np
import psutil
import pytest

import asperity as asp
from asperity.cli.main import main

MAPS = files("asperity.engineering") / "maps"
MAP = MAPS / "ground_1.x3p"

PICTURES = os.environ.get("ASPERITY_PICTURES") and Path(os.environ["ASPERITY_PICTURES"]).resolve()
"""Folder into which the pictures of docs/app.md are written: ASPERITY_PICTURES=docs pytest tests/browser."""

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
const words = { title: root.title.text, unit: root.right[0].title };
return { shape: image.shape, values: [...image], ...words, ...frame };
"""
"""The values of a picture, as the page draws them."""

POINT = """
const [name, column, row, number] = arguments;
const root = Bokeh.documents[0].roots().find((each) => each.name === name);
const view = Bokeh.index.find_one(root);
view.el.scrollIntoView({ block: "center" });
const data = root.renderers.find((each) => each.glyph.type === "Scatter").data_source.data;
const edge = view.el.getBoundingClientRect();
const [x, y] = [view.frame.x_scale.v_compute(data[column]), view.frame.y_scale.v_compute(data[row])];
const away = (other) => Math.hypot(x[other] - x[number], y[other] - y[number]);
const near = Math.min(...[...x.keys()].filter((other) => other !== number).map(away));
return [edge.left + x[number], edge.top + y[number], near];
"""
"""Place of a peak in the window, and the distance of the nearest other one, in pixels."""

UNTIL = """
const [seconds, done] = arguments;
const end = Date.now() + 1000 * seconds;
const look = () => {
  try {
    const found = CONDITION;
    if (found || Date.now() > end) done([found, ""]);
    else setTimeout(look, 20);
  } catch (error) {
    done([null, String(error)]);
  }
};
look();
"""
"""Waits in the page itself: to ask it again and again takes more time than to answer."""

TALLEST = 1500

TITLE = "Bokeh.documents[0].roots().find((each) => each.name === 'plane').title.text"


class Page:
    """The page as its reader uses it."""

    def __init__(self, chromium, pictures):
        self.chromium, self.pictures = chromium, pictures

    def open(self, address):
        self.chromium.get(address)
        self.until("Bokeh.documents.length && Bokeh.documents[0].roots().length === 12")
        self.until("socket.readyState === 1")

    def run(self, script, *arguments):
        return self.chromium.execute_script(script, *arguments)

    def until(self, condition, seconds=60):
        for _ in range(0, seconds, 20):  # the driver itself waits for half a minute
            found, error = self.chromium.execute_async_script(UNTIL.replace("CONDITION", condition), 20)
            assert not error, f"{condition}: {error}"
            if found:
                return
        raise AssertionError(f"{condition}: not within {seconds} s; {self.text('notice')}")

    def text(self, name):
        return self.run("return document.getElementById(arguments[0]).textContent.trim()", name)

    def value(self, key):
        return self.run("return document.getElementById(arguments[0]).value", key)

    def type(self, key, text):
        """Type into a field as a user does, in place of its text."""
        self.run(
            "const field = document.getElementById(arguments[0]);"
            "field.closest('details')?.setAttribute('open', ''); field.focus(); field.select();"
            "document.execCommand(arguments[1] ? 'insertText' : 'delete', false, arguments[1]);",
            *(key, text),
        )

    def click(self, selector):
        self.run("document.querySelector(arguments[0]).click()", selector)

    def image(self, name):
        found = self.run(IMAGE, name)
        return found | {"values": np.reshape(np.array(found["values"], dtype=float), found["shape"])}

    def drop(self, content, name):
        self.run(DROP, base64.b64encode(content).decode(), name)

    def start(self):
        self.until("!document.getElementById('start').disabled")
        self.click("#start")

    def answers(self):
        return self.run("return document.querySelectorAll('[data-do=show] option').length")

    def answer(self):
        """Compute, and wait until the answer is shown with its plane."""
        known = self.answers()
        self.start()
        self.until(f"document.querySelectorAll('[data-do=show] option').length > {known}", seconds=200)
        self.until(f"{TITLE}.includes('at depth')")

    def picture(self, name, width, part, for_docs=True):
        """Save a part of the page as it looks in a window of some width; at most `TALLEST` pixels of it."""
        size = {"width": width, "height": 1000, "deviceScaleFactor": 1, "mobile": width < 500}
        self.chromium.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", size)
        self.chromium.execute_async_script(  # pictures follow the window
            "const wait = (done, left) => left ? requestAnimationFrame(() => wait(done, left - 1)) : done();"
            "wait(arguments[0], 10)"
        )
        self.until("Bokeh.documents[0].is_idle")
        box = self.run(
            "const box = document.querySelector(arguments[0]).getBoundingClientRect();"
            "const { width, height } = box;"
            "return { x: box.x + scrollX, y: box.y + scrollY, width, height, scale: 1 };",
            part,
        )
        wide = self.run("return document.documentElement.scrollWidth")
        shot = {"clip": box | {"height": min(box["height"], TALLEST)}, "captureBeyondViewport": True}
        found = self.chromium.execute_cdp_cmd("Page.captureScreenshot", shot)
        folder = PICTURES if PICTURES and for_docs else self.pictures
        (folder / f"{name}.png").write_bytes(base64.b64decode(found["data"]))
        self.chromium.execute_cdp_cmd("Emulation.clearDeviceMetricsOverride", {})
        assert wide <= width, f"the page is {wide} pixels wide in a window of {width}"

    def keys(self, *keys):
        """Press keys where the focus is."""
        self.chromium.switch_to.active_element.send_keys(*keys)

    def tab_to(self, selector):
        """Press the tabulator key until an element has the focus, which must be seen."""
        from selenium.webdriver.common.action_chains import ActionChains
        from selenium.webdriver.common.keys import Keys

        for _ in range(150):
            if self.run("return document.activeElement.matches(arguments[0])", selector):
                return
            ActionChains(self.chromium).send_keys(Keys.TAB).perform()
            outline = "getComputedStyle(document.activeElement.closest('.button') ?? document.activeElement)"
            # Bokeh marks the buttons of its pictures itself.
            inner = "document.activeElement.shadowRoot || document.activeElement === document.body"
            seen = self.run(f"return Boolean({inner} || {outline}.outlineStyle !== 'none')")
            assert seen, self.run("return document.activeElement.outerHTML")
        raise AssertionError(f"{selector}: not reached by the tabulator key")

    def press(self, x, y):
        """Click at a place of the window."""
        from selenium.webdriver.common.actions.action_builder import ActionBuilder

        actions = ActionBuilder(self.chromium)
        actions.pointer_action.move_to_location(round(x), round(y)).click()
        actions.perform()


def newest_answer(app):
    """Folder of the answer that was computed last."""
    return max(app.folder.glob("answers/answer_*"), key=os.path.getmtime)


@pytest.fixture(scope="module")
def page(chromium, app, tmp_path_factory):
    found = Page(chromium, tmp_path_factory.mktemp("pictures"))
    found.open(app.address)
    app.next_address()
    return found


@pytest.fixture
def example(page):
    """The page with the example map, ready to compute."""
    page.run("document.getElementById('body.material').value = ''")  # until the server has answered
    page.click("[data-do=example]")
    page.until("document.getElementById('body.material').value === '100Cr6'")
    page.until("!document.getElementById('start').disabled")
    return page


def test_from_a_dropped_map_to_the_largest_stress(page, app):
    assert "What happens here" in page.run("return document.querySelector('.empty-only').innerText")
    page.drop(MAP.read_bytes(), "ground <img src=x onerror=alert(1)>.x3p")
    page.until("document.getElementById('info').textContent.includes('96 x 128')")
    page.until("document.getElementById('ready').textContent.includes('the material of the body')")
    page.type("body.material", "100Cr6")
    page.type("load.mean_pressure", "50 MPa")
    page.until("document.querySelectorAll('#ready li').length === 1")
    assert "the kind of the counter body" in page.text("ready")
    page.click("[data-key='choose.counter_body'][value='flat']")
    page.answer()
    page.click("#peaks input")
    page.until("document.querySelector('#peaks tr.marked')")
    stress = netCDF4.Dataset(newest_answer(app) / "stress.nc")
    is_mises = stress["peak_quantity"][:] == "von_mises"
    largest = int(np.argmax(np.where(is_mises, stress["peak_value"][:], 0)))
    value, depth, x, y = (float(stress[f"peak_{name}"][largest]) for name in ("value", "depth", "x", "y"))
    page.until(f"{TITLE}.includes('{1e6 * depth:.3g} µm')")
    plane = page.image("plane")
    rows, columns = plane["shape"]
    row = int((1e6 * y - plane["y"]) / plane["dh"] * rows)
    column = int((1e6 * x - plane["x"]) / plane["dw"] * columns)
    # The peak lies up to half a pixel beside the node that is drawn.
    assert plane["unit"] == "GPa"
    assert plane["values"][row, column] == pytest.approx(1e-9 * value, rel=0.03)
    assert plane["values"].max() == plane["values"][row, column]
    assert page.run("return document.querySelectorAll('img[onerror]').length") == 0
    origins = page.run(
        "return performance.getEntriesByType('resource').map((each) => new URL(each.name).host)"
    )
    assert set(origins) <= {f"127.0.0.1:{app.port}"}


def test_slider_and_dragged_line(page):
    from selenium.webdriver.common.actions.action_builder import ActionBuilder

    before, title = page.image("plane"), page.run(f"return {TITLE}")
    page.run(
        "const slider = document.getElementById('depth'); slider.value = 12;"
        "slider.dispatchEvent(new Event('input', { bubbles: true }));"
    )
    page.until(f"{TITLE} !== {title!r}")
    assert page.image("plane")["values"].max() < before["values"].max()
    wide = page.image("section")["dw"]
    page.run(
        "document.querySelector('[aria-label^=\"Stress in a plane\"]').scrollIntoView({ block: 'center' })"
    )
    box = page.run(
        "return document.querySelector('[aria-label^=\"Stress in a plane\"]').getBoundingClientRect()"
    )
    actions = ActionBuilder(page.chromium)
    x, y = int(box["x"] + box["width"] / 2), int(box["y"] + box["height"] / 2)
    actions.pointer_action.move_to_location(x - 60, y).pointer_down()
    actions.pointer_action.move_to_location(x, y).move_to_location(x + 60, y + 20).pointer_up()
    actions.perform()
    section = (
        "Bokeh.documents[0].roots().find((each) => each.name === 'section').renderers[0].data_source.data"
    )
    page.until(f"{section}.dw[0] < {0.7 * wide}")
    assert page.image("section")["values"].max() > 0


def test_a_wrong_unit_is_refused_in_the_words_of_the_command(example, capsys):
    example.type("load.mean_pressure", "50")
    example.until("document.getElementById('wrong-load.mean_pressure').textContent")
    with pytest.raises(SystemExit):
        main(["run", str(MAP), "--material", "100Cr6", "--mean-pressure", "50", "--check"])
    assert example.text("wrong-load.mean_pressure") in capsys.readouterr().err
    assert example.run("return document.getElementById('start').disabled")
    example.type("load.mean_pressure", "50 GPa")  # above the hardness
    example.until("document.getElementById('ready').textContent.includes('hardness')")
    assert example.value("load.mean_pressure") == "50 GPa"


def test_a_map_without_a_unit_asks_for_it_at_the_field(example, tmp_path):
    path = tmp_path / "<img src=x onerror=alert(1)>.npy"
    np.save(path, np.random.default_rng(1).normal(size=(48, 32)))
    example.type("map.file", str(path))
    example.until("document.getElementById('ready').textContent.includes('map, unit')")
    assert "map, physical size" in example.text("ready")
    example.type("map.unit", "nm")
    example.type("map.physical_size", "48 um, 32 um")
    example.until("!document.getElementById('start').disabled")
    example.until("Bokeh.documents[0].roots()[0].renderers[0].data_source.data.image[0].shape[0] === 48")
    assert example.run("return document.querySelectorAll('img[onerror]').length") == 0
    example.type("map.unit", "")
    example.type("map.physical_size", "")


def test_stop_and_kill_keep_the_inputs(example, app):
    example.type("map.points", "1536")
    workers = psutil.Process(app.process.pid).children
    for end, words in (("stop", "Stopped."), ("kill", "was killed")):
        known = {each.pid for each in workers()}
        example.until("!document.getElementById('start').disabled")
        example.run("document.getElementById('start').focus()")
        example.start()
        example.until("document.body.dataset.running === 'true'")
        (started,) = [each for each in workers() if each.pid not in known]
        example.until("document.getElementById('progress').value > 0")
        assert example.run("return document.activeElement.id") == "start"
        if end == "stop":
            example.click("#stop")
        else:
            started.kill()
        example.until(f"document.getElementById('progress-text').textContent.includes('{words}')")
        assert not psutil.pid_exists(started.pid) or started.status() == "zombie"
        assert example.value("map.points") == "1536"
    example.type("map.points", "")


def test_a_second_map_is_laid_on(example):
    example.click("[data-key='choose.counter_body'][value='elastic map']")
    example.until("document.querySelectorAll('#ready li').length === 2")
    assert "the material of the counter body" in example.text("ready")
    assert "the map of the counter body" in example.text("ready")
    assert example.run("return document.getElementById('start').disabled")
    assert example.text("case").endswith("material: null\n  map: {}")
    example.click("[data-key='choose.counter_body'][value='rigid map']")
    example.type("counter_body.map.file", str(MAPS / "ground_2.x3p"))
    example.type("counter_body.map.shift", "10 um, -4 um")
    example.until("document.getElementById('info').textContent.includes('counter map')")
    assert "--counter-map" in example.text("command")
    assert "ground_2" in example.text("command")
    example.click("[data-key='choose.counter_body'][value='flat']")
    example.until("!document.getElementById('info').textContent.includes('counter map')")


def test_command_and_case_file_give_the_same_numbers(example, app, tmp_path, monkeypatch, without_pictures):
    example.click("[data-key='use.sliding']")
    example.type("sliding.friction", "0.1")
    example.until("document.getElementById('command').textContent.includes('--friction 0.1')")
    example.answer()
    folder = newest_answer(app)
    monkeypatch.chdir(tmp_path)
    (tmp_path / "case.yaml").write_text(example.text("case"), encoding="utf-8")
    words = shlex.split(example.text("command"))[1:]
    for arguments in ([*words, "--out", "by_command"], ["run", "case.yaml", "--out", "by_case"]):
        assert main(arguments) == 0
        out = tmp_path / arguments[-1]
        assert (out / "answer.csv").read_bytes() == (folder / "answer.csv").read_bytes()
        assert (out / "peaks.csv").read_bytes() == (folder / "peaks.csv").read_bytes()
        found, there = (netCDF4.Dataset(each / "contact.nc")["pressure"][:] for each in (out, folder))
        assert np.array_equal(found, there)
    example.click("[data-key='use.sliding']")
    example.click("#peaks input")
    example.until("document.querySelector('#peaks tr.marked')")
    example.picture("app_answer", 1280, "#pictures")
    example.picture("app_phone_answer", 390, "#answer-step", for_docs=False)


@pytest.mark.parametrize(
    ("picture", "column", "row"), [("plane", "x", "y"), ("scatter", "value", "depth"), ("contact", "x", "y")]
)
def test_a_peak_clicked_in_a_picture_is_marked_everywhere(page, picture, column, row):
    places = [page.run(POINT, picture, column, row, number) for number in range(12)]
    number = max(range(12), key=lambda each: places[each][2])
    x, y, _ = page.run(POINT, picture, column, row, number)
    page.press(x, y)
    page.until(f"document.querySelector('#peaks tr.marked input')?.value === '{number}'")
    selected = (
        "Bokeh.documents[0].roots().filter((each) => ['plane', 'scatter', 'contact'].includes(each.name))"
        ".map((each) => each.renderers.find((one) => one.glyph.type === 'Scatter').data_source"
        ".selected.indices.join())"
    )
    page.until(f"{selected}.every((each) => each === '{number}')")
    depth = page.run("return document.querySelector('#peaks tr.marked').cells[2].textContent").split()[0]
    page.until(f"Math.abs({TITLE}.split(' ').at(-2) / {depth} - 1) < 0.005")


def test_everything_by_the_keyboard_alone(page, app):
    from selenium.webdriver.common.keys import Keys

    page.open(app.page)
    page.tab_to("[data-do=example]")
    page.keys(Keys.ENTER)
    page.until("document.getElementById('body.material').value === '100Cr6'")
    page.tab_to("[data-line=profile]")
    page.keys("0 um, 0 um, 20 um, 30 um", Keys.ENTER)
    line = "Bokeh.documents[0].roots().find((each) => each.name === 'map_profile').renderers[0].data_source"
    page.until(f"Math.abs({line}.data.x.at(-1) - Math.hypot(20, 30)) < 0.1")
    page.tab_to("[id='load.mean_pressure']")
    page.keys(Keys.CONTROL, "a")
    page.keys("40 MPa")
    known = page.answers()
    page.until("document.getElementById('command').textContent.includes('40 MPa')")
    page.until("!document.getElementById('start').disabled")
    page.tab_to("#start")
    page.keys(Keys.ENTER)
    page.until(f"document.querySelectorAll('[data-do=show] option').length > {known}", seconds=200)
    page.until(f"{TITLE}.includes('at depth')")
    page.until("document.activeElement.id === 'answer'")
    assert abs(page.run("return document.getElementById('answer').getBoundingClientRect().top")) < 200
    page.tab_to("#depth")
    title = page.run(f"return {TITLE}")
    page.keys(Keys.ARROW_RIGHT, Keys.ARROW_RIGHT)
    page.until(f"{TITLE} !== {title!r}")
    page.tab_to("#peaks input")
    page.keys(Keys.SPACE)
    page.until("document.querySelector('#peaks tr.marked')")
    page.keys(Keys.ARROW_DOWN)
    page.until("document.querySelector('#peaks tr.marked input')?.value === '1'")


def test_download_and_open_later(page):
    page.run("document.querySelector('a[download]').click()")
    end = time.monotonic() + 20
    while not (found := list(page.chromium.downloads.glob("*.zip"))) and time.monotonic() < end:
        time.sleep(0.1)
    folder = page.chromium.downloads / "opened <b>later"
    with zipfile.ZipFile(found[0]) as archive:
        assert {"report.html", "contact.nc", "case.yaml", ".asperity-run.json"} <= set(archive.namelist())
        archive.extractall(folder)
    number = page.answers() + 1
    tiles = page.run("return document.querySelector('.headline').innerText")
    page.run("act('open', arguments[0])", str(folder))
    page.until(f"document.querySelectorAll('[data-do=show] option').length === {number}")
    assert page.run("return document.querySelector('.headline').innerText") == tiles
    names = page.run(
        "return [...document.querySelectorAll('[data-do=show] option')].map((each) => each.text)"
    )
    assert re.fullmatch(r"\d+: ground_1, mean pressure 40 MPa", names[-1])
    page.run("act('beside', '0')")
    page.until("document.querySelector('article.both')")
    assert page.run("return document.querySelectorAll('article.answer').length") == 3
    verdict = page.run("return document.querySelector('.both .verdict').textContent")
    assert "one map" in verdict
    for name in ("50 MPa", "40 MPa"):
        assert name in verdict
    page.until(
        "Bokeh.documents[0].roots().find((each) => each.name === 'plane_beside').title.text.includes('depth')"
    )
    own = "Bokeh.documents[0].roots().find((each) => each.name === '{}').{}_range"
    for axis in "xy":  # one object, not two with the same ends
        assert page.run(
            "return " + " === ".join(own.format(name, axis) for name in ("scatter", "scatter_beside"))
        )
    page.picture("app_beside", 1280, "#answer-step", for_docs=False)
    page.run("act('beside', '')")
    page.until("document.querySelectorAll('article.answer').length === 1")


def test_a_sample_is_shown_before_its_maps(example, app):
    """The verdict and the tiles are those of the sample, and each map is behind it."""
    known = example.answers()
    example.type("map.file", "\n".join([str(MAP), str(MAP)]))
    example.until("document.getElementById('ready').textContent.includes('different names')")
    example.type("map.file", "\n".join(str(MAPS / f"ground_{number}.x3p") for number in (1, 3)))
    example.until("document.getElementById('ready').textContent.includes('positions of one surface')")
    example.click("[data-key='choose.maps'][value='pooled']")
    example.until("document.getElementById('command').textContent.includes('--pooled')")
    example.start()
    example.until(f"document.querySelectorAll('[data-do=show] option').length > {known}", seconds=200)
    example.until("document.querySelector('article.answer h3').textContent.includes('2 maps of one surface')")
    sample = asp.open_answer(newest_answer(app))
    article = example.run("return document.querySelector('article.answer').innerText")
    assert sample.verdict[0] in article
    assert sample.tiles[0].number() in article
    assert "not known" not in example.run("return document.querySelector('.headline').innerText")
    example.run(
        "document.querySelectorAll('article.answer > details').forEach((each) => { each.open = true; })"
    )
    article = example.run("return document.querySelector('article.answer').innerText")
    for name, answer in sample.answers.items():
        assert f"Map {name}" in article
        assert answer.tiles[0].number() in article
    before = example.image("contact")["values"]
    example.run("act('view', 'map=ground_3')")
    example.until("document.querySelector('option[value=\"map=ground_3\"]').selected")
    end = time.monotonic() + 20
    while np.array_equal(example.image("contact")["values"], before, equal_nan=True):
        assert time.monotonic() < end
    pressure = np.nanmax(example.image("contact")["values"])
    assert pressure == pytest.approx(1e-9 * sample.answers["ground_3"].contact.pressure.max(), rel=1e-5)
    example.picture("app_sample", 1280, "#answer-step", for_docs=False)
    example.picture("app_phone_sample", 390, "#answer-step", for_docs=False)
    example.type("map.file", str(MAP))


def test_different_surfaces_are_compared(example, tmp_path):
    """Each has its answer; the second is shown beside the first, with numbers and differences of both."""
    rough = asp.read_map(MAP)
    np.save(tmp_path / "rough.npy", 3 * rough.height[:24, :24])
    np.save(tmp_path / "smooth.npy", rough.height[:24, :24])
    known = example.answers()
    example.type("map.unit", "m")
    example.type("map.physical_size", "37.5 um, 37.5 um")
    example.click("[data-key='choose.maps'][value='pooled']")
    example.type("map.file", "\n".join(str(tmp_path / f"{name}.npy") for name in ("rough", "smooth")))
    example.until("document.getElementById('doubt-map.file').textContent.includes('Sq')")
    example.click("[data-key='choose.maps'][value='compared']")
    example.until("!document.getElementById('command').textContent.includes('--pooled')")
    example.until("!document.getElementById('doubt-map.file').textContent")
    example.start()
    example.until("document.querySelector('article.both')", seconds=200)
    assert example.answers() == known + 2
    rows = example.run(
        "return [...document.querySelectorAll('.both tr')]"
        ".map((row) => [...row.cells].map((each) => each.textContent))"
    )
    first, second = (int(name.partition(":")[0]) for name in rows[0][1:3])
    chosen = "[...document.querySelectorAll('[data-do={}] option')].find((each) => each.selected).text"
    for number, name in ((first, "show"), (second, "beside")):
        assert example.run(f"return {chosen.format(name)}").startswith(f"{number}: ")
    assert first < second
    assert rows[0][1:3] == [f"{first}: rough", f"{second}: smooth"]  # the load is the same
    deepest = "Bokeh.documents[0].roots().find((each) => each.name === '{}').y_range.start"
    one, other = map(deepest.format, ("section", "section_beside"))
    example.until(f"{one} > 0 && {one} === {other}")
    (heights,) = [row[1:] for row in rows if row[0] == "Sq"]
    assert float(heights[0].split()[0]) == pytest.approx(3 * float(heights[1].split()[0]), rel=0.01)
    assert heights[2].startswith("-")
    assert all(row[3] for row in rows)
    assert not example.text("stale")
    example.run("act('show', arguments[0])", str(second - 1))  # the one that is beside
    example.until("!document.querySelector('article.both')")
    assert example.run("return document.querySelectorAll('article.answer').length") == 1
    example.type("map.unit", "")
    example.type("map.physical_size", "")
    example.type("map.file", str(MAP))


def test_changed_inputs_and_another_load(example):
    example.type("load.mean_pressure", "55 MPa")
    example.until("document.getElementById('stale').textContent.includes('Out of date')")
    example.click("[data-key='use.leak']")
    example.type("leak.viscosity", "much")
    example.until("document.getElementById('wrong-leak.viscosity').textContent")
    example.click("[data-key='use.leak']")
    example.until("!document.getElementById('wrong-leak.viscosity').textContent")
    example.click("[data-key='choose.load'][value='hertz']")
    example.until("document.getElementById('load.mean_pressure').value === ''")
    example.click("[data-key='choose.load'][value='mean_pressure']")
    example.type("load.mean_pressure", "50 MPa")
    example.until("!document.getElementById('start').disabled")


def test_tabs_and_reload_show_the_same_work(example, app):
    first = example.chromium.current_window_handle
    example.chromium.switch_to.new_window("tab")
    example.open(app.page)
    example.until("document.getElementById('body.material').value === '100Cr6'")
    example.until("document.querySelector('article.answer')")
    example.type("load.mean_pressure", "60 MPa")
    example.chromium.switch_to.window(first)
    example.until("document.getElementById('load.mean_pressure').value === '60 MPa'")
    example.open(app.page)
    example.until("document.getElementById('load.mean_pressure').value === '60 MPa'")
    example.until("document.querySelector('article.answer')")


def test_looks(example, app):
    (app.folder / "ground_1.x3p").write_bytes(MAP.read_bytes())
    example.type("map.file", "ground_1.x3p")
    example.until("document.querySelector('#info td').textContent === 'ground_1.x3p'")
    example.until("Bokeh.documents[0].is_idle")
    example.picture("app_map", 1280, "#map-step")
    example.picture("app_phone", 390, "#map-step")
    example.chromium.execute_cdp_cmd(
        "Emulation.setEmulatedMedia", {"features": [{"name": "prefers-color-scheme", "value": "dark"}]}
    )
    example.picture("app_dark", 1280, "#load-step")
    back = example.run("return getComputedStyle(document.body).backgroundColor")
    assert max(map(int, re.findall(r"\d+", back))) < 60
    unnamed = example.run(
        "return [...document.querySelectorAll('input, select, textarea, button')].filter((each) =>"
        "!each.labels?.length && !each.textContent.trim() && !each.ariaLabel).length"
    )
    assert unnamed == 0
