"""Tables for people: one frame of numbers → rich, Markdown, HTML or CSV.

A frame carries what belongs to it in `frame.attrs`, all optional: `title`, `caption`, `group` (the
columns that become headings), `columns` (how to write some of them), `bold` (the cells to stress)
and `footnotes`. Cells are (row label, column name) pairs. CSV holds the bare numbers.
"""

import html
import math
import os
from collections.abc import Callable
from typing import Any, Literal, NamedTuple

import numpy as np
import pandas as pd
from rich.box import SIMPLE_HEAD
from rich.markup import escape
from rich.table import Table

from jaxsusp._files import write_text

Cell = tuple[Any, str]
"""(row label, column name)."""


class Footnote(NamedTuple):
    """A remark and the cells that carry its mark; without cells it is a note on the whole."""

    text: str
    cells: frozenset[Cell] = frozenset()


def significant(number: float, digits: int = 4) -> str:
    """A number to some significant digits; the integer part is always shown in full."""
    if not math.isfinite(number):
        return "–" if math.isnan(number) else "∞" if number > 0 else "−∞"
    rounded = float(f"{number:.{digits - 1}e}")
    if rounded != 0 and not 1e-4 <= abs(rounded) < 1e7:
        return f"{rounded:.{digits - 1}e}"
    magnitude = math.floor(math.log10(abs(rounded))) if rounded else digits - 1
    return f"{number:.{max(digits - 1 - magnitude, 0)}f}"


def duration(seconds: float) -> str:
    """Seconds to three digits, in the unit that needs no leading zeros: 12.3 s, 4.56 ms."""
    unit, size = next(((u, s) for u, s in (("s", 1.0), ("ms", 1e-3)) if seconds >= s), ("µs", 1e-6))
    return significant(seconds / size, 3) + (f" {unit}" if math.isfinite(seconds) else "")


def percent(share: float) -> str:
    """A share in [0, 1] as a percentage."""
    return significant(100 * share, 3) + (" %" if math.isfinite(share) else "")


def probability(p: float) -> str:
    """A p-value: three decimals, and never an overstated "0.000"."""
    return "–" if math.isnan(p) else "< 0.001" if p < 0.001 else f"{p:.3f}"


def two_decimals(number: float) -> str:
    """For numbers of order one: ranks, effect sizes."""
    return f"{number:.2f}" if math.isfinite(number) else significant(number)


def above(gap: float) -> str:
    """A gap in %: a decimal where it is small, never "-0.0" for what is rounding."""
    if not math.isfinite(gap) or abs(gap) >= 1e7:
        return significant(gap, 2)
    return f"{gap:.0f}" if abs(gap) >= 9.95 else f"{gap if abs(gap) > 1e-7 else 0.0:.1f}"


def evaluations(count: float) -> str:
    """A number of fitness evaluations."""
    return f"{count:,.0f}" if math.isfinite(count) else significant(count)


def plain(value: object) -> str:
    """Any other cell by its type."""
    if isinstance(value, str):
        return value
    if isinstance(value, bool | np.bool_):
        return "yes" if value else "no"
    return significant(value) if isinstance(value, float) else f"{value:,}"


class Column(NamedTuple):
    """How a column is headed and how its cells are written."""

    label: str
    write: Callable[[Any], str] = plain
    out_of: str | None = None  # the column to show behind a slash instead of on its own


COLUMNS = {
    "length": Column("length (m)"),
    "height": Column("height (m)"),
    "curvature_radius": Column("radius (m)"),
    "runtime": Column("run (ms)", lambda seconds: significant(1e3 * seconds, 3)),
    "std": Column("std", lambda deviation: significant(deviation, 3)),
    "evaluations": Column("evals"),
    "clear": Column("clear", out_of="runs"),
    "gap": Column("gap (%)", above),
    "acted": Column("acted", percent),
    "kept": Column("kept", percent),
    "p": Column("p", probability),
    "p_holm": Column("p (Holm)", probability),
    "a12": Column("A₁₂", two_decimals),
    "mean_rank": Column("mean rank", two_decimals),
    "kendall_w": Column("Kendall's W", two_decimals),
}
"""Columns that need more than their own name and `plain`; `attrs["columns"]` goes before."""


_BROKEN = {"average": "aver- age"}
"""Headings of a terminal that would be wider than what is below them."""


def to_rich(frame: pd.DataFrame, title: str | None = None, caption: str | None = None) -> Table:
    """A table for the terminal, narrow enough for 80 columns.

    Args:
        frame: one of the frames of this package. The columns named in `attrs["group"]` become
            headings above the rows that share them.
        title: replaces the frame's own title.
        caption: replaces the frame's own caption; footnotes stay.
    """
    remarks = [caption or frame.attrs.get("caption", ""), *notes_of(frame)]
    table = Table(
        title=title or frame.attrs.get("title"),
        title_justify="left",
        title_style="bold",
        caption=escape("\n".join(filter(None, remarks))) or None,
        caption_justify="left",
        box=SIMPLE_HEAD,
        padding=0,
        show_edge=False,
        min_width=60,
    )
    group = frame.attrs.get("group", [])
    names = [name for name in shown_columns(frame) if name not in group]
    text = cells_as_text(frame, "[bold]{}[/bold]", escape)
    headings = ["\n".join(_heading(frame, text, row, name) for name in group) for row in text.index]
    for name in names:
        label, side = column_of(frame, name).label, side_of(frame, name)
        label = "\n".join(_BROKEN.get(label, label).split())
        # Where the terminal is too narrow, headings and words wrap, numbers do not.
        table.add_column(label, justify=side, no_wrap=side == "right", overflow="fold")
    previous = ""
    for row, heading in zip(text.index, headings, strict=True):
        if heading != previous:
            table.add_section()
            table.add_row(heading, style="italic")
            previous = heading
        table.add_row(*text.loc[row, names])
    return table


