"""Plans for fresh scenes, each checked densely by signed distances of points in closed form.

Run `python experiments/random_plans.py`; the settings are the constants below. Prints a line per
scene; the distances are not those of the certificate, which come from MuJoCo and support functions.
"""

import numpy as np

import jaxsusp as js
from jaxsusp.optim.devices import configure
from jaxsusp.planning.plan import Plan
from jaxsusp.verify.simulation import simulate

SEEDS = range(10)
OBSTACLES = 8
INSTANTS = 2001
ALONG = np.linspace(0, 1, 200)[:, None]


def signed_distance(obstacle, points: np.ndarray) -> np.ndarray:
    """Exact outside, negative inside (m)."""
    q = points - np.array(obstacle.center)
    match obstacle.kind:
        case "box":
            yaw = np.deg2rad(obstacle.yaw_deg)
            turned = np.cos(yaw) * q[..., 0] + np.sin(yaw) * q[..., 1]
            across = np.cos(yaw) * q[..., 1] - np.sin(yaw) * q[..., 0]
            away = np.abs(np.stack([turned, across, q[..., 2]], axis=-1))
            gap = away - np.array(obstacle.size) / 2
        case "cylinder":
            beside = np.hypot(q[..., 0], q[..., 1]) - obstacle.radius
            gap = np.stack([beside, np.abs(q[..., 2]) - obstacle.height / 2], axis=-1)
        case _:
            return np.linalg.norm(q, axis=-1) - obstacle.radius
    outside = np.linalg.norm(np.maximum(gap, 0), axis=-1)
    return np.where((gap <= 0).all(axis=-1), gap.max(axis=-1), outside)


def surface_of_load(scenario: js.Scenario) -> np.ndarray:
    """Points of the load's surface about its centre (m)."""
    angle = np.linspace(0, 2 * np.pi, 16, endpoint=False)
    ring = scenario.payload.radius * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    levels = scenario.payload.height * np.linspace(-0.5, 0.5, 5)
    return np.concatenate([np.column_stack([ring, np.full(16, z)]) for z in levels])


def clearances(plan: Plan) -> tuple[float, float]:
    """Least distances of load and cables from all obstacles (m), by dense sampling."""
    scenario, load, cables = plan.scenario, np.inf, np.inf
    center = plan.at(np.linspace(0, scenario.task.duration, INSTANTS)).position[:, None]
    hook = center + np.array([0, 0, scenario.payload.height / 2])
    for obstacle in scenario.obstacles:
        load = min(load, signed_distance(obstacle, center + surface_of_load(scenario)).min())
        for end in plan.ends:
            points = hook + ALONG * (end - hook)
            cables = min(cables, signed_distance(obstacle, points).min())
    return float(load), float(cables) - scenario.limits.cable_radius


def main() -> None:
    """Draw, plan, check, print."""
    configure()
    returned = clear = 0
    for seed in SEEDS:
        scenario = js.random_scenario(seed, OBSTACLES)
        plan = js.plan(scenario, seed=seed)
        load, cables = clearances(plan)
        truly = min(load, cables) >= scenario.limits.clearance - 1e-6
        returned += plan.feasible
        clear += plan.feasible and truly
        told = "feasible" if plan.feasible else f"refused ({'; '.join(plan.reasons)})"
        problems = simulate(plan.rigging).problems(plan.scenario.limits)
        print(
            f"{scenario.name}: {told}; load {load:.4f} m, cables {cables:.4f} m from obstacles, "
            f"certificate {plan.clearance:.4f} m; simulation: {problems}",
            flush=True,
        )
    print(f"{returned} of {len(SEEDS)} scenes planned, {clear} of these truly clear")


if __name__ == "__main__":
    main()
