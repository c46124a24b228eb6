"""What docs/nayak.md says of the samples: the table of limits, the regressions and the verdict."""

from __future__ import annotations

from typing import NamedTuple

import pandas as pd

from asperity import markup
from asperity.paper.claims.report import with_error
from asperity.paper.nayak.analysis import NUMBERS, TERMS, Regression, regress

STRUCTURE = ("ln_nayak", "hurst", "ln_ratio")
"""Terms that describe the surface, each tried beside the area."""


class Effect(NamedTuple):
    """Relative change of a number over the range of a term, with the half width of its 95 % interval."""

    change: float
    error: float

    @property
    def clear(self) -> bool:
        """Whether the interval excludes zero."""
        return abs(self.change) > self.error


def effect(rows: pd.DataFrame, found: Regression, number: str, term: str) -> Effect:
    """Relative change of a number from the smallest to the largest value of a term, all else equal."""
    place = found.terms.index(term)
    width = float(rows[term].max() - rows[term].min()) / float(rows[number].mean())
    return Effect(found.slopes[place] * width, found.errors[place] * width)


def regressions(rows: pd.DataFrame) -> dict[tuple[str, tuple[str, ...]], Regression]:
    """Regressions of κ and κ_r: on each structural term and the area, and on H, the ratio and the area."""
    kinds = [(term, "ln_area") for term in STRUCTURE] + [("hurst", "ln_ratio", "ln_area")]
    return {(number, terms): regress(rows, number, terms) for number in NUMBERS for terms in kinds}


def _table(rows: pd.DataFrame) -> str:
    head = [
        "H",
        "λ_l/λ_s",
        "α",
        "p̄/E*ḡ, A",
        *(text for s in NUMBERS.values() for text in (s, "error, %")),
        "seeds",
    ]
    lines = [head]
    for _, row in rows.iterrows():
        cells = [f"{row['hurst']:g}", f"{row['ratio']:g}", f"{row['nayak']:.2f}"]
        cells.append(f"{row['pressure']:g}, {row['area']:.4f}")
        for key in NUMBERS:
            cells += [
                with_error(row[key], row[f"{key}_error"]),
                f"{100 * row[f'{key}_error'] / row[key]:.2f}",
            ]
        lines.append([*cells, row["seeds"]])
    return markup.markdown(pd.DataFrame(lines[1:], columns=lines[0]))


def _regression_table(rows: pd.DataFrame) -> str:
    lines = [["number", "terms", "slopes, 95 %", "over the range of the sweep", "residual", "R²"]]
    for (number, terms), found in regressions(rows).items():
        shown = [
            f"{TERMS[t]}: {s:+.4f} ± {e:.4f}"
            for t, s, e in zip(terms, found.slopes, found.errors, strict=True)
        ]
        changes = [
            f"{TERMS[t]}: {100 * one.change:+.1f} ± {100 * one.error:.1f} %"
            for t in terms
            if (one := effect(rows, found, number, t))
        ]
        residual = f"{100 * found.residual / rows[number].mean():.2f} %"
        names = ", ".join(TERMS[t] for t in terms)
        lines.append(
            [NUMBERS[number], names, "; ".join(shown), "; ".join(changes), residual, f"{found.explained:.3f}"]
        )
    return markup.markdown(pd.DataFrame(lines[1:], columns=lines[0]))


def verdict(rows: pd.DataFrame) -> str:
    """One paragraph: what the sweep says of both statements."""
    found = regressions(rows)
    low, high = rows["nayak"].min(), rows["nayak"].max()
    changes = {
        number: {term: effect(rows, found[number, (term, "ln_area")], number, term) for term in STRUCTURE}
        for number in NUMBERS
    }

    def told(number: str, term: str) -> str:
        one = changes[number][term]
        return f"{100 * one.change:+.1f} ± {100 * one.error:.1f} %"

    of_kappa, of_kappa_r = changes["kappa"]["ln_nayak"], changes["kappa_r"]["ln_nayak"]
    falls = of_kappa.clear and of_kappa.change < 0
    first = (
        f"With ḡ of the whole surface, κ {'falls' if falls else 'does not clearly fall'} with the logarithm "
        f"of Nayak's parameter ({told('kappa', 'ln_nayak')} from α = {low:.1f} to {high:.0f})"
    )
    clear = [TERMS[term] for term in STRUCTURE if changes["kappa_r"][term].clear]
    second = (
        f"with ḡ_r of the true contact, κ_r changes by {told('kappa_r', 'ln_nayak')} over the same range, "
        f"{told('kappa_r', 'hurst')} over that of H and {told('kappa_r', 'ln_ratio')} over that of λ_l/λ_s"
    )
    share = abs(of_kappa_r.change / of_kappa.change)
    third = (
        "none of these intervals excludes zero"
        if not clear
        else f"the intervals of {', '.join(clear)} exclude zero"
    )
    both = falls and not clear
    return f"{first}; {second}: {third}. " + (
        "**Both statements hold**: Nayak's parameter acts through the gradient of the contact."
        if both
        else f"**The first statement {'holds' if falls else 'does not hold'}; the second holds to "
        f"{100 * max(abs(one.change) + one.error for one in changes['kappa_r'].values()):.1f} %**: "
        f"{100 * (1 - share):.0f} % of the dependence on α is that of ḡ_r."
    )


def _grids(rows: pd.DataFrame) -> str:
    """How large the parts of the errors are, and what the corrected boundary is worth."""
    parts = []
    for key, symbol in NUMBERS.items():
        relative = 100 * rows[f"{key}_error"] / rows[key]
        scatter = 100 * rows[f"{key}_scatter"] / rows[key]
        above = [
            100 * (rows[f"{key}{kind}_coarsest"] / rows[key] - 1).mean() for kind in ("_uncorrected", "")
        ]
        orders = [rows[f"{key}{kind}_order"].iloc[0] for kind in ("_uncorrected", "")]
        parts.append(
            f"{symbol}: error {relative.mean():.2f} % in the mean, at most {relative.max():.2f} %, of which "
            f"the scatter of the seeds {scatter.mean():.2f} %, at most {scatter.max():.2f} %; the coarsest "
            f"grid is {above[0]:+.1f} % from the limit without the correction of the boundary and "
            f"{above[1]:+.1f} % with it, the orders of convergence are {orders[0]:.2f} and {orders[1]:.2f}"
        )
    return ". ".join(parts) + "."


def sections(rows: pd.DataFrame) -> dict[str, str]:
    """Generated sections of the page by the name of their marks."""
    return {
        "verdict": verdict(rows),
        "limits": _table(rows) + "\n\n" + _grids(rows),
        "regressions": _regression_table(rows),
    }
