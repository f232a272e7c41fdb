"""Plans for random scenes of any size, place and drive, each checked by other means.

python experiments/random_plans.py --count 1000 --processes 2
python experiments/random_plans.py --count 200 --duration shortest

Every plan that is called feasible is looked at densely: distances of points of load and cables from
obstacles and ground in closed form, the balance of forces at a hook, and every limit from positions
and their differences alone, none of which comes from the package; and it is verified from its
file, simulation included. Of shortest laws it is seen besides that they are not slower than that
of the task's duration; every other scene then states limits of motion too. Scenes that are finished
are kept, a row each, and not planned again.
"""

import argparse
import csv
import multiprocessing
import tempfile
import time
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np
import pandas as pd

INSTANTS = 2001
ALONG = np.linspace(0, 1, 200)[:, None]
OBSTACLES = 6
SCENES = 125  # of a process before a fresh one: programs of many shapes fill memory
FIELDS = (
    "seed", "robots", "drive", "hook", "length", "mass", "far", "feasible", "verified", "attempts",
    "fitness", "load", "cables", "ground", "balance", "limits", "nearest", "nominal", "returned",
    "bound", "usual", "seconds", "processor", "reasons",
)  # fmt: skip
ENOUGH = -1e-6
"""Own units of length by which a distance may miss what is required."""
KEPT = -1e-3
"""Share of a limit by which it may be missed: differences of positions are not exact."""
JOINT_SPEED = 90.0
"""The greatest speed of a joint in °/s, in own units, where a scene states none."""


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


def surface_of_load(scenario) -> np.ndarray:
    """Points of the load's surface about its centre (m)."""
    angle = np.linspace(0, 2 * np.pi, 16, endpoint=False)
    ring = scenario.payload.radius * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    levels = scenario.payload.height * np.linspace(-0.5, 0.5, 5)
    return np.concatenate([np.column_stack([ring, np.full(16, z)]) for z in levels])


def looked_at(plan) -> dict[str, float]:
    """What load and cables keep beyond what is required, in own units; what balance lacks."""
    scenario, unit, gap = plan.scenario, plan.scenario.units.length, plan.scenario.limits.clearance
    times = np.linspace(0, plan.law.duration, INSTANTS)
    motion, ends, loads = plan.at(times), plan.ends_at(times), plan.loads_at(times)
    at = places_of_attachments(scenario)
    load = motion.position[:, None] + np.einsum(
        "tij,pj->tpi", loads.posture, surface_of_load(scenario)
    )
    lower = motion.position[:, None] + np.einsum("tij,kj->tki", loads.posture, at)
    found = {
        "load": np.inf,
        "cables": np.inf,
        "ground": load[..., 2].min() - scenario.ground_height,
    }
    for obstacle in scenario.obstacles:
        found["load"] = min(found["load"], signed_distance(obstacle, load).min())
        for k in range(len(scenario.robots)):
            points = lower[:, k, None] + ALONG * (ends[:, k, None] - lower[:, k, None])
            away = signed_distance(obstacle, points).min() - scenario.limits.cable_radius
            found["cables"] = min(found["cables"], away)
    rays = ends - lower
    pull = (loads.tensions[..., None] * rays / np.linalg.norm(rays, axis=-1, keepdims=True)).sum(1)
    needed = scenario.payload.mass * (motion.acceleration + np.array([0, 0, 9.81]))
    lacking = np.abs(pull - needed).max() / (9.81 * scenario.payload.mass)
    shares = shares_left(plan.rigging)
    nearest = min(shares, key=lambda name: shares[name])
    return {name: (value - gap) / unit for name, value in found.items()} | {
        "balance": lacking, "limits": shares[nearest], "nearest": nearest,
    }  # fmt: skip


def places_of_attachments(scenario) -> np.ndarray:
    """Where the cables are fastened to the load (K, 3), in its frame."""
    hook = scenario.payload.attachments == "hook"
    at = [[0, 0, scenario.payload.height / 2]] if hook else scenario.payload.attachments
    return np.broadcast_to(np.array(at, float), (len(scenario.robots), 3))


