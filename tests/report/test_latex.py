"""Tables for papers: ASCII that LaTeX reads."""

import pandas as pd
import pytest

from jaxsusp.report.latex import LONGEST, latex, to_latex
from jaxsusp.report.render import Column, Footnote


@pytest.mark.parametrize(
    ("text", "written"),
    [
        ("50 % & more_of #1", r"50 \% \& more\_of \#1"),
        ("A₁₂, 10⁻¹⁶ m²", r"A\textsubscript{12}, 10\textsuperscript{$-$16} m\textsuperscript{2}"),
        ("κ, χ, Σ, ϑ → ∞", r"$\kappa$, $\chi$, $\Sigma$, $\vartheta$ $\to$ $\infty$"),
        ("“Â” ½ °", r"``\^{A}'' $\frac12$ $^\circ$"),
        ("|a| along x", r"$\lvert a\rvert$ along x"),
        ("run `make x_y`", r"run \texttt{make x\_y}"),
        ("(0.1, -1.990) of scenario-1 at 1e-05", "(0.1, $-$1.990) of scenario-1 at 1e-05"),
    ],
)
def test_every_character_is_ascii_of_the_same_meaning(text, written):
    assert latex(text) == written


def table(rows: int) -> pd.DataFrame:
    frame = pd.DataFrame(
        {"name": ["a long text about what a claim says"] * rows, "x": [0.5] * rows}
    )
    frame.attrs["title"] = "Some"
    frame.attrs["columns"] = {"x": Column("|x| (m³)")}
    frame.attrs["bold"] = [(0, "x")]
    frame.attrs["footnotes"] = [Footnote("Half.", frozenset({(0, "x")}))]
    return frame


def test_a_short_table_floats():
    text = to_latex(table(2), "tab:some")
    assert text.isascii()
    assert r"\caption{Some}\label{tab:some}" in text
    assert r"\begin{table}" in text
    assert r"\centering" in text
    assert r"\textbf{0.5000}\textsuperscript{a} \\" in text
    assert r"\textsuperscript{a} Half." in text
    assert r"\linewidth}r}" in text  # the text wraps, the numbers do not


def test_a_long_table_is_broken_over_pages():
    text = to_latex(table(LONGEST + 1))
    assert r"\begin{longtable}" in text
    assert r"\label" not in text
    assert text.count(r"name & $\lvert x\rvert$ (m\textsuperscript{3}) \\") == 2
