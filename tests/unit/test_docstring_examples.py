"""Every public name has an example in its docstring, which runs as it stands."""

from __future__ import annotations

import doctest
from types import ModuleType

import matplotlib as mpl
import numpy as np
import pytest

import asperity
import asperity.engineering

NAMES = [
    *((asperity, name) for name in sorted(set(asperity.__all__) - {"__version__"})),
    *((asperity.engineering, name) for name in ("Body", "MapSettings", "run", "write_answer")),
]

pytestmark = pytest.mark.xdist_group("gallery")  # one process, with the examples of the gallery


@pytest.fixture(autouse=True)
def _without_a_screen():
    with mpl.rc_context({"backend": "agg"}):
        yield


@pytest.mark.parametrize(("module", "name"), NAMES, ids=[name for _, name in NAMES])
def test_the_example_of_the_docstring_runs(module: ModuleType, name: str) -> None:
    finder = doctest.DocTestFinder(recurse=False)
    names = {"asp": asperity, "np": np}
    if module is asperity.engineering:
        names |= {public: getattr(module, public) for public in module.__all__}
    (found,) = finder.find(getattr(module, name), name, globs=names)
    assert found.examples, f"{name}: an example is needed under 'Examples' in its docstring"
    assert any(example.want for example in found.examples), f"{name}: its example shows no result"
    runner = doctest.DocTestRunner(optionflags=doctest.ELLIPSIS | doctest.NORMALIZE_WHITESPACE)
    messages: list[str] = []
    assert runner.run(found, out=messages.append).failed == 0, "".join(messages)
