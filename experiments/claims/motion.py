"""Claims about Figs. 8 to 10 and the discussion: how the load moves, and what that asks of cables.

The best run of every algorithm is driven as a finished plan is: a smooth curve through its samples,
from rest to rest in the scenario's duration with least jerk.
"""

import json
from collections.abc import Iterator
from functools import cache

import numpy as np
import xarray as xr

import jaxsusp as js
from experiments.claims.claim import CHECKS, PRINT, Claim, Evidence
from experiments.studies import cable_cuts
from jaxsusp.report.comparison import paper
from jaxsusp.trajectory.timelaw import Motion, TimeLaw

INSTANTS = 2001
SCENARIO = "scenario-1"
"""That of Figs. 8 to 10."""

SHARES = {"pso": 2, "ga": 3, "dbo": 4, "sdbo": 1}
"""The order in which the paper ranks the accelerations."""


def claims(evidence: Evidence) -> Iterator[Claim]:
    """All of them, in the paper's order."""
    yield _least_acceleration(evidence.runs)
    yield _ranking(evidence.runs)
    yield _over_or_around(evidence.runs)
    yield _tension_limits(evidence.runs)
    yield _at_forty_points(evidence.checks)
    yield _by_length_alone()


def discussion(evidence: Evidence) -> Iterator[Claim]:
    """Of Sect. 4.4."""
    yield _inertia(evidence.runs)
    yield _rigid()
    yield _much_calculation(evidence)


def driven(runs: xr.Dataset, scenario: str, algorithm: str) -> tuple[np.ndarray, Motion]:
    """The motion of a best run at `INSTANTS` times (s)."""
    duration = _scenario(runs, scenario).task.duration
    way = runs["position"].sel(scenario=scenario, algorithm=algorithm).values
    times = np.linspace(0, duration, INSTANTS)
    return times, TimeLaw.through(way, duration).at(times)


def _scenario(runs: xr.Dataset, name: str) -> js.Scenario:
    return _read(json.loads(runs.attrs["scenario_files"])[name], name)


@cache
def _read(text: str, name: str) -> js.Scenario:
    return js.Scenario.from_toml(text, f"{name}.toml")


def accelerations(runs: xr.Dataset, scenario: str) -> dict[str, np.ndarray]:
    """Root mean square of the acceleration per axis (m/s²), by algorithm."""
    return {
        str(name): np.sqrt((driven(runs, scenario, name)[1].acceleration ** 2).mean(axis=0))
        for name in runs["algorithm"].values
    }


def _least_acceleration(runs: xr.Dataset) -> Claim:
    found = accelerations(runs, SCENARIO)
    least = [min(found, key=lambda name, axis=axis: found[name][axis]) for axis in range(3)]
    told = "; ".join(
        f"{name.upper()} {', '.join(f'{1e3 * value:.1f}' for value in values)}"
        for name, values in found.items()
    )
    return Claim(
        "Sect. 4.2.2, Fig. 8",
        "SDBO moves the load with lower acceleration in almost all directions.",
        "The figure is not printed as numbers.",
        None,
        f"Root mean square in mm/s² along x, y, z: {told}.",
        least.count("sdbo") >= 2,
    )


def _ranking(runs: xr.Dataset) -> Claim:
    ranks = []
    for scenario in runs["scenario"].values:
        total = {name: np.linalg.norm(a) for name, a in accelerations(runs, scenario).items()}
        ranks.append(sorted(total, key=lambda name: total[name]))
    mean = {name: 1 + np.mean([order.index(name) for order in ranks]) for name in SHARES}
    told = ", ".join(
        f"{name.upper()} {mean[name]:.1f}" for name in sorted(mean, key=lambda name: mean[name])
    )
    here = ranks[0]
    return Claim(
        "Sect. 4.2.2, Fig. 8",
        "By acceleration SDBO is best, followed by PSO and GA, DBO is last.",
        "The figure is not printed as numbers.",
        None,
        "By the root mean square of the acceleration, least first, scenario 1: "
        f"{', '.join(name.upper() for name in here)}; mean rank over the scenarios: {told}.",
        here == sorted(SHARES, key=lambda name: SHARES[name]),
    )


def _over_or_around(runs: xr.Dataset) -> Claim:
    """Heights of the obstacles above which ways lead, and of those in the way that they pass by."""
    over, around = [], []
    for name in runs["scenario"].values:
        scenario = _scenario(runs, name)
        line = np.linspace(scenario.task.start, scenario.task.goal, 400)
        for obstacle in scenario.obstacles:
            top = obstacle.center[2] + _half_height(obstacle)
            if not _above(obstacle, line, scenario.payload.radius):
                continue
            for algorithm in runs["algorithm"].values:
                way = driven(runs, name, algorithm)[1].position
                (over if _above(obstacle, way, 0.0) else around).append(top)
    return Claim(
        "Sect. 4.2.1, Fig. 7",
        "The load passes over low obstacles and goes around tall ones.",
        "The figure is not printed as numbers.",
        None,
        "Obstacles that the straight line crosses, seen from above, with the best way of each "
        f"algorithm: {len(over)} times it leads across the obstacle, whose top is at "
        f"{np.median(over):.1f} m in the median, {len(around)} times around it, at "
        f"{np.median(around):.1f} m.",
        bool(np.median(over) < np.median(around)),
    )


