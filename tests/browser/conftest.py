"""A server of the page in a process of its own, and headless Chromium without a network."""

import os
import shutil
from importlib.util import find_spec

import pytest
from running_app import App

CHROMIUM = next(filter(None, map(shutil.which, ("chromium", "google-chrome"))), None)
DRIVER = shutil.which("chromedriver")
MISSING = [
    *(name for name in ("bokeh", "selenium") if find_spec(name) is None),
    *(["chromium"] if CHROMIUM is None else []),
    *(["chromedriver"] if DRIVER is None else []),
]


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(items):
    """Skip with one line where the browser or a package is missing; one process runs all of these tests.

    With ASPERITY_BROWSER=needed, as in CI, the tests fail there instead.
    """
    for item in items:
        if "browser" in item.path.parts:
            item.add_marker("browser")
            item.add_marker(pytest.mark.xdist_group("browser"))
            if MISSING and os.environ.get("ASPERITY_BROWSER") != "needed":
                item.add_marker(pytest.mark.skip(reason=f"not installed: {', '.join(MISSING)}"))


@pytest.fixture(scope="session")
def app(tmp_path_factory):
    """Started with variables of Bokeh, none of which may reach the page; nothing temporary is left."""
    folder = tmp_path_factory.mktemp("app")
    given = {"BOKEH_SIGN_SESSIONS": "yes", "BOKEH_LOG_LEVEL": "nonsense", "BOKEH_RESOURCES": "cdn"}
    found = App(folder, "--out", "answers", "--host-header", "localhost:9999", TMPDIR=str(folder), **given)
    yield found
    found.close()
    assert not [*folder.glob("asperity-app-*")]


@pytest.fixture(scope="session")
def chromium(tmp_path_factory):
    """Headless Chromium in which no name of a network but this computer's is known."""
    from selenium import webdriver

    assert not MISSING, f"not installed: {', '.join(MISSING)}"
    options = webdriver.ChromeOptions()
    options.binary_location = CHROMIUM
    downloads = tmp_path_factory.mktemp("downloads")
    for argument in (
        "--headless=new",
        "--no-sandbox" if os.name == "posix" and os.geteuid() == 0 else "--mute-audio",
        "--disable-dev-shm-usage",
        "--host-resolver-rules=MAP * ~NOTFOUND, EXCLUDE 127.0.0.1",
        "--window-size=1280,1000",
        "--hide-scrollbars",
    ):
        options.add_argument(argument)
    options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
    options.add_experimental_option("prefs", {"download.default_directory": str(downloads)})
    driver = webdriver.Chrome(options, webdriver.ChromeService(DRIVER))
    driver.downloads = downloads
    yield driver
    driver.quit()
