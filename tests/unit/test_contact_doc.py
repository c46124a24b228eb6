"""The examples of docs/contact.md run as they stand."""

import re
from pathlib import Path

import pytest

PAGE = (Path(__file__).parents[2] / "docs" / "contact.md").read_text(encoding="utf-8")
EXAMPLES = re.findall(r"```python\n(.*?)```", PAGE, re.DOTALL)


@pytest.mark.parametrize("example", EXAMPLES, ids=["two bodies", "free boundary"])
def test_the_example_runs(example: str, capsys: pytest.CaptureFixture[str]) -> None:
    names: dict = {}
    exec(example, names)
    assert 0 < names["contact"].area_fraction < 1
    names["contact"].certificate.check(1e-4)
    assert capsys.readouterr().out
