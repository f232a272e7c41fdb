"""Claims about Tables 2 and 3: where the ends of the cables are, and how long the cables get."""

from collections.abc import Iterator

import jax.numpy as jnp
import numpy as np
import xarray as xr

import jaxsusp as js
from experiments.claims.claim import PRINT, Claim, Evidence
from jaxsusp.optim.choices import PUBLISHED

SUMS = {"pso": 19.5424, "ga": 16.2143, "dbo": 23.7256, "sdbo": 13.4705}
"""Of the greatest lengths of the three cables (m), Sect. 4.3."""

TENSIONS = {"start": {1: 1.5928}, "goal": {1: 96.5688, 2: 5.1757, 3: 7.9184}}
"""Of SDBO's cables (N) as the text reads them from Fig. 10, by robot."""


def claims(evidence: Evidence) -> Iterator[Claim]:
    """All of them, in the paper's order."""
    yield _in_reach(evidence)
    yield _triangle(evidence)
    yield _lowest(evidence)
    yield _sums(evidence)
    yield _lengths_change(evidence)
    yield _tensions(evidence)
    yield _balance(evidence)


def ends_of(evidence: Evidence, algorithm: str) -> np.ndarray:
    """P_k of Table 2 (3, 3), m."""
    rows = evidence.ends[evidence.ends["algorithm"] == algorithm].sort_values("robot")
    return rows[["x", "y", "z"]].to_numpy()


def rig():
    """The scenario of Figs. 8 to 10, in own units, which for it are m and kg."""
    return js.load_scenario("scenario-1")


def hook_at(place) -> np.ndarray:
    """Where cables meet above the load's centre (m)."""
    return np.array(place) + np.array([0, 0, rig().payload.height / 2])


def newtons(values: np.ndarray) -> str:
    """Tensions as text."""
    return ", ".join(f"{value:.1f}" for value in values).replace("-", "−")


def pulled(ends: np.ndarray, place) -> np.ndarray:
    """Tensions (N) that hold the load at rest there, whatever their signs (Eq. 4)."""
    rays = ends - hook_at(place)
    units = rays / np.linalg.norm(rays, axis=1, keepdims=True)
    return np.linalg.solve(units.T, [0, 0, rig().payload.mass * 9.81])


def _in_reach(evidence: Evidence) -> Claim:
    scenario = rig()
    reach = sum(scenario.robots[0].links[1:])
    away = np.array(
        [
            [
                np.linalg.norm(end - robot.base - np.array([0, 0, robot.links[0]]))
                for end, robot in zip(ends_of(evidence, name), scenario.robots, strict=True)
            ]
            for name in PUBLISHED
        ]
    )
    return Claim(
        "Table 2, Sect. 4.1",
        "The ends are those of the three robots with links of 4, 3 and 2 m at the printed bases.",
        f"The ends are {away.min():.2f} to {away.max():.2f} m from the shoulders of their robots; "
        f"the arms reach {reach:.0f} m, so {int((away > reach).sum())} of {away.size} ends are out "
        "of reach.",
        bool((away <= reach).all()),
        "Ends out of reach are refused.",
        None,
        PRINT,
    )


def _triangle(evidence: Evidence) -> Claim:
    def sides(points) -> np.ndarray:
        return np.linalg.norm(points - np.roll(points, 1, axis=0), axis=1)

    bases = sides(np.array([robot.base for robot in rig().robots]))
    ends = np.array([sides(ends_of(evidence, name)) for name in PUBLISHED])
    level = all(np.ptp(ends_of(evidence, name)[:, 2]) == 0 for name in PUBLISHED)
    return Claim(
        "Sect. 3.3, 4.1",
        "The robots stand in an equilateral triangle, their ends at one height.",
        f"The bases are {bases.min():.2f} m apart; the ends of every row of Table 2 are "
        f"{'at one height' if level else 'at different heights'}, {ends.min():.1f} to "
        f"{ends.max():.1f} m apart.",
        bool(np.ptp(bases) < 1e-6 and level),
        "Ours stand so, and hold their ends 1 m further out than their own bases.",
        None,
        PRINT,
    )


def _lowest(evidence: Evidence) -> Claim:
    heights = {name: ends_of(evidence, name)[0, 2] for name in PUBLISHED}
    least = min(heights, key=lambda name: heights[name])
    factors = {height: stability(evidence.runs, height) for height in HEIGHTS}
    told = ", ".join(f"{value:.2f} with ends at {height:g} m" for height, value in factors.items())
    return Claim(
        "Sect. 4.3",
        "The height of SDBO's ends is the lowest, which is beneficial for stable operation.",
        f"Lowest: {least.upper()} with {heights[least]:.2f} m.",
        least == "sdbo",
        f"Mean stability factor S_c (Eq. 18; its factors are our reading) on SDBO's best way in "
        f"scenario 1: {told}.",
        max(factors, key=lambda height: factors[height]) == min(factors),
    )


HEIGHTS = (5.0, 6.0, 7.0, 8.0)
"""m, of our ends; the scenario's are at 7 m."""


