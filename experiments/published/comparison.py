"""Table 1: the four algorithms on the six scenarios, beside the printed table."""

from typing import Any, NamedTuple

import xarray as xr

import jaxsusp as js
from experiments.artefacts import Artefacts
from experiments.contents import Page, Work
from experiments.words import listed
from jaxsusp.optim.choices import PUBLISHED
from jaxsusp.report.comparison import paper
from jaxsusp.report.comparison.across import LEVEL, across_table, diagram
from jaxsusp.report.comparison.printed import PAGE
from jaxsusp.report.comparison.ranks import rank_chart, ranks
from jaxsusp.report.comparison.runningtime import running_time_table
from jaxsusp.report.comparison.statistics import friedman, pairwise
from jaxsusp.report.comparison.tables import (
    comparison_table,
    has_ratios,
    printed_table,
    ratio_table,
    summary,
)
from jaxsusp.report.render import probability, significant

TITLE = "Comparison of the algorithms"
PRINTED = "Table 1"
DIFFERS = (
    "The paper prints no coordinates of obstacles: ours are six scenarios of our own, so ratios "
    "and rankings compare, absolute values do not."
)
MADE = READ = ("comparison",)
MINUTES = 2.0
OTHERS = ("dbo", "pso", "ga")
"""What SDBO is compared with, the one it improves on first."""


class Settings(NamedTuple):
    """Of `jaxsusp.compare`."""

    scenarios: tuple[str, ...] = js.scenarios()
    algorithms: tuple[str, ...] = (*PUBLISHED, "cmaes", "routed")
    runs: int = 20
    iterations: int = 500
    population: int = 30
    seed: int = 0


FULL = Settings()
MINIATURE = Settings(("scenario-1",), ("pso", "dbo", "sdbo"), 2, 20)


def make(settings: Settings, work: Work) -> None:
    """One comparison; it is what Figs. 7 to 12 are drawn from, too."""
    ds = js.compare(**settings._asdict(), output=work.folder, resume=True)
    work.artefacts.keep("comparison", ds)


def draw(artefacts: Artefacts) -> Page:
    """Our table, the printed one, ratios beside each other, ranks, and tests."""
    ds = artefacts.comparison("comparison")
    four, names = paper.of_the_paper(ds), ds["scenario"].values.tolist()
    tables = {"table-1": comparison_table(ds), "table-1-printed": printed_table(names)}
    for other in OTHERS:
        ratios = ratio_table(four, other)
        if has_ratios(ratios):
            tables[f"table-1-sdbo-{other}"] = ratios
    tables |= {
        "table-1-across": across_table(four),
        "table-1-pairs": pairwise(four),
        "table-1-running-times": running_time_table(ds),
    }
    figures = {"table-1-ranks": rank_chart(ds), "table-1-critical": diagram(four, PAGE)}
    figures["table-1-ranks"].set_label(
        "Rank of each algorithm by average fitness in every scenario, as printed and here."
    )
    return Page(
        {name: figure for name, figure in figures.items() if figure is not None},
        {name: frame for name, frame in tables.items() if not frame.empty},
        findings(ds),
    )


def findings(ds: xr.Dataset) -> str:
    """Whether the paper's ranking is found here, and by how much SDBO is better or worse."""
    four = paper.of_the_paper(ds)
    count = ds.sizes["scenario"]
    text = (
        f"By mean rank of the average fitness the order is {_order(paper.table1())} in the paper "
        f"and {_order(summary(four))} here."
    )
    frames: dict[str, Any] = {other: ratio_table(four, other) for other in OTHERS}
    for other, frame in frames.items():
        if not has_ratios(frame):
            continue
        of = {source: frame[frame["source"] == source] for source in ("paper", "ours")}
        better = {source: int((rows["average"] < 1).sum()) for source, rows in of.items()}
        chance = of["ours"]["a12"].mean()
        text += (
            f" SDBO's average is below {other.upper()}'s in {better['paper']} of "
            f"{int(of['paper']['average'].notna().sum())} printed scenarios and in "
            f"{better['ours']} of our {count}; a run of it beats one of {other.upper()} with a "
            f"probability of {chance:.2f} here."
        )
    return f"{text} {_tested(four)} {_cost(four)} {paper.lacking(ds)}".strip()


def _order(table: xr.Dataset) -> str:
    """Algorithms by mean rank, best first."""
    mean = ranks(table["average"]).mean("scenario").to_series().sort_values(kind="stable")
    return ", ".join(f"{str(name).upper()} ({rank:.1f})" for name, rank in mean.items())


def _tested(four: xr.Dataset) -> str:
    """Which pairs differ over all scenarios."""
    frame = across_table(four)
    if frame.empty:
        return ""
    apart: Any = frame[frame["p_nemenyi"] < LEVEL]
    pairs = [
        f"{better.upper()} from {worse.upper()}, which is worse"
        for row in apart.itertuples()
        for better, worse in [(row.a, row.b) if row.rank_a < row.rank_b else (row.b, row.a)]
    ]
    test = friedman(four).iloc[0]
    p = probability(test["p"])
    told = (
        f"tells {listed(pairs)}, and no other two apart" if pairs else "tells no two of them apart"
    )
    return (
        "Of ranks by median fitness (those above are by average), Friedman's test gives "
        f"χ² = {significant(test['statistic'], 3)}, "
        f"{f'p {p}' if p.startswith('<') else f'p = {p}'}; Nemenyi's at {LEVEL:g} "
        f"{told}: a description, not a proof, for scenarios share "
        "obstacles."
    )


def _cost(four: xr.Dataset) -> str:
    """How many evaluations the algorithms spend."""
    spent = four["evaluations"].max("scenario").to_series()
    if "sdbo" not in spent or len(spent) < 2:
        return ""
    rest = spent.drop("sdbo").max()
    return (
        f"SDBO spends {spent['sdbo']:,} fitness evaluations a run, the others up to {rest:,}: with "
        "equal iterations, as in the paper, it is not an equal race."
    )
