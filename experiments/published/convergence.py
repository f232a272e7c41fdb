"""Convergence of the average fitness, and the least of the runs."""

import numpy as np

from experiments.artefacts import Artefacts
from experiments.contents import Page
from jaxsusp.report.comparison import paper
from jaxsusp.report.comparison.gaps import runs_made
from jaxsusp.report.comparison.printed import average_convergence, minima
from jaxsusp.report.render import significant

TITLE = "Convergence and the least fitness"
PRINTED = "Figs. 11, 12"
DIFFERS = (
    "Fig. 11 counts iterations, in which SDBO evaluates about three times as often as the others; "
    "beside it are fitness evaluations. Of Fig. 12, all runs are shown with their least."
)
MADE = ()
READ = ("comparison",)
MINUTES = 0.0
FULL = MINIATURE = None
SCENARIO = "scenario-1"


def draw(artefacts: Artefacts) -> Page:
    """Curves, and points of all runs."""
    ds = paper.of_the_paper(artefacts.comparison("comparison", scenario=[SCENARIO]))
    curves, least = average_convergence(ds, SCENARIO), minima(ds, SCENARIO)
    curves.set_label(
        f"Fig. 11: {SCENARIO}, best fitness so far, mean of {runs_made(ds)}, against iterations "
        "as the paper has it and against fitness evaluations."
    )
    least.set_label(
        f"Fig. 12: {SCENARIO}, (a) every run and the least of them; (b) least, average (mark) "
        "and greatest of 20 runs as Table 1 prints them for the paper's own scenario 1."
    )
    return Page({"convergence": curves, "minima": least}, findings=findings(ds))


def findings(ds) -> str:
    """How far down, how soon, and what SDBO gains on DBO in both."""
    cell = ds.sel(scenario=SCENARIO)
    least, mean = cell["fitness"].min("run"), cell["fitness"].mean("run")
    names = ds["algorithm"].values.tolist()
    order = sorted(names, key=lambda name: least.sel(algorithm=name).item())
    told = ", ".join(
        f"{name.upper()} {significant(least.sel(algorithm=name).item())}" for name in order
    )
    text = f"The least of {runs_made(ds)} on {SCENARIO}: {told}. "
    history = cell["history"].mean("run").values
    settled = []
    for name, curve in zip(names, history, strict=True):
        curve = curve[np.isfinite(curve)]
        within = 1 + int(np.argmax(curve <= 1.05 * curve[-1]))
        settled.append(f"{name.upper()} {within}")
    text += f"Iterations until the mean is within 5 % of its end: {', '.join(settled)}. "
    if {"sdbo", "dbo"} <= set(names):
        printed = paper.ratios(paper.table1()).sel(scenario=SCENARIO)
        for ours, metric, what in ((least, "min", "least"), (mean, "average", "average")):
            ratio = (ours.sel(algorithm="sdbo") / ours.sel(algorithm="dbo")).item()
            change = 100 * (1 - ratio)
            words = f"{abs(change):.1f} % {'below' if change > 0 else 'above'}"
            text += (
                f"SDBO's {what} fitness is {words} DBO's; the paper prints "
                f"{100 * (1 - printed[metric].item()):.2f} % below, for an obstacle field of its "
                "own. "
            )
    return (text + paper.lacking(ds)).strip()
