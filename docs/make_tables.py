"""Write the tables of docs/cases.md and docs/materials.md from settings and data file of materials.

python docs/make_tables.py
"""

from pathlib import Path

from asperity.core.data import packaged_yaml
from asperity.engineering.case import Case
from asperity.settings.describe import describe
from asperity.settings.materials import CONSTANTS, table

FOLDER = Path(__file__).parent
MARK = "<!-- python docs/make_tables.py -->\n\n"
"""Line of a page after which everything is made."""

FEWEST = 3
"""A constant that fewer materials have is written beside their kind instead of a column."""

UNITS = {"conductivity": "conductivity, W/(m K)", "resistivity": "resistivity, Ω m"}


def settings() -> str:
    """The settings of a case, a table for each group."""
    return describe(Case, "Settings outside groups")


def materials() -> str:
    """The materials: their constants, and the numbered sources."""
    texts = list(packaged_yaml("asperity.settings", "materials.yaml")["sources"].values())
    every = [name for each in table().values() for name in each.constants]
    listed = [name for name in CONSTANTS if every.count(name) >= FEWEST]
    rows, used = [], []
    for each in table().values():
        numbers = []
        for constant in each.constants.values():
            source = max((text for text in texts if constant.source.startswith(text)), key=len)
            used += [source] if source not in used else []
            numbers.append(used.index(source) + 1)
        rare = [f"{name} {found.value}" for name, found in each.constants.items() if name not in listed]
        kind = ", ".join(filter(None, [each.group, str(each.state), *rare]))
        shown = [str(each.constants[name].value) if name in each.constants else "" for name in listed]
        cited = ", ".join(map(str, sorted(set(numbers))))
        rows.append([", ".join([f"**{each.name}**", *each.also]), kind, *shown, cited])
    head = ["**material**, other names", "kind", *(UNITS.get(name, name) for name in listed), "sources"]
    numbered = "\n".join(f"{number}. {source}" for number, source in enumerate(used, 1))
    return f"{_table(head, rows)}\n\n## Sources\n\n{numbered}\n"


def _table(head: list[str], rows: list[list[str]]) -> str:
    """A table in Markdown."""
    cells = [[cell.replace("|", "/") for cell in row] for row in rows]
    return "\n".join(f"| {' | '.join(row)} |" for row in [head, ["---"] * len(head), *cells])


PAGES = {"cases.md": settings, "materials.md": materials}
"""Page → function that makes its tables."""


def page(name: str) -> str:
    """The text of a page with its tables made anew."""
    return (FOLDER / name).read_text(encoding="utf-8").split(MARK)[0] + MARK + PAGES[name]()


if __name__ == "__main__":
    for each in PAGES:
        (FOLDER / each).write_text(page(each), encoding="utf-8")
