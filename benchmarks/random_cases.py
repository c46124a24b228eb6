"""Coverage of stated errors over random cases: the command line and the table that benchmarks share."""

import os
from collections.abc import Callable, Iterable, Sequence
from concurrent.futures import ProcessPoolExecutor
from typing import Any

import numpy as np
import pandas as pd
from measuring import parser_of
from tqdm import tqdm

Row = dict[str, Any]


def run(
    text: str | None,
    file: str,
    cases: Callable[[np.random.Generator, int], Iterable[Any]],
    compared: Callable[[Any], Iterable[Row]],
    table: Callable[[pd.DataFrame], pd.DataFrame],
    count: int,
    seed: int,
) -> None:
    """Compare random cases, a process each, and write and print the table of all their rows.

    `cases` draws a number of cases from a generator; `compared` returns the rows of a case.
    """
    parser = parser_of(text)
    parser.add_argument("--count", type=int, default=count, help="number of surfaces, or of each kind")
    parser.add_argument("--seed", type=int, default=seed)
    parser.add_argument("--processes", type=int, default=os.cpu_count())
    parser.add_argument("--out", default=file)
    options = parser.parse_args()
    drawn = list(cases(np.random.default_rng(options.seed), options.count))
    with ProcessPoolExecutor(options.processes) as processes:
        found = tqdm(processes.map(compared, drawn), total=len(drawn))
        summary = table(pd.DataFrame([row for rows in found for row in rows]))
    summary.to_csv(options.out)
    print(summary.to_string())


def covered(rows: pd.DataFrame, keys: Sequence[str], columns: Sequence[str]) -> pd.DataFrame:
    """Errors and coverage in per cent, by keys: the columns that are named.

    A stated error covers the true one if it is not smaller, unless a column ``covered`` says so. ``cases`` is
    the number of rows, ``estimated`` the share of those with an estimate, ``true_p90`` the 90th percentile.
    """
    given = rows[np.isfinite(rows["true"] + rows["stated"])]
    if "covered" not in given:
        given = given.assign(covered=given["true"] <= given["stated"])
    every, groups = rows.groupby([*keys], sort=False), given.groupby([*keys], sort=False)
    found = {"cases": every.size(), "estimated": (100 * groups.size() / every.size()).fillna(0)}
    for name in columns:
        column, _, level = name.rpartition("_")
        if level == "median":
            found[name] = 100 * groups[column].median()
        elif level.startswith("p") and level[1:].isdigit():
            found[name] = 100 * groups[column].quantile(int(level[1:]) / 100)
    found["covered"] = 100 * groups["covered"].mean()
    return pd.DataFrame(found)[[*columns]].round(2)
