"""The house: rooms in the order in which data passes, and who imports whom.

Run `python docs/house.py` to draw `docs/images/house.png` anew and to write the lists of rooms and
files into `docs/architecture.md`. `tests/test_house.py` holds the code against the rules below.
"""

import ast
import re
import textwrap
from collections.abc import Iterator
from pathlib import Path

DOCS = Path(__file__).resolve().parent
PACKAGE = DOCS.parent / "jaxsusp"

ROOT = ("errors", "_types", "_files", "_cache", "_showing", "vec3")
"""Modules at the root that any room may import; beside them only `__init__` and `__main__`."""

ROOMS = {
    "geometry": "packed obstacles",
    "mechanics": "tensions, postures",
    "scenario": "Scenario, World",
    "freespace": "FreeSpace",
    "trajectory": "curve, time law",
    "suspension": "loads, Rigging",
    "problem": "Problem",
    "optim": "Result",
    "coordination": "ends",
    "verify": "Certificate, Simulation",
    "cluster": "jobs done by workers",
    "planning": "Plan",
    "comparison": "Dataset",
    "report": "tables, pictures",
    "studies": "fresh scenarios",
    "cli": "files, exit status",
}
"""Every room and what it hands on. A room imports only from itself, from rooms above it in this
list, and from `ROOT`."""


def modules() -> dict[str, Path]:
    """All modules of the package by their dotted names below it; a package by its folder's name."""
    found = {}
    for path in sorted(PACKAGE.rglob("*.py")):
        parts = path.relative_to(PACKAGE).with_suffix("").parts
        found[".".join(parts[:-1] if parts[-1] == "__init__" and len(parts) > 1 else parts)] = path
    return found


def imports() -> dict[str, set[str]]:
    """What each module imports: at its top, in functions, or for the type checker alone."""
    known = modules()
    return {name: set(_imported(path, known)) for name, path in known.items()}


