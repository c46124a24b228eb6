"""Measure speed and accuracy in full and store the result: `make tradeoff`.

It is stored in the package, and the table of the presets in config/README.md.
"""

import re
import subprocess
from pathlib import Path

from asperity.study.cost.measured import MeasuredTradeoff, as_json, from_json
from asperity.study.cost.tables import describe_presets

STORED = Path("src/asperity/study/cost/measured.json")
README = Path("config/README.md")
MEASURED = Path("results/tradeoff/full/measured.json")


def with_table(text: str, measured: MeasuredTradeoff) -> str:
    """The text of the README with its table of the presets replaced."""
    mark = "<!-- presets: python -m asperity.study.cost.tables -->\n"
    return re.sub(f"(?<={re.escape(mark)})(\\|.*\n)*", lambda _: describe_presets(measured) + "\n", text)


def main() -> None:
    """Run the rule at its full size, then store what it measured."""
    subprocess.run(["snakemake", "--cores", "1", "results/tradeoff/full/front.png"], check=True)
    measured = from_json(MEASURED.read_text(encoding="utf-8"))
    STORED.write_text(as_json(measured), encoding="utf-8")
    README.write_text(with_table(README.read_text(encoding="utf-8"), measured), encoding="utf-8")
    print(f"stored in {STORED} and {README}")


if __name__ == "__main__":
    main()