def stability(runs: xr.Dataset, height: float) -> float:
    """Mean stability factor at the waypoints of SDBO's best run with all ends at that height."""
    scenario = rig()
    robots = tuple(
        robot.model_copy(update={"end": (*robot.end[:2], height)}) for robot in scenario.robots
    )
    raised = scenario.model_copy(update={"robots": robots})
    cell = runs.sel(scenario=scenario.name, algorithm="sdbo")
    best = cell["x"].isel(run=int(np.argmin(cell["fitness"].values))).values
    problem = js.Problem.from_scenario(raised, search="box")
    return float(np.mean(problem.stability(jnp.asarray(best)[None])))


def _sums(evidence: Evidence) -> Claim:
    sums = evidence.ends.groupby("algorithm")["length"].sum()
    right = all(abs(sums[name] - claimed) < 5e-5 for name, claimed in SUMS.items())
    told = ", ".join(f"{name.upper()} {sums[name]:.4f} m" for name in PUBLISHED)
    return Claim(
        "Table 3, Sect. 4.3",
        "The sums of the three greatest lengths are "
        f"{', '.join(f'{value} m' for value in SUMS.values())}; SDBO's is the best.",
        f"{told}.",
        bool(right and sums.idxmin() == "sdbo"),
        "Our ends by the same algorithms are on the page of Tables 2 and 3.",
        None,
        PRINT,
    )


def _lengths_change(evidence: Evidence) -> Claim:
    ends, task = ends_of(evidence, "sdbo"), rig().task
    start, goal = (
        np.linalg.norm(ends - hook_at(place), axis=1) for place in (task.start, task.goal)
    )
    bases = np.array([robot.base for robot in rig().robots])
    away = np.linalg.norm(bases - np.array(task.start), axis=1)
    held = np.array([robot.end for robot in rig().robots])
    ours = [np.linalg.norm(held - hook_at(place), axis=1) for place in (task.start, task.goal)]
    apart = abs(ends[1, 0]) - abs(ends[2, 0])
    said = ", ".join(f"{a:.2f} → {b:.2f} m" for a, b in zip(start, goal, strict=True))
    as_said = goal[0] < start[0] and (goal[1:] > start[1:]).all() and start.argmax() == 0
    return Claim(
        "Sect. 4.2.2, Fig. 10",
        "By the symmetry of robots 2 and 3 cables 2 and 3 change alike and get longer, cable 1 "
        "gets shorter; robot 1 is the furthest at the start.",
        f"From the ends of Table 2: {said}. The ends of robots 2 and 3 are "
        f"{abs(apart):.2f} m from being symmetric. By the printed bases robot 1 is "
        f"{'furthest from' if away.argmax() == 0 else 'nearest to'} the start ({away[0]:.1f} m; "
        f"the others are {away[1]:.1f} and {away[2]:.1f} m from it).",
        bool(as_said and away.argmax() == 0),
        "Cables of ours, with ends at their own robots: "
        + ", ".join(f"{a:.2f} → {b:.2f} m" for a, b in zip(*ours, strict=True))
        + ".",
        bool(ours[1][0] < ours[0][0] and (ours[1][1:] > ours[0][1:]).all()),
        PRINT,
    )


def _tensions(evidence: Evidence) -> Claim:
    ends, task = ends_of(evidence, "sdbo"), rig().task
    start, goal = pulled(ends, task.start), pulled(ends, task.goal)
    said = [*TENSIONS["start"].values(), *TENSIONS["goal"].values()]
    found = np.array([start[0], *goal])
    return Claim(
        "Sect. 4.2.2, Fig. 10",
        f"Cable 1 carries {TENSIONS['start'][1]} N at the start and {TENSIONS['goal'][1]} N at the "
        f"goal, cables 2 and 3 {TENSIONS['goal'][2]} and {TENSIONS['goal'][3]} N there.",
        "Statics (Eq. 4) at the printed ends gives "
        f"{newtons(start)} N at the start and "
        f"{newtons(goal)} N at the goal. If the table belongs to this "
        f"task, start and goal lie {1e3 * (task.start[1] - ends[:, 1].max()):.0f} and "
        f"{1e3 * (ends[:, 1].min() - task.goal[1]):.0f} mm outside the triangle of the ends, so no "
        "pulling cables hold the load there.",
        bool(np.allclose(found, said, rtol=0.05)),
        "Checked with a hook, as the figures are drawn.",
        None,
        PRINT,
    )


def _balance(evidence: Evidence) -> Claim:
    ends, goal = ends_of(evidence, "sdbo"), rig().task.goal
    rays = ends - hook_at(goal)
    units = rays / np.linalg.norm(rays, axis=1, keepdims=True)
    force = np.array([TENSIONS["goal"][k] for k in (1, 2, 3)]) @ units
    weight = rig().payload.mass * 9.81
    sideways = float(np.hypot(*force[:2]))
    return Claim(
        "Sect. 4.2.2, Fig. 10",
        "The tensions at the goal hold the load.",
        f"They lift {force[2]:.1f} of {weight:.1f} N and leave {sideways:.1f} N sideways "
        "unbalanced.",
        bool(sideways < 0.01 * weight and abs(force[2] - weight) < 0.01 * weight),
        "Our tensions balance weight and inertia to rounding.",
        None,
        PRINT,
    )
