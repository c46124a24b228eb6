"""The full measurement of speed and accuracy, kept in the package and in the documentation: `make tradeoff`.

Runs the rule at its full size, and writes what plans are made from and the presets in config/README.md.
"""

import json
import re
import subprocess
from pathlib import Path

from asperity.accuracy.model import Measured, as_json, describe_presets

KEPT = Path("src/asperity/accuracy/measured.json")
README = Path("config/README.md")
MEASURED = Path("results/tradeoff/full/measured.json")


def with_table(text: str, measured: Measured) -> str:
    """The README with the presets as measured."""
    mark = "<!-- presets: python -m asperity.accuracy.plan -->\n"
    return re.sub(f"(?<={re.escape(mark)})(\\|.*\n)*", lambda _: describe_presets(measured) + "\n", text)


def main() -> None:
    """Measure and keep."""
    subprocess.run(["snakemake", "--cores", "1", "results/tradeoff/full/front.png"], check=True)
    measured = Measured(**json.loads(MEASURED.read_text(encoding="utf-8")))
    KEPT.write_text(as_json(measured), encoding="utf-8")
    README.write_text(with_table(README.read_text(encoding="utf-8"), measured), encoding="utf-8")
    print(f"{KEPT} and {README} are as measured")


if __name__ == "__main__":
    main()