def shares_left(rigging) -> dict[str, float]:
    """What is left of every limit, as a share of it; below zero it is broken.

    Each rate is the difference of what comes before it: thrice those of positions, far from the
    world's origin, would be rounding alone.
    """
    scenario, limits = rigging.scenario, rigging.scenario.limits
    times = np.linspace(0, rigging.law.duration, INSTANTS)
    motion, loads = rigging.law.at(times), rigging.loads(times)
    ends = rigging.ends_at(rigging.law.parameter(times))
    hung = np.einsum("tij,kj->tki", loads.posture, places_of_attachments(scenario))
    lengths = np.linalg.norm(ends - motion.position[:, None] - hung, axis=-1)
    found = {}
    for name, values, (low, high) in (
        ("tension", loads.tensions, limits.tension),
        ("length", lengths, limits.cable_length),
    ):
        found[name] = np.minimum(values - low, high - values).min() / high
    tilt = np.rad2deg(np.arccos(np.clip(loads.posture[..., 2, 2], -1, 1)).max())
    found["tilt"] = 1 - tilt / limits.posture_deg
    apart = [
        np.linalg.norm(ends[:, i] - ends[:, j], axis=1).min()
        for i in range(len(scenario.robots))
        for j in range(i)
    ]
    found["apart"] = min(apart) / limits.separation - 1 if limits.separation else np.inf

    def rate(values: np.ndarray) -> np.ndarray:
        return np.gradient(values, times, axis=0, edge_order=2)

    for name, most, values in (
        ("speed", limits.speed, motion.position),
        ("acceleration", limits.acceleration, motion.velocity),
        ("jerk", limits.jerk, motion.acceleration),
    ):
        if most is not None:
            found[name] = 1 - np.linalg.norm(rate(values), axis=1).max() / most
    if limits.cable_speed is not None:
        found["cable speed"] = 1 - np.abs(rate(lengths)).max() / limits.cable_speed
    if scenario.drive in ("end", "hybrid"):
        most = limits.joint_speed_deg or JOINT_SPEED / np.sqrt(scenario.units.length)
        found["joint speed"] = 1 - np.abs(np.rad2deg(rate(joints(scenario, ends)))).max() / most
    return {name: float(value) for name, value in found.items()}


def joints(scenario, ends: np.ndarray) -> np.ndarray:
    """Angles (rad) that hold ends: the column's, and those of two links, by the law of cosines.

    An elbow that is down has the same speeds as one that is up, but for which joint has which.
    """
    bases = np.array([robot.base for robot in scenario.robots])
    column, upper, fore = np.array([robot.links for robot in scenario.robots]).T
    away = ends - bases - column[:, None] * np.array([0, 0, 1.0])
    radius, height = np.hypot(away[..., 0], away[..., 1]), away[..., 2]
    reach = np.hypot(radius, height)
    cosine = (reach**2 - upper**2 - fore**2) / (2 * upper * fore)
    elbow = np.arccos(np.clip(cosine, -1, 1))
    shoulder = np.arctan2(height, radius) + np.arctan2(
        fore * np.sin(elbow), upper + fore * np.cos(elbow)
    )
    turned = np.unwrap(np.arctan2(away[..., 1], away[..., 0]), axis=0)
    return np.stack([turned, shoulder, elbow], axis=-1)


def hurried(scenario, seed: int):
    """The scene with limits of motion beside what its own duration asks for on a straight way."""
    random = np.random.default_rng([seed, 1])
    task, drawn = scenario.task, lambda: float(random.uniform(1.5, 6))
    far = float(np.linalg.norm(np.subtract(task.goal, task.start)))
    peaks = {"speed": 1.875, "acceleration": 5.7735, "jerk": 60.0, "cable_speed": 1.875}
    orders = {"speed": 1, "acceleration": 2, "jerk": 3, "cable_speed": 1}
    limits = scenario.limits.model_copy(
        update={
            name: drawn() * peak * far / task.duration ** orders[name]
            for name, peak in peaks.items()
        }
    )
    return scenario.model_copy(update={"limits": limits})


def timed(seed: int, shortest: bool) -> dict:
    """A scene's row with the processor's seconds for all of it, threads included."""
    before = time.process_time()
    row = planned(seed, shortest)
    return row | {"processor": time.process_time() - before}


def planned(seed: int, shortest: bool) -> dict:
    """One scene: drawn, planned, looked at, verified."""
    import jaxsusp as js
    from jaxsusp.trajectory.timelaw import TimeLaw

    scenario = js.random_scenario(seed, OBSTACLES, "any")
    if shortest and seed % 2:
        scenario = hurried(scenario, seed)
    clock, frame = time.perf_counter(), scenario.units
    row = {
        "seed": seed, "robots": len(scenario.robots), "drive": scenario.drive,
        "hook": scenario.payload.attachments == "hook", "length": frame.length,
        "mass": frame.mass, "far": float(np.linalg.norm(frame.origin)),
    }  # fmt: skip
    try:
        plan = js.plan(scenario, seed=seed, duration="shortest" if shortest else None)
    except js.InputError as error:
        return row | {"feasible": False, "reasons": str(error)}
    row |= {
        "seconds": time.perf_counter() - clock, "feasible": plan.feasible,
        "attempts": plan.settings["attempts"], "fitness": plan.settings["fitness"],
        "nominal": scenario.task.duration, "returned": plan.law.duration,
        "bound": plan.settings.get("least_time"),
        "reasons": "; ".join(plan.reasons),
    }  # fmt: skip
    if plan.feasible:
        with tempfile.TemporaryDirectory() as folder:
            plan.save(Path(folder) / "plan.json")
            again = js.verify_plan(js.load_plan(Path(folder) / "plan.json"))
        row |= looked_at(plan) | {"verified": again.ok}
        if row["returned"] > row["nominal"]:
            usual = TimeLaw.least_jerk(plan.law.path, scenario.task.duration)
            row["usual"] = min(shares_left(replace(plan.rigging, law=usual)).values())
        row["reasons"] = "; ".join(again.reasons)
    return row