def _imported(path: Path, known: dict[str, Path]) -> Iterator[str]:
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        names: list[str] = []
        if isinstance(node, ast.Import):
            names = [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            names = [f"{_origin(node, path)}.{alias.name}" for alias in node.names]
        elif isinstance(node, ast.Constant | ast.JoinedStr):  # for importlib and its like
            names = [text] if _DOTTED.match(text := _beginning(node)) else []
        for name in names:
            if name.partition(".")[0] == "jaxsusp":
                yield _longest(name.removeprefix("jaxsusp").lstrip("."), known)


def _origin(node: ast.ImportFrom, path: Path) -> str:
    """What an import is from; dots lead up from the file that they stand in."""
    if not node.level or not path.is_relative_to(PACKAGE.parent):
        return node.module or ""
    folder = path.relative_to(PACKAGE.parent).parts[: -node.level]
    return ".".join([*folder, *filter(None, [node.module])])


_DOTTED = re.compile(r"jaxsusp(\.\w+)+\.?$")


def _beginning(node: ast.Constant | ast.JoinedStr) -> str:
    """The text of a string up to its first placeholder."""
    first = node.values[0] if isinstance(node, ast.JoinedStr) and node.values else node
    return first.value if isinstance(first, ast.Constant) and isinstance(first.value, str) else ""


def opens_everything(path: Path) -> bool:
    """Whether a module imports the package itself, and with it every public name of every room."""
    tree = ast.parse(path.read_text(encoding="utf-8"))
    plain = [alias.name for node in ast.walk(tree) if isinstance(node, ast.Import)
             for alias in node.names]  # fmt: skip
    return any(name.partition(".")[0] == "jaxsusp" for name in plain)


def _longest(name: str, known: dict[str, Path]) -> str:
    """The module that a dotted name is in."""
    while name and name not in known:
        name = name.rpartition(".")[0]
    return name or "__init__"


def room_of(module: str) -> str:
    """The room that a module is in, or the module itself at the root."""
    return module.partition(".")[0]


def doors() -> dict[str, set[str]]:
    """Which rooms each room imports from."""
    found: dict[str, set[str]] = {room: set() for room in ROOMS}
    for module, used in imports().items():
        if (room := room_of(module)) in found:
            found[room] |= {room_of(each) for each in used} & ROOMS.keys() - {room}
    return found


def sentence(path: Path) -> str:
    """The first sentence of a module's or a room's documentation."""
    words = ast.get_docstring(ast.parse(path.read_text(encoding="utf-8"))) or ""
    return " ".join(words.split("\n\n")[0].split())


def draw(file: Path) -> None:
    """Rooms from top to bottom, their files, what they hand on, and who imports from whom."""
    from matplotlib.figure import Figure

    rooms, known, used = list(ROOMS), modules(), doors()
    figure = Figure(figsize=(13.5, 9.6), layout="constrained")
    axes = figure.subplots()
    axes.set(xlim=(0, 135), ylim=(len(rooms) + 0.1, -1.5))
    axes.axis("off")
    right, matrix, step = 80, 103, 2.1
    for row, room in enumerate(rooms):
        axes.fill_between([0, right], row + 0.05, row + 0.95, color="#e8eef4", linewidth=0)
        axes.text(1, row + 0.5, room, weight="bold", size=10.5, va="center")
        axes.text(14, row + 0.27, sentence(known[room]), size=7.6, va="center")
        axes.text(14, row + 0.66, _files(room), size=6.2, va="center", color="#40566b")
        axes.text(right + 2.2, row + 0.5, ROOMS[room], size=8.5, va="center", color=_PATH)
        if row:
            way = {"arrowstyle": "->", "color": _PATH}
            x = right + 1.2
            axes.annotate("", (x, row + 0.4), (x, row - 0.4), arrowprops=way)
        for column, other in enumerate(rooms[: row + 1]):
            x = matrix + step * column
            if column == row:
                axes.plot(x, row + 0.5, "s", color="#c4d3e0", markersize=9)
            elif other in used[room]:
                axes.plot(x, row + 0.5, "o", color="#1f4e79", markersize=6)
            else:
                axes.plot(x, row + 0.5, ".", color="#d5d5d5", markersize=3)
    for column, other in enumerate(rooms):
        axes.text(matrix + step * column, -0.1, other, rotation=55, size=7.5, va="bottom")
    for x, text in ((1, "room, its purpose, its files"), (right + 2, "hands on")):
        axes.text(x, -0.3, text, size=9, style="italic", color="#555555")
    axes.text(matrix - 1, -1.3, "imports from", size=9, style="italic", color="#555555")
    figure.savefig(file, dpi=110, metadata={"Software": None})


_PATH = "#8a4b00"


def _files(room: str) -> str:
    """The files of a room, those of a room in it behind its name."""
    inside: dict[str, list[str]] = {}
    for path in sorted((PACKAGE / room).rglob("*.py")):
        if path.stem != "__init__":
            inside.setdefault(path.parent.relative_to(PACKAGE / room).name, []).append(path.stem)
    lines = [
        (f"{folder}/  " if folder else "") + "  ".join(names) for folder, names in inside.items()
    ]
    return textwrap.fill("     ".join(lines), 135, replace_whitespace=False)


def listing() -> str:
    """Every room with its sentence, and every file in it with its own, as Markdown."""
    known, lines = modules(), []
    for room in ROOMS:
        lines += ["", f"**`{room}/`** {sentence(known[room])}", ""]
        inside = [name for name in known if name.startswith(f"{room}.")]
        for name in sorted(inside, key=lambda name: (name.count("."), name)):
            path = known[name].relative_to(PACKAGE / room).as_posix().removesuffix("__init__.py")
            lines.append(f"- `{path}`: {sentence(known[name])}")
    return "\n".join(lines).strip() + "\n"


BEGIN, END = "<!-- files: written by docs/house.py -->\n", "<!-- end of files -->\n"


def main() -> None:
    """Draw the picture and write the list."""
    draw(DOCS / "images" / "house.png")
    page = DOCS / "architecture.md"
    before, _, rest = page.read_text(encoding="utf-8").partition(BEGIN)
    after = rest.partition(END)[2]
    page.write_text(f"{before}{BEGIN}\n{listing()}\n{END}{after}", encoding="utf-8")


if __name__ == "__main__":
    main()
