"""Rounding of the layer's formulas, contacts at the ends of all ranges, and of all families of surfaces.

    python studies/stability/stability.py

computes them in two minutes and writes docs/stability.md with its three figures and a table of times. Run it
in the project's folder.
"""

from pathlib import Path
from typing import Any

import extremes
import extremes_figure
import family_figure
import family_outcomes
import rounding
import rounding_figure

from asperity.study.small_studies import rendered
from asperity.views.style import save, style

DOCS = Path("docs")


def main() -> None:
    """Compute, draw, and write the page."""
    found = {
        "rounding": (rounding_figure, rounding.rounding_errors(per_decade=4)),
        "extremes": (extremes_figure, extremes.outcome_matrix()),
        "families": (family_figure, family_outcomes.family_outcomes()),
    }
    captions: dict[str, Any] = {}
    for name, (module, data) in found.items():
        with style():
            save(module.draw(data), DOCS / f"{name}.png")
        captions[name] = module.caption(data)
    captions["elements"] = rounding.element_errors()
    times = family_figure.times_by_grid(found["families"][1])
    times.to_csv(DOCS / "families.csv", index=False, float_format="%.3g")
    page = rendered(Path(__file__).with_name("page.md.j2"), **captions)
    (DOCS / "stability.md").write_text(page, encoding="utf-8")


if __name__ == "__main__":
    main()
