"""Rows of estimates: where marks and lines are."""

import numpy as np
import pytest

from jaxsusp.report.drawing.intervals import Estimates, Look, rows_of_intervals
from jaxsusp.report.drawing.style import picture

pytestmark = pytest.mark.fast


def test_every_series_has_a_mark_and_a_line_in_every_row():
    axes = picture(3.0, 2.0).subplots()
    middle = np.array([1.0, -2.0])
    looks = [Look("a", "#0072B2", "o"), Look("b", "#C43C00", "D", filled=False)]
    series = [Estimates(look, middle + i, middle - 1, middle + 1) for i, look in enumerate(looks)]
    rows_of_intervals(axes, ["one", "two"], series)
    marks = [line for line in axes.lines if line.get_marker() in ("o", "D")]
    assert [line.get_xdata().tolist() for line in marks] == [[1, -2], [2, -1]]
    first, second = (line.get_ydata() for line in marks)
    assert (first < second).all(), "the first series is the upper one"
    assert (np.abs(first - [0, 1]) < 0.5).all(), "all of a row is within it"
    assert marks[1].get_markerfacecolor() == "white"
    assert [text.get_text() for text in axes.get_yticklabels()] == ["one", "two"]
    low, high = axes.get_ylim()
    assert low > high, "rows are read from the top"
