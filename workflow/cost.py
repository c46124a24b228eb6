"""Table of the processor minutes and memory of every rule and surface of a finished study.

    python workflow/cost.py [results] [--csv FILE] [--store]

The memory that the rule declares stands beside the largest that was measured. With --csv the table is
written as CSV too. With --store the cost model of the library is fitted to this study.
"""

import argparse
import sys
from pathlib import Path

import pandas as pd

from asperity.core.markup import markdown
from asperity.results.tables import write_table
from asperity.study.cost import model
from asperity.study.cost.benchmark import cost_table, fitted, job_costs


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("results", nargs="?", type=Path, default="results", help="folder of the results")
    parser.add_argument("--csv", metavar="FILE", help="write the table too")
    parser.add_argument("--store", action="store_true", help="fit the cost model to this study")
    options = parser.parse_args()
    jobs = job_costs(options.results)
    if jobs.empty:
        sys.exit(f"{options.results}: no finished job; run the study first")
    table = cost_table(jobs)
    print(markdown(table.round({"processor_minutes": 2, "largest_memory_MB": 0})))
    if options.csv:
        write_table(table, "costs", options.csv)
    if options.store:
        coefficients = pd.DataFrame(model.coefficients()).T.rename_axis("job")
        coefficients.update(fitted(jobs))
        coefficients.loc["transform", "seconds"] = model.transform_seconds()
        coefficients.to_csv(Path(model.__file__).with_name("jobs.csv"), float_format="%.3g")


if __name__ == "__main__":
    main()
