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

UNITS = {"conductivity": "conductivity in W/(m K)", "resistivity": "resistivity in Ω m"}


def settings() -> str:
    """The settings of a case, a table for each group."""
    return describe(Case, "Settings outside groups")


def materials() -> str:
    """The materials: constants, their ranges, and the numbered sources."""
    texts = list(packaged_yaml("asperity.settings", "materials.yaml")["sources"].values())
    head = ["material", "also", "kind", *(UNITS.get(name, name) for name in CONSTANTS)]
    values, places, used = [], [], []
    for each in table().values():
        found = each.constants
        kind = ", ".join(filter(None, [each.group, str(each.state)]))
        shown = [str(found[name].value) if name in found else "" for name in CONSTANTS]
        values.append([each.name, ", ".join(each.also), kind, *shown])
        of_place: dict[str, list[str]] = {}
        for name, constant in found.items():
            source = max((text for text in texts if constant.source.startswith(text)), key=len)
            used += [source] if source not in used else []
            place = f"[{used.index(source) + 1}]"
            span = "" if constant.range is None else f" ({' to '.join(map(str, constant.range))})"
            of_place.setdefault(place, []).append(f"{name}{span}")
        cited = (f"{', '.join(names)} {place}" for place, names in of_place.items())
        places.append([each.name, "; ".join(cited)])
    numbered = "\n".join(f"{number}. {source}" for number, source in enumerate(used, 1))
    return (
        f"{_table(head, values)}\n\n## Ranges and sources of the constants\n\n"
        f"{_table(['material', 'constant (range) [source]'], places)}\n\n## Sources\n\n{numbered}\n"
    )


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
