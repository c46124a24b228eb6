"""The examples of the README run as they stand."""

import re
from pathlib import Path

README = (Path(__file__).parents[2] / "README.md").read_text()
EXAMPLES = re.findall(r"```python\n(.*?)```", README, re.DOTALL)


def test_the_library_example_runs():
    (example,) = [text for text in EXAMPLES if "import asperity" in text]
    names = {}
    exec(example, names)
    assert abs(names["contact"].area_fraction - 0.10) < 1e-4
    assert set(names["stress"].poisson.values) == {0.0, 0.33, 0.5}