def _half_height(obstacle) -> float:
    match obstacle.kind:
        case "box":
            return obstacle.size[2] / 2
        case "cylinder":
            return obstacle.height / 2
        case _:
            return obstacle.radius


def _above(obstacle, way: np.ndarray, wide: float) -> bool:
    """Whether a way, seen from above, crosses an obstacle's outline widened by so much (m)."""
    away = way[:, :2] - np.array(obstacle.center[:2])
    if obstacle.kind == "box":
        turn = np.deg2rad(obstacle.yaw_deg)
        cos, sin = np.cos(turn), np.sin(turn)
        inside = np.abs(away @ np.array([[cos, -sin], [sin, cos]]))
        return bool((inside <= np.array(obstacle.size[:2]) / 2 + wide).all(axis=1).any())
    return bool((np.hypot(*away.T) <= obstacle.radius + wide).any())


def _tension_limits(runs: xr.Dataset) -> Claim:
    scenario = _scenario(runs, SCENARIO)
    motion = driven(runs, SCENARIO, "sdbo")[1]
    tensions = np.asarray(js.tensions(scenario, motion.position, motion.acceleration))
    low, high = scenario.limits.tension
    return Claim(
        "Sect. 4.2.2, Fig. 10",
        "The tensions stay between 1 and 100 N and no cable pushes.",
        "The values that the text reads from the figure, 1.59 to 96.57 N, do; statics at the "
        "printed ends does not give them, see “Cable 1 carries …”.",
        False,
        f"SDBO's best way in scenario 1: {tensions.min():.1f} to {tensions.max():.1f} N.",
        bool(tensions.min() >= low and tensions.max() <= high),
    )


def _at_forty_points(checks: xr.Dataset) -> Claim:
    found = checks.sel(contacts="sampled", search="box")
    clear = int(found["clear"].sum())
    cut = int((found["clear"] & (cable_cuts.cut(found) > cable_cuts.TOUCH)).sum())
    deepest = float(cable_cuts.cut(found).max())
    return Claim(
        "Sect. 4.2.2",
        "Planning at each of 40 path points ensures that the entire cable path does not collide.",
        "A matter of geometry: between two points a cable can pass through an obstacle.",
        None,
        f"Of {clear} runs of the four algorithms that are clear by such a check, with waypoints "
        f"anywhere in the workspace, {cut} pass load or cable through an obstacle between two "
        f"points, up to {deepest:.2f} m deep.",
        cut == 0,
        CHECKS,
    )


def _by_length_alone() -> Claim:
    return Claim(
        "Sect. 4.2.2, Fig. 9",
        "When a cable meets an obstacle, it avoids it by adjusting its length, being rotated by a "
        "small angle each time.",
        "The ends are said to be fixed (Sect. 2.1). A taut cable is the straight line from its end "
        "to the load, so for a given place of the load nothing is left to adjust or to rotate.",
        False,
        "Cables avoid obstacles through the load's way, or through ends that move.",
        None,
        PRINT,
    )


def _inertia(runs: xr.Dataset) -> Claim:
    scenario = _scenario(runs, SCENARIO)
    motion = driven(runs, SCENARIO, "sdbo")[1]
    still, moving = (
        np.asarray(js.tensions(scenario, motion.position, acceleration))
        for acceleration in (0.0, motion.acceleration)
    )
    change = float(np.abs(moving / still - 1).max())
    most = float(np.linalg.norm(motion.acceleration, axis=1).max())
    return Claim(
        "Sect. 4.4",
        "The load moves slowly, so the inertial term may be neglected.",
        "No speeds are printed.",
        None,
        f"SDBO's best way in scenario 1, 40 s: greatest acceleration {1e3 * most:.0f} mm/s², by "
        f"which tensions change by at most {100 * change:.1f} %.",
        change < 0.05,
    )


def _rigid() -> Claim:
    return Claim(
        "Sect. 4.4",
        "As the robots are taken as rigid, the results are not sufficiently accurate, above all in "
        "z; flexible ones would move the load with a longer vertical period.",
        "The paper says it of its own results.",
        None,
        "Our arms are rigid as well; only cables and winches give way in simulation.",
        None,
        PRINT,
    )


def _much_calculation(evidence: Evidence) -> Claim:
    printed, ours = evidence.table1["runtime"], evidence.ours["runtime"]
    return Claim(
        "Sect. 4.4",
        "The method requires a lot of calculation, which may reduce real-time performance.",
        f"{float(printed.min()):.0f} to {float(printed.max()):.0f} s; the paper does not say "
        f"whether of one run or of {paper.RUNS}.",
        True,
        f"A run's share of one batch of all: {1e3 * float(ours.min()):.0f} to "
        f"{1e3 * float(ours.max()):.0f} ms; the free space, compilation and the checks of a plan, "
        "seconds each, come on top.",
        None,
    )
