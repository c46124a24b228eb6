"""Outcome of contacts of every family of surfaces with every level of every setting.

The other settings of each contact are drawn, so that the settings meet in all combinations. A contact is
solved and confirmed by `solution_check`, or refused with a message that names an argument; anything else is
a defect.
"""

import numpy as np
import pandas as pd
from extremes import CERTIFIED, CHECKED, FAILED, REFUSED, Attempt, solve_and_check
from families import FAMILIES, FamilyCase, drawn, family_arguments, family_levels

SOLVED = (CHECKED, CERTIFIED)
ACCEPTABLE = (*SOLVED, REFUSED)
"""Outcomes that are no defect."""

REFUSALS = ("contact_area_fraction = ", "approach = ", "dtype = ")
"""Beginnings of the messages that refuse problems without a solution: full contact beyond the hardness, an
approach to the mean height on a solid without uniform displacement, and heights that single precision
cannot hold."""


def family_outcomes(every: int = 1) -> pd.DataFrame:
    """Case, outcome and reason of contacts of every family with every level, or with one in so many."""
    columns = range(every // 2, len(list(family_levels())), every)
    cases = [family_case(family, column) for family in FAMILIES for column in columns]
    found = [attempt_family(case) for case in cases]
    return pd.DataFrame(
        [(repr(case), one.outcome, one.reason) for case, one in zip(cases, found, strict=True)],
        columns=["case", "outcome", "reason"],
    )


def family_case(family: str, column: int) -> FamilyCase:
    """The contact of a family with a level, by its number in `family_levels`."""
    name, value = list(family_levels())[column]
    return drawn(np.random.default_rng([list(FAMILIES).index(family), column]), family, **{name: value})


def attempt_family(case: FamilyCase) -> Attempt:
    """Outcome of a contact of a family; only a contact without a solution may be refused."""
    found = solve_and_check(lambda: family_arguments(case))
    is_wrong_refusal = found.outcome == REFUSED and not found.reason.startswith(REFUSALS)
    return found._replace(outcome=FAILED) if is_wrong_refusal else found
