"""The best trajectories of the four algorithms in every scenario."""

from experiments.artefacts import Artefacts
from experiments.contents import Page
from experiments.words import winners
from jaxsusp.report.comparison import paper
from jaxsusp.report.comparison.best import scenario_of
from jaxsusp.report.comparison.gaps import clear_runs, runs_made
from jaxsusp.report.comparison.printed import PAGE
from jaxsusp.report.drawing.scene import obstacle_names, scene

TITLE = "The best trajectories"
PRINTED = "Fig. 7"
DIFFERS = (
    "The paper's obstacles are not printed, ours are our own; views are chosen so that obstacles "
    "hide least, and what they hide is thin and pale."
)
MADE = ()
READ = ("comparison",)
MINUTES = 0.0
FULL = MINIATURE = None


def draw(artefacts: Artefacts) -> Page:
    """A view and the top view of every scenario."""
    ds = paper.of_the_paper(artefacts.comparison("comparison"))
    figures = {}
    for name in ds["scenario"].values.tolist():
        scenario = scenario_of(ds, name)
        figure = scene(scenario, ds.sel(scenario=name), width=PAGE)
        figure.set_label(
            f"{name}: the best of {runs_made(ds)} of each algorithm, with its fitness; start and "
            "goal with the cables there (solid and dashed). Obstacles: "
            f"{', '.join(obstacle_names(scenario))}."
        )
        figures[f"trajectories-{name}"] = figure
    return Page(figures, findings=findings(ds))


def findings(ds) -> str:
    """Whose best is shortest, lowest in fitness and clear, in how many scenarios."""
    run = ds["fitness"].argmin("run")
    best = ds[["fitness", "terms"]].isel(run=run)
    count = ds.sizes["scenario"]
    told = []
    for value, what in (
        (best["fitness"], "the least fitness"),
        (best["terms"].sel(term="length"), "the shortest way"),
        (best["terms"].sel(term="height"), "the least height"),
    ):
        names = ds["algorithm"].values[value.argmin("algorithm").values].tolist()
        order = ds["algorithm"].values.tolist()
        told.append(f"{winners(names, what, order)} of {count}")
    clear = clear_runs(ds).isel(run=run)
    bad = int((~clear).sum())
    verdict = (
        "All of these best runs are clear"
        if bad == 0
        else f"{bad} of these {clear.size} best runs hit something or break a limit"
    )
    return f"Of the best runs, {'; '.join(told)} scenarios. {verdict}. {paper.lacking(ds)}".strip()
