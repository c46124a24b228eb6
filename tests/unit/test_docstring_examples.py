"""Every public name has an example in its docstring, which runs as it stands."""

from __future__ import annotations

import doctest

import matplotlib as mpl
import numpy as np
import pytest

import asperity

NAMES = sorted(set(asperity.__all__) - {"__version__"})

pytestmark = pytest.mark.xdist_group("gallery")  # one process, with the examples of the gallery


@pytest.fixture(autouse=True)
def _without_a_screen():
    with mpl.rc_context({"backend": "agg"}):
        yield


@pytest.mark.parametrize("name", NAMES)
def test_the_example_of_the_docstring_runs(name: str) -> None:
    finder = doctest.DocTestFinder(recurse=False)
    (found,) = finder.find(getattr(asperity, name), name, globs={"asp": asperity, "np": np})
    assert found.examples, f"{name}: an example is needed under 'Examples' in its docstring"
    assert any(example.want for example in found.examples), f"{name}: its example shows no result"
    runner = doctest.DocTestRunner(optionflags=doctest.ELLIPSIS | doctest.NORMALIZE_WHITESPACE)
    messages: list[str] = []
    assert runner.run(found, out=messages.append).failed == 0, "".join(messages)
