"""A panel and a wall that no fixed ends get the cables past, and ends that move (Eq. 20).

On the straight way of the example "hybrid": contacts with the given ends, the search for ends that
stay, the ends of least variance, and the finished plan with certificate, simulation and pictures.
"""

import numpy as np
from rich.console import Console

import jaxsusp as js
from jaxsusp.optim.devices import configure
from jaxsusp.report.plan.folder import write_plan

SCENARIO = "hybrid"
FANS = ((9, 10.0), (25, 18.0), (25, 30.0))  # candidates per cable, degrees to every side
SAMPLES, WAYPOINTS = 40, 5
MARGIN = 0.015  # m, of cables beyond what is required: the real curve is not the polyline
OUTPUT = "results/cable-avoidance"


def main() -> None:
    """Print what happens with ends that stay and with ends that move; write the plan."""
    configure()
    console = Console()
    scenario = js.load_scenario(SCENARIO)
    fixed = scenario.model_copy(update={"drive": "cable"})
    line = np.linspace(scenario.task.start, scenario.task.goal, WAYPOINTS + 2)[1:-1]
    given = js.plan_through(fixed, line)
    way = given.path
    console.print("given ends, at rest:", *given.reasons, sep="\n  ")
    for fan, angle in FANS:
        found = js.fixed_ends(fixed, way, fan, angle)
        verdict = "found" if found.feasible else found.reason
        console.print(f"other fixed ends, {fan} per cable within {angle:g}°: {verdict}")

    led = js.moving_ends(scenario, way, margin=MARGIN)
    turned = np.rad2deg(np.abs(led.angles).max())
    console.print(
        f"moving ends: {led.reason or 'clear'}; Eq. 20 {led.costs[0]:.3f} after the first pass, "
        f"{led.costs[-1]:.3f} after {len(led.costs)}, {led.cost:.3f} smoothed; cables turn by up "
        f"to {turned:.1f}°"
    )
    plan = js.plan_through(scenario, line, led.ends, SAMPLES)
    checked = js.verify_plan(plan)
    seen = checked.simulation
    assert seen is not None
    console.print(
        f"the plan: {'verified' if checked.ok else checked.reasons}, least clearance "
        f"{plan.clearance:.3f} m; simulated {1e3 * seen.tracking_error:.2f} mm and "
        f"{100 * seen.tension_error:.2f} % off"
    )
    for file in write_plan(plan, OUTPUT):
        console.print(f"wrote {file}")


if __name__ == "__main__":
    main()
