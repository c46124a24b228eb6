"""The article on the statements of the paper: its text finds its tables; `make replication` makes the PDF."""

import runpy
import sys
from types import SimpleNamespace

import pytest
from project import ROOT


class MadeError(Exception):
    """Raised with the text in place of its conversion."""


def test_text_of_the_article_has_its_tables(monkeypatch):
    def convert(text, *_, **__):
        raise MadeError(text)

    for name in ("pypandoc", "typst"):
        monkeypatch.setitem(sys.modules, name, SimpleNamespace(convert_text=convert))
    with pytest.raises(MadeError) as made:
        runpy.run_path(str(ROOT / "paper/replication.py"), run_name="__main__")
    text = str(made.value)
    assert text.count("| equation |") == 1
    assert text.count("| the paper says |") == 5
    assert "{{" not in text
