"""Draw docs/rooms.svg, the rooms of `src/asperity` and the imports between them: python docs/draw_rooms.py

A room stands one floor above all that it imports. An arrow is left out where a longer way of imports leads
to the same room.
"""

from pathlib import Path

import grimp

FOLDER = Path(__file__).parent
WIDTH, HEIGHT = 150, 64
"""Distance of rooms and of floors, in pixels."""
LEFT_OUT = ("__main__",)


def rooms() -> dict[str, set[str]]:
    """Room → rooms that its modules import."""
    graph = grimp.build_graph("asperity", exclude_type_checking_imports=True, cache_dir=None)
    names = sorted(name for name in graph.find_children("asperity") if name.split(".")[1] not in LEFT_OUT)
    found = {}
    for name in names:
        others = (other for other in names if other != name)
        imported = {
            each
            for each in others
            if graph.direct_import_exists(importer=name, imported=each, as_packages=True)
        }
        found[name.split(".")[1]] = {each.split(".")[1] for each in imported}
    return found


def floors(imports: dict[str, set[str]]) -> dict[str, int]:
    """Room → its floor, 0 for a room that imports no other."""
    found: dict[str, int] = {}

    def floor(name: str) -> int:
        if name not in found:
            found[name] = max((floor(each) + 1 for each in imports[name]), default=0)
        return found[name]

    return {name: floor(name) for name in imports}


def reached(imports: dict[str, set[str]], name: str) -> set[str]:
    """Rooms that a room imports through others."""
    return set().union(*(imports[each] | reached(imports, each) for each in imports[name]))


def picture() -> str:
    """The drawing as SVG, without dates: the same imports give the same file."""
    imports = rooms()
    floor = floors(imports)
    levels = [
        sorted(name for name in floor if floor[name] == level) for level in range(max(floor.values()) + 1)
    ]
    width = max(map(len, levels)) * WIDTH
    place = {
        name: (width / 2 + (column - (len(level) - 1) / 2) * WIDTH, (len(levels) - 1 - row) * HEIGHT + 30)
        for row, level in enumerate(levels)
        for column, name in enumerate(level)
    }
    lines, boxes = [], []
    for name, (x, y) in place.items():
        for other in sorted(imports[name] - reached(imports, name)):
            x2, y2 = place[other]
            lines.append(f'<line x1="{x:g}" y1="{y + 15:g}" x2="{x2:g}" y2="{y2 - 15:g}" stroke="#888"/>')
        box = f'x="{x - 60:g}" y="{y - 15:g}" width="120" height="30" rx="4"'
        boxes.append(f'<rect {box} fill="#eef3f8" stroke="#456"/>')
        style = 'text-anchor="middle" font-size="14" font-family="sans-serif"'
        boxes.append(f'<text x="{x:g}" y="{y + 5:g}" {style}>{name}</text>')
    size = f'width="{width}" height="{len(levels) * HEIGHT}"'
    head = f'<svg xmlns="http://www.w3.org/2000/svg" {size}>\n<rect {size} fill="white"/>'
    return "\n".join([head, *lines, *boxes, "</svg>\n"])


if __name__ == "__main__":
    (FOLDER / "rooms.svg").write_text(picture(), encoding="utf-8")
