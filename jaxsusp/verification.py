"""A finished plan checked against everything that is known about it.

The plan is worked out anew from its waypoints and ends, on the real curve; what it says is compared
with that, and looked at itself where it differs; and it is played in simulation.
"""

from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np

from jaxsusp.mechanics import arm
from jaxsusp.plans import Plan, plan_through
from jaxsusp.verify.scene import Scene, fixed_bodies
from jaxsusp.verify.simulation import Simulation, simulate

TOLERANCES = {
    "path": (1e-6, "m"),
    "times": (1e-6, "s"),
    "position": (1e-6, "m"),
    "velocity": (1e-6, "m/s"),
    "acceleration": (1e-6, "m/s²"),
    "jerk": (1e-5, "m/s³"),
    "lengths": (1e-6, "m"),
    "tensions": (1e-4, "N"),
    "joints": (1e-6, "rad"),
}
"""How much each array may differ from what follows from waypoints and ends."""


class Verification(NamedTuple):
    """The outcome."""

    ok: bool
    reasons: tuple[str, ...]
    plan: Plan  # worked out anew: its report and certificate are those of the verification
    simulation: Simulation | None


def verify_plan(plan: Plan, simulation: bool | Simulation = True) -> Verification:
    """Verify a plan: its limits and clearances, its arrays, and its simulation.

    Args:
        plan: any plan, feasible or not, changed or not.
        simulation: whether to simulate, or a simulation that was made already.

    Returns:
        A `Verification`; `reasons` holds one sentence per fault, those of the motion first.
    """
    elbow_up = plan.joints[0, :, 2] >= 0
    anew = plan_through(plan.scenario, plan.waypoints, plan.ends, len(plan.path), elbow_up=elbow_up)
    reasons = list(anew.reasons)
    for name in TOLERANCES:
        reasons += _differences(plan, anew, name)
    seen = simulation if isinstance(simulation, Simulation) else None
    if simulation is True and np.isfinite(anew.tensions).all():
        seen = simulate(anew)
    if seen is not None:
        reasons += seen.problems(anew)
    return Verification(not reasons, tuple(reasons), anew, seen)


def _differences(plan: Plan, anew: Plan, name: str) -> list[str]:
    """Where an array of a plan is not what follows from its waypoints, and what comes of it."""
    tolerance, unit = TOLERANCES[name]
    stored, known = getattr(plan, name), getattr(anew, name)
    if stored.shape != known.shape:
        return [f"{name} has shape {stored.shape} instead of {known.shape}"]
    off = np.abs(stored - known)
    off = np.where(np.isnan(stored) & np.isnan(known), 0, np.where(np.isnan(off), np.inf, off))
    if not (off > tolerance).any():
        return []
    row = int(off.reshape(len(off), -1).max(axis=1).argmax())
    worst = off[row].max()
    when = f" at {plan.times[row]:.2f} s" if len(stored) == len(plan.times) else ""
    found = [
        f"{name} differs from what follows from waypoints and ends by {worst:.4g} {unit}{when} "
        f"(row {row})"
    ]
    if name == "tensions":
        found += _broken(plan, stored, "tension", plan.scenario.limits.tension, "N")
    if name == "lengths":
        found += _broken(plan, stored, "length", plan.scenario.limits.cable_length, "m")
    if name in ("position", "path"):
        found += _contacts(plan, anew, stored)
    if name == "joints":
        found += _misses(plan)
    return found


def _broken(plan: Plan, values: np.ndarray, what: str, limits, unit: str) -> list[str]:
    """Stored values outside their limits."""
    low, high = limits
    excess = np.maximum(low - values, values - high)
    excess = np.where(np.isnan(excess), np.inf, excess)
    row, k = np.unravel_index(int(excess.argmax()), values.shape)
    if excess[row, k] <= 0:
        return []
    return [
        f"stored {what} of cable {k + 1} is {values[row, k]:.5g} {unit} at "
        f"{plan.times[row]:.2f} s, allowed is {low:g} to {high:g} {unit}"
    ]


def _contacts(plan: Plan, anew: Plan, positions: np.ndarray) -> list[str]:
    """What load and cables are too close to at stored positions."""
    scenario = plan.scenario
    with jax.enable_x64(True):
        base = jnp.array([robot.base for robot in scenario.robots])
        links = jnp.array([robot.links for robot in scenario.robots])
        chains = np.asarray(arm.chain(base, links, jnp.asarray(anew.joints[0])))
    bodies = fixed_bodies(scenario, chains)
    scene, gap = Scene(scenario, bodies, len(plan.ends)), scenario.limits.clearance
    hook = np.array([0.0, 0.0, scenario.payload.height / 2])
    found: dict[str, str] = {}
    for row, center in enumerate(positions):
        scene.place_load(center)
        for k, end in enumerate(plan.ends):
            scene.place_cable(k, center + hook, end)
        for index, body in enumerate(bodies):
            for moving in range(len(plan.ends) + 1):
                if body.robot >= 0 and body.robot == moving - 1 and body.part == 2:
                    continue
                distance, _ = scene.distance(index, scene.load + moving)
                if distance < gap - 1e-6:
                    name = f"cable {moving}" if moving else "load"
                    text = "touches" if distance <= 0 else f"is {distance:.4g} m from"
                    found.setdefault(
                        f"{name} {body.name}", f"stored row {row}: {name} {text} {body.name}"
                    )
    return list(found.values())


def _misses(plan: Plan) -> list[str]:
    """Arms whose stored joint angles do not lead to their ends."""
    found = []
    with jax.enable_x64(True):
        for k, robot in enumerate(plan.scenario.robots):
            base, links = jnp.array(robot.base), jnp.array(robot.links)
            held = np.asarray(arm.forward(base, links, jnp.asarray(plan.joints[:, k])))
            off = np.linalg.norm(held - plan.ends[k], axis=-1)
            row = int(np.where(np.isnan(off), np.inf, off).argmax())
            if not off[row] <= 1e-6:
                found.append(
                    f"joint angles of robot {k + 1} hold its end {off[row]:.4g} m away from where "
                    f"it has to be at {plan.times[row]:.2f} s"
                )
    return found
