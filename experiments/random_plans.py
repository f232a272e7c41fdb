"""Plans for random scenes of any size, place and drive, each checked by other means.

python experiments/random_plans.py --count 1000 --processes 2

Every plan that is called feasible is looked at densely: distances of points of load and cables from
obstacles and ground in closed form, and the balance of forces at a hook, none of which comes from
the package; and it is verified from its file, simulation included. Scenes that are finished are
kept, a row each, and not planned again.
"""

import argparse
import csv
import multiprocessing
import tempfile
import time
from pathlib import Path

import numpy as np
import pandas as pd

INSTANTS = 2001
ALONG = np.linspace(0, 1, 200)[:, None]
OBSTACLES = 6
SCENES = 125  # of a process before a fresh one: programs of many shapes fill memory
FIELDS = (
    "seed", "robots", "drive", "hook", "length", "mass", "far", "feasible", "verified", "attempts",
    "fitness", "load", "cables", "ground", "balance", "seconds", "processor", "reasons",
)  # fmt: skip
ENOUGH = -1e-6
"""Own units of length by which a distance may miss what is required."""


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
    times = np.linspace(0, scenario.task.duration, INSTANTS)
    motion, ends, loads = plan.at(times), plan.ends_at(times), plan.loads_at(times)
    hook = scenario.payload.attachments == "hook"
    at = np.array([[0, 0, scenario.payload.height / 2]]) if hook else scenario.payload.attachments
    hung = np.broadcast_to(np.array(at), (len(scenario.robots), 3))
    load = motion.position[:, None] + np.einsum(
        "tij,pj->tpi", loads.posture, surface_of_load(scenario)
    )
    lower = motion.position[:, None] + np.einsum("tij,kj->tki", loads.posture, hung)
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
    return {name: (value - gap) / unit for name, value in found.items()} | {"balance": lacking}


def timed(seed: int) -> dict:
    """A scene's row with the processor's seconds for all of it, threads included."""
    before = time.process_time()
    row = planned(seed)
    return row | {"processor": time.process_time() - before}


def planned(seed: int) -> dict:
    """One scene: drawn, planned, looked at, verified."""
    import jaxsusp as js

    scenario = js.random_scenario(seed, OBSTACLES, "any")
    clock, frame = time.perf_counter(), scenario.units
    row = {
        "seed": seed, "robots": len(scenario.robots), "drive": scenario.drive,
        "hook": scenario.payload.attachments == "hook", "length": frame.length,
        "mass": frame.mass, "far": float(np.linalg.norm(frame.origin)),
    }  # fmt: skip
    try:
        plan = js.plan(scenario, seed=seed)
    except js.InputError as error:
        return row | {"feasible": False, "reasons": str(error)}
    row |= {
        "seconds": time.perf_counter() - clock, "feasible": plan.feasible,
        "attempts": plan.settings["attempts"], "fitness": plan.settings["fitness"],
        "reasons": "; ".join(plan.reasons),
    }  # fmt: skip
    if plan.feasible:
        with tempfile.TemporaryDirectory() as folder:
            plan.save(Path(folder) / "plan.json")
            again = js.verify_plan(js.load_plan(Path(folder) / "plan.json"))
        row |= looked_at(plan) | {"verified": again.ok}
        row["reasons"] = "; ".join(again.reasons)
    return row


def started() -> None:
    """What every process does first."""
    from jaxsusp.optim import devices

    devices.configure()


def main() -> None:
    """Draw, plan, check, keep, and print a table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--count", type=int, default=1000)
    parser.add_argument("--processes", type=int, default=2)
    parser.add_argument("--output", type=Path, default=Path("results/random-plans.csv"))
    asked = parser.parse_args()
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
        for row in pool.imap_unordered(timed, todo):
            writer.writerow(row)
            file.flush()
            print(" ".join(f"{row.get(name, '')}"[:24] for name in FIELDS), flush=True)
    tell(pd.read_csv(asked.output).query(f"seed < {asked.count}"))


def tell(rows: pd.DataFrame) -> None:
    """A Markdown table by drive mode and number of robots."""
    clear = (rows[["load", "cables", "ground"]].min(axis=1) >= ENOUGH) & (
        ~rows["hook"] | (rows["balance"] < 1e-6)
    )
    rows = rows.assign(
        clear=clear & rows["feasible"],
        followed=rows["feasible"] & (rows["verified"] == True),  # noqa: E712
    )
    print("| drive | robots | scenes | planned | clear by points | verified | median s |")
    print("| :--- | ---: | ---: | ---: | ---: | ---: | ---: |")
    for (drive, robots), part in rows.groupby(["drive", "robots"]):
        counts = part[["feasible", "clear", "followed"]].sum()
        print(
            f"| {drive} | {robots} | {len(part)} | {' | '.join(map(str, counts))} | "
            f"{part['seconds'].median():.1f} |"
        )
    counts = " | ".join(map(str, rows[["feasible", "clear", "followed"]].sum()))
    print(f"| all | | {len(rows)} | {counts} | {rows['seconds'].median():.1f} |")
    print(f"\nThe processor worked {rows['processor'].sum() / 3600:.2f} h in all.")


if __name__ == "__main__":
    main()
