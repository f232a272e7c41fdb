"""The environment with its warning areas."""

import jaxsusp as js
from experiments.artefacts import Artefacts
from experiments.contents import Page
from jaxsusp.report.comparison.printed import PAGE
from jaxsusp.report.drawing.scene import obstacle_names
from jaxsusp.report.drawing.warnings import LOAD_KEEPS_OUT, environment
from jaxsusp.report.render import significant

TITLE = "The environment"
PRINTED = "Fig. 4"
DIFFERS = (
    "Our obstacles, as the paper prints no coordinates. A warning area is as wide as the clearance "
    "of the scenario; the paper gives none."
)
MADE = READ = ()
MINUTES = 0.0
FULL = MINIATURE = None
SCENARIO = "scenario-3"


def draw(artefacts: Artefacts) -> Page:
    """One picture."""
    scenario = js.load_scenario(SCENARIO)
    figure = environment(scenario, PAGE)
    limits, payload = scenario.limits, scenario.payload
    figure.set_label(
        f"{SCENARIO}: obstacles with their warning areas (amber, {limits.clearance:g} m wide), the "
        "load at start and goal (red) with its cables and their ends; seen from above also "
        f"{LOAD_KEEPS_OUT}. Obstacles: {', '.join(obstacle_names(scenario))}."
    )
    across = payload.radius + limits.clearance
    text = (
        f"Load, cables and arms keep {limits.clearance:g} m off {len(scenario.obstacles)} "
        f"obstacles. For the centre of a load of {payload.radius:g} m radius that makes "
        f"{significant(across, 2)} m, for the middle of a cable "
        f"{significant(limits.clearance + limits.cable_radius, 2)} m."
    )
    return Page({"environment": figure}, findings=text)
