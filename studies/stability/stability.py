"""Rounding of the layer's formulas, contacts at the ends of all ranges, and of all families of surfaces.

    python studies/stability/stability.py

computes them in three minutes of processor time and writes README.md. Run it in the project's folder.
"""

from pathlib import Path

import pandas as pd
from extremes import OUTCOMES, REFUSED, outcomes, refusals
from family_outcomes import family_outcomes
from rounding import FORMULAS, element_errors, rounding_errors

from asperity.core.markup import markdown
from asperity.study.small_studies import rendered

NAMES = {
    "printed": "Eq. A.3, misprints corrected",
    "layer": "asperity",
}
ACCURATE = 1e-4
"""Relative error up to which a formula counts as accurate."""


def accuracy() -> tuple[pd.DataFrame, dict[str, float]]:
    """Range of q · height in which each formula is accurate at ν = 0.33; largest errors of asperity."""
    error = rounding_errors(per_decade=4)["error"]
    rows = []
    for formula in FORMULAS:
        row = {"formula": NAMES[formula]}
        for precision, name in (("float64", "double"), ("float32", "single")):
            of_ratio = error.sel(formula=formula, precision=precision, poisson=0.33)
            for quantity, text in (("compliance", "compliance"), ("bonded_stress", "stress")):
                one = of_ratio.sel(quantity=quantity)
                good = one["scaled_wavenumber"].values[(one <= ACCURATE).values]
                row[f"{text}, {name}"] = f"{good.min():.0e} to {good.max():.0e}" if good.size else ""
        rows.append(row)
    return pd.DataFrame(rows), {
        precision: float(error.sel(formula="layer", precision=precision).max())
        for precision in ("float64", "float32")
    }


def main() -> None:
    """Compute, and write the page."""
    formulas, largest = accuracy()
    found = {"ends of the ranges, alone and in pairs": outcomes(), "families of surfaces": family_outcomes()}
    counts = [
        {"contacts": name} | {outcome: int((table["outcome"] == outcome).sum()) for outcome in OUTCOMES}
        for name, table in found.items()
    ]
    beyond = refusals()
    page = rendered(
        Path(__file__).with_name("page.md.j2"),
        formulas=markdown(formulas),
        largest=largest,
        elements=float(element_errors().max()),
        counts=markdown(pd.DataFrame(counts)),
        beyond=len(beyond),
        refused=int((beyond["outcome"] == REFUSED).sum()),
    )
    Path("studies/stability/README.md").write_text(page, encoding="utf-8")


if __name__ == "__main__":
    main()
