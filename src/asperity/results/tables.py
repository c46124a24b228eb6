"""Tables of the project as files: their columns with units, and one writer for CSV and Parquet.

A table is a data frame of pandas with one row for each case and numbers as numbers. `tables.yaml` describes
all of them; `docs/tables.md` shows it. For a reader a table is made into Markdown or HTML by
`asperity.core.markup`.
"""

from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Any

from asperity.core.data import packaged_yaml
from asperity.core.types import FilePath
from asperity.results.atomic import atomic_write

if TYPE_CHECKING:
    import pandas as pd

SUFFIXES = (".csv", ".parquet")

TABLES: dict[str, dict[str, Any]] = packaged_yaml("asperity.results", "tables.yaml")
"""Name → ``source``, ``row`` and ``columns`` of a table; a column is [unit, content], and may be marked
optional.

Numbers in a column have one unit, ``1`` for a plain number; texts and truth values have none.
"""

FEWEST = 3
"""A table that repeats at least so many columns of an earlier one refers to it on the page."""


def write_table(frame: "pd.DataFrame", table: str, path: FilePath, float_format: str | None = None) -> None:
    """Write a table as CSV or Parquet, by the suffix of the path, whole or not at all.

    Parameters
    ----------
    frame : DataFrame
        Its columns are those of `TABLES`, in that order; a Parquet file keeps their units in
        ``frame.attrs``.
    table : str
        Name in `TABLES`.
    path : path
        Ends in .csv or .parquet; the latter needs the package pyarrow.
    float_format : str, optional
        Of numbers in a CSV file, such as ``"%.8g"``; by default all digits.

    Raises
    ------
    ValueError
        If the suffix is another, a column is not in the description, or one is missing.
    ImportError
        If pyarrow is needed and not installed.
    DatasetError
        If the file cannot be written; an earlier file of the same name is still there then.
    """
    path = Path(path)
    if path.suffix not in SUFFIXES:
        raise ValueError(f"{path}: a name that ends in {' or '.join(SUFFIXES)} is needed")
    if path.suffix == ".parquet" and find_spec("pyarrow") is None:
        raise ImportError(f"{path}: Parquet needs the package pyarrow: pip install pyarrow, or write .csv")
    check_columns(frame, table)
    with atomic_write(path) as unfinished:
        if path.suffix == ".csv":
            frame.to_csv(unfinished, index=False, float_format=float_format, lineterminator="\n")
        else:
            described = frame.copy()
            described.attrs["units"] = units(table, frame)
            described.to_parquet(unfinished, index=False)


def check_columns(frame: "pd.DataFrame", table: str) -> None:
    """Raise `ValueError` unless the columns of a frame are those of a table, in their order."""
    columns = TABLES[table]["columns"]
    found = [_described(str(name), columns) for name in frame.columns]
    needed = [name for name, (_, _, *optional) in columns.items() if not optional]
    unknown = [str(name) for name, known in zip(frame.columns, found, strict=True) if not known]
    missing = [name for name in needed if name not in found]
    if unknown or missing:
        problem = f"{unknown[0]!r} is not among its columns" if unknown else f"{missing[0]!r} is missing"
        raise ValueError(f"table {table}: column {problem}; columns {', '.join(needed)} are needed")
    if found != sorted(found, key=list(columns).index):
        raise ValueError(f"table {table}: columns {', '.join(map(str, frame.columns))} are out of order")


def units(table: str, frame: "pd.DataFrame") -> dict[str, str]:
    """Column → unit, of the columns of a frame that have one."""
    columns = TABLES[table]["columns"]
    found = {str(name): columns[_described(str(name), columns)][0] for name in frame.columns}
    return {name: unit for name, unit in found.items() if unit}


def _described(name: str, columns: dict[str, Any]) -> str:
    """Name under which a column is described, empty if it is not; ``error_…`` describes all such names."""
    matches = (
        known for known in columns if name == known or (known[-1] == "…" and name.startswith(known[:-1]))
    )
    return next(matches, "")


def describe_tables() -> str:
    """All tables with their columns, in Markdown; columns of an earlier table are not repeated."""
    parts = []
    shown: dict[str, dict[str, Any]] = {}
    for name, table in TABLES.items():
        columns = table["columns"]
        common = {
            other: [each for each in known if columns.get(each) == known[each]]
            for other, known in shown.items()
        }
        other = max(common, key=lambda each: len(common[each]), default="")
        repeated = common[other] if other and len(common[other]) >= FEWEST else []
        lines = [
            f"- `{column}`{f' ({unit})' if unit else ''}: {content}"
            for column, (unit, content, *_) in columns.items()
            if column not in repeated
        ]
        if repeated:
            lines.append(f"- {', '.join(f'`{each}`' for each in repeated)}: as in `{other}`")
        head = f"## {name}\n\n{table['source'][0].upper()}{table['source'][1:]}. A row is {table['row']}.\n"
        parts.append("\n".join([head, *lines]))
        shown[name] = columns
    return "\n\n".join(parts) + "\n"


if __name__ == "__main__":
    print(describe_tables(), end="")
