"""Which algorithms differ over all scenarios: critical differences of mean ranks.

After Demšar, "Statistical comparisons of classifiers over multiple data sets", J. Mach. Learn. Res.
7, 2006: every scenario ranks the algorithms, and two of them differ where their mean ranks are
further apart than chance would put them. Nemenyi's test compares all pairs at once; Wilcoxon's
signed-rank test, corrected by Holm, compares each pair by itself and does not depend on which other
algorithms were there. With few scenarios neither can say much: of six, no pair of four algorithms
can pass Wilcoxon's test after the correction.
"""

from itertools import combinations
from typing import Any

import numpy as np
import pandas as pd
import xarray as xr
from jaxtyping import Float
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from scipy import stats

from jaxsusp.report.comparison.statistics import holm, samples_of, scenario_ranks, vargha_delaney
from jaxsusp.report.drawing.style import INK, QUIET, heading, picture, styles
from jaxsusp.report.render import Column, probability, two_decimals

LEVEL = 0.05
"""Of significance."""


def critical_difference(algorithms: int, scenarios: int, level: float = LEVEL) -> float:
    """Mean ranks further apart than this differ by Nemenyi's test.

    Args:
        algorithms: that are ranked, at least two.
        scenarios: that rank them.
        level: of significance, in (0, 1).
    """
    quantile = stats.studentized_range.ppf(1 - level, algorithms, np.inf)
    return float(quantile / np.sqrt(2) * _deviation(algorithms, scenarios))


def nemenyi(difference: float, algorithms: int, scenarios: int) -> float:
    """p-value of a difference of two mean ranks, corrected for all pairs."""
    ranged = np.sqrt(2) * abs(difference) / _deviation(algorithms, scenarios)
    return float(stats.studentized_range.sf(ranged, algorithms, np.inf))


def wilcoxon(a: Float[np.ndarray, " scenarios"], b: Float[np.ndarray, " scenarios"]) -> float:
    """p-value of Wilcoxon's signed-rank test of two algorithms' medians over the scenarios.

    Signed by which is better, ranked by the relative difference |a - b| / (|a| + |b|): a penalty of
    1000 in one scenario is then no more than a large difference. Equal medians are left out.
    """
    size = np.abs(a) + np.abs(b)
    with np.errstate(invalid="ignore"):
        apart = np.where(np.isinf(size), np.sign(a - b), (a - b) / np.where(size > 0, size, 1))
    apart = apart[np.nan_to_num(apart) != 0]
    if not len(apart):
        return 1.0
    tested: Any = stats.wilcoxon(apart)
    return float(tested.pvalue)


def across_table(ds: xr.Dataset) -> pd.DataFrame:
    """Every two algorithms over all scenarios.

    Returns:
        One row per pair, columns a, b, rank_a and rank_b (mean ranks by median fitness), p_nemenyi,
        p_wilcoxon, p_holm (Wilcoxon's, corrected by Holm) and a12 (mean over the scenarios of the
        probability that a run of a is better than a run of b). Empty where `ranked` says that there
        is nothing to rank.
    """
    columns = ["a", "b", "rank_a", "rank_b", "p_nemenyi", "p_wilcoxon", "p_holm", "a12"]
    placed, rows = scenario_ranks(ds), []
    if ranked(placed):
        count, scenarios = placed.shape
        mean, middle = placed.mean(axis=1).to_dict(), _medians(ds)
        runs = [samples_of(ds, scenario) for scenario in placed]
        for a, b in combinations(placed.index, 2):
            p = nemenyi(mean[a] - mean[b], count, scenarios)
            alone = wilcoxon(middle[a], middle[b])
            effect = np.mean([vargha_delaney(found[a], found[b]) for found in runs])
            rows.append((a, b, mean[a], mean[b], p, alone, np.nan, float(effect)))
    frame = pd.DataFrame(rows, columns=columns)
    frame["p_holm"] = holm(frame["p_wilcoxon"].to_numpy(np.float64))
    frame.attrs["title"] = "Pairs of algorithms over all scenarios"
    frame.attrs["columns"] = {
        "rank_a": Column("mean rank of a", two_decimals),
        "rank_b": Column("of b", two_decimals),
        "p_nemenyi": Column("p (Nemenyi)", probability),
        "p_wilcoxon": Column("p (Wilcoxon)", probability),
    }
    frame.attrs["caption"] = _said(placed) if rows else ""
    return frame


def _said(placed: pd.DataFrame) -> str:
    count, scenarios = placed.shape
    least = min(1.0, count * (count - 1) / 2 * 2.0 ** (1 - scenarios))
    return (
        "Ranks by median fitness. Nemenyi's test of mean ranks is corrected for all pairs: "
        f"at {LEVEL:g} they differ where they are more than "
        f"{critical_difference(count, scenarios):.2f} apart. Wilcoxon's signed-rank test takes "
        f"each pair by itself; of {scenarios} scenarios and {count} algorithms its least p after "
        f"Holm's correction is {least:.2g}. A₁₂: probability that a run of a is better than a run "
        "of b, ties counting half, mean over the scenarios. Scenarios share tasks and obstacles: a "
        "description, not a proof."
    )