def started() -> None:
    """What every process does first."""
    from jaxsusp.optim import devices

    devices.configure()


def main() -> None:
    """Draw, plan, check, keep, and print a table."""
    parser = argparse.ArgumentParser(description=str(__doc__).splitlines()[0])
    parser.add_argument("--count", type=int, default=1000)
    parser.add_argument("--processes", type=int, default=2)
    parser.add_argument("--duration", choices=["scenario", "shortest"], default="scenario")
    parser.add_argument("--output", type=Path, help="default results/random-plans-DURATION.csv")
    asked = parser.parse_args()
    shortest = asked.duration == "shortest"
    asked.output = asked.output or Path(f"results/random-plans-{asked.duration}.csv")
    asked.output.parent.mkdir(parents=True, exist_ok=True)
    if not asked.output.exists():
        asked.output.write_text(",".join(FIELDS) + "\n")
    there = set(pd.read_csv(asked.output)["seed"])
    todo = [seed for seed in range(asked.count) if seed not in there]
    spawned = multiprocessing.get_context("spawn")
    with (
        spawned.Pool(asked.processes, started, maxtasksperchild=SCENES) as pool,
        asked.output.open("a") as file,
    ):
        writer = csv.DictWriter(file, FIELDS)
        for row in pool.imap_unordered(partial(timed, shortest=shortest), todo):
            writer.writerow(row)
            file.flush()
            print(" ".join(f"{row.get(name, '')}"[:24] for name in FIELDS), flush=True)
    rows = pd.read_csv(asked.output).query(f"seed < {asked.count}")
    tell(rows)
    if shortest:
        tell_pace(rows)


def tell(rows: pd.DataFrame) -> None:
    """A Markdown table by drive mode and number of robots."""
    clear = (rows[["load", "cables", "ground"]].min(axis=1) >= ENOUGH) & (
        ~rows["hook"] | (rows["balance"] < 1e-6)
    )
    within = rows["limits"] >= KEPT
    rows = rows.assign(
        clear=clear & rows["feasible"],
        within=within & rows["feasible"],
        followed=rows["feasible"] & (rows["verified"] == True),  # noqa: E712
    )
    titles = "scenes", "planned", "clear by points", "within limits", "verified", "median s"
    print(f"| drive | robots | {' | '.join(titles)} |")
    print(f"| :--- | ---: |{' ---: |' * len(titles)}")
    for (drive, robots), part in rows.groupby(["drive", "robots"]):
        counts = part[["feasible", "clear", "within", "followed"]].sum()
        print(
            f"| {drive} | {robots} | {len(part)} | {' | '.join(map(str, counts))} | "
            f"{part['seconds'].median():.1f} |"
        )
    counts = " | ".join(map(str, rows[["feasible", "clear", "within", "followed"]].sum()))
    print(f"| all | | {len(rows)} | {counts} | {rows['seconds'].median():.1f} |")
    print(f"\nThe processor worked {rows['processor'].sum() / 3600:.2f} h in all.")


def tell_pace(rows: pd.DataFrame) -> None:
    """How shortest laws compare with that of the task's duration and with the bound."""
    rows = rows[rows["feasible"]]
    ratio, above = rows["returned"] / rows["nominal"], rows["returned"] / rows["bound"]
    slower = rows.loc[rows["usual"] >= 0, "seed"].tolist()
    print(
        f"Duration: {ratio.min():.2f} to {ratio.max():.2f} of the task's, median "
        f"{ratio.median():.2f}; longer in {(ratio > 1).sum()}, of which the task's would have kept "
        f"the limits in {len(slower)} {slower or ''}; "
        f"{above.min():.2f} to {above.max():.2f} times the bound where there is one, median "
        f"{above.median():.2f}."
    )


if __name__ == "__main__":
    main()
