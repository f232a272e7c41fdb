"""Who comes first in every scenario, as printed and here."""

import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from scipy import stats

from jaxsusp.report.comparison import paper
from jaxsusp.report.comparison.tables import summary
from jaxsusp.report.drawing.style import INK, legend, line_sample, picture, quiet, styles


def rank_chart(ds: xr.Dataset, metric: str = "average", width: float = 7.09) -> Figure:
    """Ranks of the paper's algorithms by a metric of Table 1, the paper's beside ours.

    Args:
        ds: a comparison.
        metric: one that is better when smaller, such as "min" or "average".
        width: of the figure, inches.
    """
    ds = paper.of_the_paper(ds)
    names = ds["algorithm"].values.tolist()
    printed = paper.table1()
    scenarios = [name for name in ds["scenario"].values.tolist() if name in printed["scenario"]]
    figure = picture(width, 0.42 * width)
    look = styles(names)
    tables = (printed.sel(algorithm=names), summary(ds))
    for axes, table, title in zip(
        figure.subplots(1, 2, sharey=True), tables, ("(a) as printed", "(b) ours"), strict=True
    ):
        places = ranks(table.sel(scenario=scenarios)[metric])
        for name, style in look.items():
            axes.plot(
                range(len(scenarios)), places.sel(algorithm=name), color=style.color,
                ls=style.dash, lw=1.6, marker=style.marker, ms=7, mec="white",
            )  # fmt: skip
        _finish(axes, scenarios, len(names), title)
    figure.axes[0].set_ylabel(f"rank by {metric} fitness", fontsize=8, color=INK)
    legend(figure, [line_sample(style) for style in look.values()])
    return figure


def ranks(values: xr.DataArray) -> xr.DataArray:
    """Rank of every algorithm in every scenario, 1 the least; equal values share their mean."""
    ordered = values.transpose("scenario", "algorithm")
    return ordered.copy(data=stats.rankdata(ordered.values, axis=1, nan_policy="omit"))


def _finish(axes: Axes, scenarios: list[str], count: int, title: str) -> None:
    quiet(axes)
    axes.tick_params(labelsize=7.5)
    axes.set_title(title, loc="left", fontsize=8, color=INK)
    axes.set_xticks(range(len(scenarios)), [name.rpartition("-")[2] for name in scenarios])
    axes.set_xlabel("scenario", fontsize=8, color=INK)
    axes.set_yticks(range(1, count + 1))
    axes.set_ylim(count + 0.4, 0.6)
