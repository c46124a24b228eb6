"""The page of a study: figures in order, tables, verdicts and costs, from one file without a network."""

import html.parser
import re

import pandas as pd
import pytest
from project import OWN, QUICK, snakemake


class Page(html.parser.HTMLParser):
    """What a page holds."""

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


def made(study, folder, *arguments):
    """The page of a finished study, made by its rule, whose log is deleted again."""
    (folder / "report.html").unlink(missing_ok=True)  # another test may have written Snakemake's report there
    found = snakemake(study.folder, "report_page", *arguments, cores=1)
    assert found.returncode == 0, found.stdout + found.stderr
    (folder / "log/report_page.log").unlink()
    page = Page((folder / "report.html").read_text(encoding="utf-8"))
    assert page.open == []
    return page


@pytest.fixture(scope="module")
def page(quick_study):
    return made(quick_study, quick_study.folder / "results/quick", *QUICK)


def test_figures_stand_in_order_with_captions(page, quick_study):
    numbered = [name for name in page.figures if re.fullmatch(r"fig\d+", name)]
    assert numbered == [f"fig{number:02}" for number in range(1, 19)]
    files = {path.stem for path in (quick_study.folder / "results/quick/figures").glob("*.png")}
    assert set(page.figures) == files
    assert page.figures[:18] == numbered
    assert page.text.count("<figcaption>") == len(page.figures)
    assert "system-message" not in page.text
    assert ":math:" not in page.text


def test_claims_stand_with_their_verdicts(page, quick_study):
    claims = pd.read_csv(quick_study.folder / "results/quick/claims.csv")
    assert page.text.count('<span class="verdict') == len(claims)
    for verdict, count in claims["verdict"].value_counts().items():
        assert re.search(rf"<dt>statements: {verdict}</dt><dd>{count}</dd>", page.text)


def test_every_part_has_its_heading(page):
    parts = {"claims", "validation", "verification", "cost"}
    assert {"Figures-of-the-paper", "Supplement", *parts} <= set(page.headings)
    assert page.text.count("<table") >= 6


def test_the_page_needs_the_results_alone(page, quick_study):
    assert len(page.all("src")) > 10
    assert all(source.startswith("data:image/png;base64,") for source in page.all("src"))
    results = quick_study.folder / "results/quick"
    for link in page.all("href", "a"):
        anchor = link.removeprefix("#")
        assert f'id="{anchor}"' in page.text if link.startswith("#") else (results / link).exists(), link


def test_an_own_study_has_a_page(own_study):
    folder = own_study.folder.parent / "own results"
    page = made(own_study, folder, *OWN, "--config", f"results={folder}")
    assert "claims" not in page.headings
    assert "Figures" in page.headings
    assert set(page.figures) == {path.stem for path in (folder / "figures").glob("*.png")}
