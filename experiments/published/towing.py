"""The system and its cables on the way that SDBO finds, and their lengths and tensions."""

import numpy as np

from experiments.artefacts import Artefacts
from experiments.contents import Page
from jaxsusp.errors import InputError
from jaxsusp.planning.plan import Plan
from jaxsusp.report.comparison.best import best_plan
from jaxsusp.report.comparison.printed import PAGE
from jaxsusp.report.plan import figures
from jaxsusp.report.plan.scene import scene
from jaxsusp.report.render import significant
from jaxsusp.verify.constraints import INSTANTS

TITLE = "The system on its way"
PRINTED = "Figs. 9, 10"
DIFFERS = (
    "SDBO's best run on our scenario 1, whose ends stay where they are; tensions hold the inertia "
    "of the load, which the paper neglects at times."
)
MADE = ()
READ = ("comparison",)
MINUTES = 0.0
FULL = MINIATURE = None
SCENARIO, ALGORITHM = "scenario-1", "sdbo"
PRINTED_TENSIONS = (1.5928, 96.5688)
"""N; the least and the greatest that the paper's text names."""


def draw(artefacts: Artefacts) -> Page:
    """The system in its room, and the cables over time."""
    ds = artefacts.comparison("comparison", scenario=[SCENARIO], algorithm=[ALGORITHM])
    plan = best_plan(ds, SCENARIO, ALGORITHM)
    if plan is None:
        raise InputError(f"comparison: no run of {ALGORITHM} on {SCENARIO} found anything")
    way, cables = scene(plan, PAGE), figures.cables(plan, PAGE)
    way.set_label("Fig. 9: the load in nine poses of its way, the cables in each, and the robots.")
    cables.set_label("Fig. 10: length and tension of every cable with their limits.")
    return Page({"towing": way, "towing-cables": cables}, findings=findings(plan))


def findings(plan: Plan) -> str:
    """Whether limits and clearances are kept, and how the tensions compare."""
    loads = plan.loads_at(np.linspace(0, plan.law.duration, INSTANTS))
    low, high = plan.scenario.limits.tension
    least, most = loads.tensions.min(), loads.tensions.max()
    kept = low <= least and most <= high
    lengths = loads.lengths
    trend = ", ".join(
        f"cable {k + 1} {'longer' if lengths[-1, k] > lengths[0, k] else 'shorter'} "
        f"({significant(lengths[0, k], 3)} to {significant(lengths[-1, k], 3)} m)"
        for k in range(lengths.shape[1])
    )
    clear = (
        f"The plan is certified clear at every instant, by {significant(plan.clearance, 2)} m at "
        "least"
        if plan.feasible
        else f"The real curve is refused: {'; '.join(plan.reasons)}"
    )
    start, bases = plan.scenario.task.start, [robot.base for robot in plan.scenario.robots]
    near = int(np.argmin([np.hypot(b[0] - start[0], b[1] - start[1]) for b in bases]))
    nearer = least > PRINTED_TENSIONS[0] and most < PRINTED_TENSIONS[1]
    shorter = lengths[-1, 0] < lengths[0, 0]
    return (
        f"{clear}. Tensions lie between {significant(least, 3)} and {significant(most, 3)} N, "
        f"{'within' if kept else 'not within'} {low:g} to {high:g} N; the paper's text names "
        f"{PRINTED_TENSIONS[0]:g} and {PRINTED_TENSIONS[1]:g} N for its own, so its system works "
        f"{'nearer to' if nearer else 'as near'} the limits. From start to goal, {trend}. In the "
        "paper cable 1 grows shorter and its "
        f"robot is the furthest from the start, {'as here' if shorter else 'unlike here'}: of the "
        f"bases that it prints, that of robot {near + 1} is the nearest to the start."
    )