def ranked(placed: pd.DataFrame) -> bool:
    """Whether there are ranks to compare: three algorithms and two scenarios, none missing."""
    algorithms, scenarios = placed.shape
    return bool(algorithms >= 3 and scenarios >= 2 and placed.notna().all(axis=None))


def cliques(mean: pd.Series, apart: float) -> list[tuple[str, ...]]:
    """Groups of algorithms whose mean ranks are no further apart; none lies in another.

    Args:
        mean: mean rank by algorithm.
        apart: the critical difference.
    """
    order = mean.sort_values(kind="stable")
    found: list[tuple[str, ...]] = []
    for first in range(len(order)):
        within = order.iloc[first:][order.iloc[first:] - order.iloc[first] <= apart]
        names = tuple(map(str, within.index))
        if len(names) > 1 and not (found and set(names) <= set(found[-1])):
            found.append(names)
    return found


def diagram(ds: xr.Dataset, width: float = 8.0) -> Figure | None:
    """Mean ranks on a line; bars join those that do not differ by Nemenyi's test.

    Args:
        ds: a whole comparison.
        width: of the figure, inches.

    Returns:
        The figure; None where there is nothing to rank, see `ranked`.
    """
    placed = scenario_ranks(ds)
    if not ranked(placed):
        return None
    count, scenarios = placed.shape
    mean = placed.mean(axis=1).sort_values(kind="stable")
    apart = critical_difference(count, scenarios)
    groups, half = cliques(mean, apart), -(-count // 2)
    figure = picture(width, 1.35 + 0.22 * (half + len(groups)))
    axes = figure.subplots()
    axes.set_axis_off()
    axes.set_xlim(0.3, count + 0.7)
    depth = 0.5 * len(groups) + 0.5
    axes.set_ylim(-depth - 0.9 * half, 2.2)
    _scale(axes, count)
    shown = min(apart, count - 1.0)
    axes.plot([1, 1 + shown], [1.3, 1.3], color=INK, lw=1.5, marker="|", ms=8)
    text = f"critical difference {apart:.2f}" + (" (more than the scale)" if apart > shown else "")
    axes.text(1 + shown / 2, 1.5, text, ha="center", va="bottom", fontsize=8, color=INK)
    for level, group in enumerate(groups):
        ends = mean[group[0]] - 0.04, mean[group[-1]] + 0.04
        axes.plot(ends, [-0.5 * (level + 1)] * 2, color=INK, lw=3.5, solid_capstyle="butt")
    look = styles(mean.index)
    for place, (name, rank) in enumerate(mean.items()):
        best = place < half
        row = place if best else count - 1 - place
        y, x = -depth - 0.9 * (row + 0.4), 0.75 if best else count + 0.25
        style = look[str(name)]
        axes.plot([rank, rank, x], [0, y, y], color=style.color, lw=1.3, ls=style.dash)
        axes.plot(rank, 0, style.marker, color=style.color, mec="white", ms=7, zorder=5)
        axes.text(
            x + (-0.05 if best else 0.05), y, f"{style.label}  {rank:.2f}", fontsize=9,
            ha="right" if best else "left", va="center", color=INK, clip_on=False,
        )  # fmt: skip
    heading(figure, f"Mean ranks by median fitness over {scenarios} scenarios")
    figure.set_label(
        f"Mean ranks of {count} algorithms by median fitness over {scenarios} scenarios, 1 the "
        f"best. A bar joins algorithms that do not differ at {LEVEL:g} by Nemenyi's test."
    )
    return figure


def _scale(axes: Axes, count: int) -> None:
    """The line of ranks with its numbers."""
    axes.plot([1, count], [0, 0], color=QUIET, lw=1.0, zorder=1)
    for rank in range(1, count + 1):
        axes.plot([rank, rank], [0, 0.15], color=QUIET, lw=1.0, zorder=1)
        axes.text(rank, 0.3, f"{rank}", ha="center", va="bottom", fontsize=8, color=QUIET)


def _deviation(algorithms: int, scenarios: int) -> float:
    return float(np.sqrt(algorithms * (algorithms + 1) / (6 * scenarios)))


def _medians(ds: xr.Dataset) -> dict[str, np.ndarray]:
    """Median fitness in every scenario, by algorithm."""
    found = [samples_of(ds, scenario) for scenario in ds["scenario"].values.tolist()]
    return {name: np.array([np.median(each[name]) for each in found]) for name in found[0]}