def to_markdown(frame: pd.DataFrame) -> str:
    """A Markdown table, followed by the caption and the footnotes."""
    names = shown_columns(frame)
    text = cells_as_text(frame, "**{}**", lambda cell: cell.replace("|", r"\|"))
    head = [column_of(frame, name).label.replace("|", r"\|") for name in names]
    rule = [{"left": ":---", "right": "---:"}[side_of(frame, name)] for name in names]
    lines = [f"| {' | '.join(row)} |" for row in (head, rule, *text[names].values)]
    notes = [frame.attrs.get("caption", ""), *notes_of(frame)]
    return "\n\n".join(["\n".join(lines), *filter(None, notes)]) + "\n"


def to_html(frame: pd.DataFrame, sortable: bool = False) -> str:
    """A table with title, caption and footnotes; all texts are escaped.

    Args:
        frame: what it holds.
        sortable: for a page with a script and a style sheet of its own: headings are buttons, cells
            carry the bare numbers in `data-value`, sides are classes. Otherwise it stands alone.
    """
    names = shown_columns(frame)
    text = cells_as_text(frame, "<strong>{}</strong>", html.escape)
    look = {name: _look(side_of(frame, name), sortable) for name in names}
    labels = {name: html.escape(column_of(frame, name).label) for name in names}
    if sortable:
        labels = {name: f'<button type="button">{each}</button>' for name, each in labels.items()}
    head = "".join(f'<th scope="col"{look[name]}>{labels[name]}</th>' for name in names)
    rows = "".join(
        "<tr>"
        + "".join(
            f"<td{look[name]}{_number(frame, row, name, sortable)}>{text.at[row, name]}</td>"
            for name in names
        )
        + "</tr>\n"
        for row in frame.index
    )
    title = html.escape(frame.attrs.get("title", ""))
    caption = "" if sortable else f'<caption style="text-align:left"><b>{title}</b></caption>\n'
    notes = [frame.attrs.get("caption", ""), *notes_of(frame)]
    said = "".join(f"<p>{html.escape(note)}</p>\n" for note in notes if note)
    table = f"{caption}<thead><tr>{head}</tr></thead>\n<tbody>\n{rows}</tbody>"
    return f"<div><table>\n{table}\n</table></div>\n{said}"


def _look(side: str, styled: bool) -> str:
    return f' class="{side}"' if styled else f' style="text-align:{side}"'


def _number(frame: pd.DataFrame, row: Any, name: str, wanted: bool) -> str:
    """The bare number of a cell as an attribute; what is no number sorts by its text."""
    if not wanted or side_of(frame, name) != "right":
        return ""
    return f' data-value="{float(frame.at[row, name])!r}"'


def to_csv(frame: pd.DataFrame, path: str | os.PathLike[str]) -> None:
    """Write the bare numbers in full precision, atomically."""
    write_text(path, frame.to_csv(index=False))


def column_of(frame: pd.DataFrame, name: str) -> Column:
    """How a column of a frame is headed and written."""
    return {**COLUMNS, **frame.attrs.get("columns", {})}.get(name, Column(name.replace("_", " ")))


def shown_columns(frame: pd.DataFrame) -> list[str]:
    """The columns that people see: all but those shown behind another one's slash."""
    behind = {column_of(frame, name).out_of for name in frame}
    return [name for name in frame if name not in behind]


def _heading(frame: pd.DataFrame, text: pd.DataFrame, row: Any, name: str) -> str:
    """One line above a group of rows: "scenario-1", "6 obstacles", "1 obstacle"."""
    if side_of(frame, name) != "right":
        return text.at[row, name]
    label = column_of(frame, name).label
    return f"{text.at[row, name]} {label.removesuffix('s') if frame.at[row, name] == 1 else label}"


def side_of(frame: pd.DataFrame, name: str) -> Literal["left", "right"]:
    """Where its cells stand: numbers on the right."""
    return "right" if pd.api.types.is_numeric_dtype(frame[name]) else "left"


def cells_as_text(
    frame: pd.DataFrame, bold: str, escape_text: Callable[[str], str]
) -> pd.DataFrame:
    """The same frame as text, the best cells stressed and the doubtful ones marked."""
    stressed = frame.attrs.get("bold", ())
    marks: dict[Cell, str] = {}
    for letter, note in _lettered(frame):
        for cell in note.cells:
            marks[cell] = marks.get(cell, "") + letter

    def write(row, name) -> str:
        column = column_of(frame, name)
        text = escape_text(column.write(frame.at[row, name]))
        text += f"/{plain(frame.at[row, column.out_of])}" if column.out_of in frame else ""
        text = bold.format(text) if (row, name) in stressed else text
        return text + marks.get((row, name), "")

    cells = {name: [write(row, name) for row in frame.index] for name in frame}
    return pd.DataFrame(cells, index=frame.index, dtype=object)


def notes_of(frame: pd.DataFrame) -> list[str]:
    """The footnotes with their letters."""
    return [f"{letter} {note.text}".strip() for letter, note in _lettered(frame)]


def _lettered(frame: pd.DataFrame) -> list[tuple[str, Footnote]]:
    """Footnotes with their letters; a note without cells has none."""
    letters = iter("ᵃᵇᶜᵈᵉᶠᵍʰⁱʲᵏˡᵐⁿᵒᵖ")
    return [(next(letters) if n.cells else "", n) for n in frame.attrs.get("footnotes", ())]
