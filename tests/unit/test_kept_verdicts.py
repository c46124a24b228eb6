"""README.md, docs/claims.md and docs/ensemble.md agree with the table of readings kept with the project."""

import re
from pathlib import Path

import pandas as pd
import pytest

from asperity import markup
from asperity.config.study import read_study
from asperity.paper.claims.documents import findings, pages
from asperity.paper.claims.report import count_of, verdict_in_words
from asperity.paper.claims.statements import CLAIMS

ROOT = Path(__file__).parents[2]


@pytest.fixture(scope="module")
def found():
    return findings(ROOT / "docs/ensemble.csv")


def test_the_pages_say_what_the_table_says():
    """``python -m asperity.paper.claims`` writes them."""
    for path, text in pages(ROOT).items():
        assert (ROOT / path).read_text(encoding="utf-8") == text


def test_the_kept_document_has_the_verdicts_of_the_table(found):
    document = (ROOT / "docs/ensemble.md").read_text(encoding="utf-8")
    assert count_of(found) in document
    for finding in found:
        (line,) = [
            one for one in document.splitlines() if one.startswith(f"| {escaped(finding.claim.sentence)} |")
        ]
        assert escaped(verdict_in_words(finding)) in line


def escaped(text):
    return markup.markdown(pd.DataFrame({"": [text]})).splitlines()[-1].strip("| ").strip()


def test_every_statement_is_kept_under_every_reading_of_the_ensemble(found, monkeypatch):
    monkeypatch.chdir(ROOT)
    readings = read_study(["config/ensemble.yaml"])["readings"]
    assert [f.claim.identifier for f in found] == [c.identifier for c in CLAIMS]
    for finding in found:
        expected = 1
        for name in finding.claim.choices:
            expected *= len(readings[name])
        assert len(finding.judgements) == expected
        for name, option in finding.own.options.items():
            assert option == readings[name][0]


def test_readme_names_the_number_of_statements_and_seeds(found):
    readme = (ROOT / "README.md").read_text(encoding="utf-8")
    (told,) = re.findall(
        r"`make claims`, (\d+) random surfaces of every kind, tests (\d+) statements", readme
    )
    assert told == (str(max(f.own.seeds for f in found)), str(len(found)))
