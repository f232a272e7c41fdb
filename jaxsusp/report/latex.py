"""Tables for papers: a frame as LaTeX in plain ASCII, whatever characters it holds."""

import re
import unicodedata

import pandas as pd

from jaxsusp.report.render import cells_as_text, column_of, notes_of, shown_columns, side_of

NEEDED = r"% needs \usepackage{array,booktabs,longtable}"
LONGEST = 40
"""Rows above which a table is broken over pages."""

WIDE = 24
"""Characters above which a column of text gets a width of its own, in which it wraps."""


def to_latex(frame: pd.DataFrame, label: str = "") -> str:
    r"""A table (booktabs) with title, caption and footnotes below it.

    Args:
        frame: one of the frames that `report.render` writes.
        label: for `\ref`; none where empty.
    """
    names = shown_columns(frame)
    text = cells_as_text(frame, r"\textbf{{{}}}", _escaped)
    rows = [_ascii(" & ".join(row)) + r" \\" for row in text[names].values]
    head = " & ".join(latex(column_of(frame, name).label) for name in names) + r" \\"
    notes = [latex(note) for note in (frame.attrs.get("caption", ""), *notes_of(frame)) if note]
    below = [rf"{{\raggedright\footnotesize {note}\par}}" for note in notes]
    caption = rf"\caption{{{latex(frame.attrs.get('title', ''))}}}"
    caption += rf"\label{{{label}}}" if label else ""
    sides = _sides(frame, names)
    top = [r"\toprule", head, r"\midrule"]
    if len(rows) > LONGEST:
        lines = [
            rf"\begin{{longtable}}{{{sides}}}",
            caption + r" \\",
            *top,
            r"\endfirsthead",
            *top,
            r"\endhead",
            r"\bottomrule",
            r"\endfoot",
            *rows,
            r"\end{longtable}",
            *below,
        ]
    else:
        lines = [
            r"\begin{table}",
            r"\centering",
            caption,
            rf"\begin{{tabular}}{{{sides}}}",
            *top,
            *rows,
            r"\bottomrule",
            r"\end{tabular}",
            *([r"\par\smallskip"] if below else []),
            *below,
            r"\end{table}",
        ]
    return "\n".join([NEEDED, *lines]) + "\n"


def latex(text: str) -> str:
    """A text in ASCII; code between backticks is set in typewriter type."""
    return _ascii(_escaped(text))


def _sides(frame: pd.DataFrame, names: list[str]) -> str:
    """Columns; those with long texts share what the others leave of the line."""
    longest = {
        name: max((len(str(cell)) for cell in frame[name]), default=0)
        for name in names
        if side_of(frame, name) == "left"
    }
    wide = {name: length**0.5 for name, length in longest.items() if length > WIDE}
    left = max(0.94 - 0.09 * (len(names) - len(wide)) - 0.02 * len(wide), 0.4)
    total = sum(wide.values())
    return "".join(
        rf">{{\raggedright\arraybackslash}}p{{{left * wide[name] / total:.2f}\linewidth}}"
        if name in wide
        else side_of(frame, name)[0]
        for name in names
    )


_SPECIAL = {each: rf"\{each}" for each in "&%$#_{}"} | {
    "\\": r"\textbackslash{}",
    "~": r"\textasciitilde{}",
    "^": r"\textasciicircum{}",
    "<": "$<$",
    ">": "$>$",
    "|": r"\textbar{}",
    '"': "''",
}

_SIGNS = {
    "∞": r"$\infty$", "−": "$-$", "≤": r"$\le$", "≥": r"$\ge$", "±": r"$\pm$", "≈": r"$\approx$",
    "×": r"$\times$", "·": r"$\cdot$", "°": r"$^\circ$", "→": r"$\to$", "←": r"$\leftarrow$",
    "√": r"$\sqrt{}$", "½": r"$\frac12$", "¼": r"$\frac14$", "‖": r"$\|$", "ϑ": r"$\vartheta$",
    "µ": r"$\mu$", "–": "--", "—": "---", "…": r"\dots{}", "“": "``", "”": "''", "‘": "`",
    "’": "'", "§": r"\S{}", "\N{NO-BREAK SPACE}": "~",
}  # fmt: skip

_ACCENTS = {
    "\u0300": "`",
    "\u0301": "'",
    "\u0302": "^",
    "\u0303": "~",
    "\u0308": '"',
    "\u030c": "v",
}


def _escaped(text: str) -> str:
    """What LaTeX would read as its own; whatever is not ASCII stays for `_ascii`."""
    whole = "".join(_SPECIAL.get(each, each) for each in text)
    whole = re.sub(r"\\textbar{}(\w)\\textbar{}", r"$\\lvert \1\\rvert$", whole)
    whole = re.sub(r"`([^`]*)`", r"\\texttt{\1}", whole)
    return re.sub(r"(?<![\w.)\-])-(?=[\d.])", "$-$", whole)  # a sign, no hyphen


def _ascii(text: str) -> str:
    for kind, command in (("<super>", "super"), ("<sub>", "sub")):
        raised = "".join({each for each in text if _is(kind, each)})
        if raised:
            text = re.sub(
                f"[{re.escape(raised)}]+",
                lambda found, command=command: (
                    rf"\text{command}script{{{''.join(map(_plain_letter, found[0]))}}}"
                ),
                text,
            )
    return "".join(each if each.isascii() else _sign(each) for each in text)


def _is(kind: str, character: str) -> bool:
    return unicodedata.decomposition(character).startswith(kind)


def _plain_letter(character: str) -> str:
    """The letter or digit that is raised or lowered."""
    return chr(int(unicodedata.decomposition(character).split()[-1], 16))


def _sign(character: str) -> str:
    """One character that is not ASCII; unknown ones stay as they are."""
    if character in _SIGNS:
        return _SIGNS[character]
    name = unicodedata.name(character, "").split()
    if name[:1] == ["GREEK"] and name[2:3] == ["LETTER"] and len(name) == 4:
        command = name[3].lower()
        return rf"$\{command.capitalize() if name[1] == 'CAPITAL' else command}$"
    letter, *accents = unicodedata.normalize("NFD", character)
    if len(accents) == 1 and accents[0] in _ACCENTS and letter.isascii():
        return rf"\{_ACCENTS[accents[0]]}{{{letter}}}"
    return character
