"""The page of a study: figures in order, tables, verdicts and costs, from one file without a network."""

import html.parser
import re

import pandas as pd
import pytest


class Page(html.parser.HTMLParser):
    """Content of a page."""

    def __init__(self, text):
        super().__init__()
        self.text, self.open, self.found = text, [], []
        self.feed(text)
        self.figures, self.headings = self.all("id", "figure"), self.all("id", "h2")

    def handle_starttag(self, tag, attrs):
        self.found += [(tag, *attribute) for attribute in attrs]
        if tag not in ("img", "meta", "br", "link"):
            self.open.append(tag)

    def handle_endtag(self, tag):
        assert self.open.pop() == tag

    def all(self, name, *tags):
        """Values of an attribute of some tags, by default of all."""
        return [value for tag, key, value in self.found if key == name and tag in (tags or (tag,))]


def page_in(folder):
    """The page in a folder of results."""
    page = Page((folder / "report.html").read_text(encoding="utf-8"))
    assert page.open == []
    return page


@pytest.fixture(scope="module")
def page(quick_study):
    return page_in(quick_study.results)


def test_figures_stand_in_order_with_captions(page, quick_study):
    numbered = [name for name in page.figures if re.fullmatch(r"fig\d+", name)]
    assert numbered == [f"fig{number:02}" for number in range(1, 19)]
    files = {path.stem for path in (quick_study.results / "figures").glob("*.png")}
    assert set(page.figures) == files
    assert page.figures[:18] == numbered
    assert page.text.count("<figcaption>") == len(page.figures)
    assert "system-message" not in page.text
    assert ":math:" not in page.text


def test_claims_stand_with_their_verdicts(page, quick_study):
    claims = pd.read_csv(quick_study.results / "claims.csv")
    assert page.text.count('<span class="verdict') == len(claims)
    for verdict, count in claims["verdict"].value_counts().items():
        assert re.search(rf"<dt>statements: {verdict}</dt><dd>{count}</dd>", page.text)


def test_the_page_needs_the_results_alone(page, quick_study):
    assert len(page.all("src")) > 10
    assert all(source.startswith("data:image/png;base64,") for source in page.all("src"))
    results = quick_study.results
    for link in page.all("href", "a"):
        anchor = link.removeprefix("#")
        assert f'id="{anchor}"' in page.text if link.startswith("#") else (results / link).exists(), link
