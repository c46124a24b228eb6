"""Examples on the pages of the documentation run as they stand, and the page of the interface is complete."""

from __future__ import annotations

import re
from pathlib import Path

import matplotlib as mpl
import pytest

import asperity

DOCS = Path(__file__).parents[2] / "docs"

pytestmark = pytest.mark.xdist_group("gallery")


@pytest.mark.parametrize(
    ("page", "written"),
    [("index", "section.png"), ("two_bodies", None), ("paraview", "box.nc")],
)
def test_the_example_of_a_page_runs(
    page: str, written: str | None, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    (example,) = re.findall(r"```python\n(.*?)```", (DOCS / f"{page}.md").read_text("utf-8"), re.DOTALL)
    names: dict = {}
    with mpl.rc_context({"backend": "agg"}):
        exec(example, names)
    names["contact"].certificate.check(1e-4)
    assert written is None or (tmp_path / written).stat().st_size > 1000


def test_every_public_name_has_its_place_on_the_page_of_the_interface() -> None:
    listed = re.findall(r"^   ~asperity\.(\w+)$", (DOCS / "api.rst").read_text("utf-8"), re.MULTILINE)
    assert sorted(listed) == sorted(set(asperity.__all__) - {"__version__"})
