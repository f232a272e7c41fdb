"""The configuration of the system, with the paper's letters."""

import jaxsusp as js
from experiments.artefacts import Artefacts
from experiments.contents import Page
from jaxsusp.report.drawing.configuration import configuration

TITLE = "The system and its letters"
PRINTED = "Fig. 1"
DIFFERS = (
    "Drawn from the numbers of a scenario, with the paper's bases and links; the load is drawn six "
    "times as large as it is, so that its three attachments can be told apart."
)
MADE = READ = ()
MINUTES = 0.0
FULL = MINIATURE = None
SCENARIO, SIZE = "rim", 6.0


def draw(artefacts: Artefacts) -> Page:
    """One picture."""
    scenario = js.load_scenario(SCENARIO)
    figure = configuration(scenario, SIZE)
    figure.set_label(
        "Robots k with bases O_k, links a_k1 to a_k3 and joint angles φ_k1 to φ_k3; cables L_k "
        "from their ends P_k to the points B_k of the load; frames O_E of the world and O_B of the "
        "load."
    )
    payload, robot = scenario.payload, scenario.robots[0]
    text = (
        f"{len(scenario.robots)} robots with links of "
        f"{', '.join(f'{each:g}' for each in robot.links)} m hold a load of {payload.mass:g} kg, "
        f"{payload.radius:g} m in radius and {payload.height:g} m high, at "
        f"{len(payload.attachments)} points of its rim, {SIZE:g} times enlarged here. In the "
        "benchmark they meet at one hook."
    )
    return Page({"system": figure}, findings=text)
