"""A finished plan checked against everything that is known about it.

The plan is worked out anew from the points of its path, its law and its ends, on the real curve;
what it says is compared with that, and looked at itself where it differs; and it is played in
simulation.
"""

from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np

from jaxsusp.mechanics import arm
from jaxsusp.planning.motion.along import plan_of
from jaxsusp.planning.motion.smooth import RADII
from jaxsusp.planning.plan import UNITS, Plan
from jaxsusp.planning.waypoints import sample_path
from jaxsusp.scenario.ownunits import DIMENSIONS, PLACE, TOUCH
from jaxsusp.suspension.rigging import Rigging
from jaxsusp.verify.certificate import certify
from jaxsusp.verify.pairs import KINDS, System
from jaxsusp.verify.scene import Scene
from jaxsusp.verify.simulation import Simulation, simulate

STATED = ("waypoints", "path", "end_path", "law_times", "law_arc", "law_speed", "law_acceleration")
"""What a plan states; the rest follows."""

TOLERANCES = {name: 1e-6 for name in UNITS if name not in STATED} | {
    "jerk": 1e-5, "tensions": 1e-4,
}  # fmt: skip
"""How much each array may differ from what follows from path, law and ends, in own units."""


CABLES_TO_ARMS = KINDS.index("cables to arms")
"""Pairs up to this kind are looked at where stored positions differ."""


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
    rigging, units = plan.rigging.own, plan.scenario.units
    waypoints = units.inside(plan.waypoints)
    anew = plan_of(rigging, waypoints, certify(rigging)).stated(plan.scenario)
    reasons = [*anew.reasons, *_strays(plan, rigging, waypoints), *_not_at_rest(plan)]
    for name in TOLERANCES:
        reasons += _differences(plan, anew, name)
    seen = simulation if isinstance(simulation, Simulation) else None
    if simulation is True and np.isfinite(anew.tensions).all():
        seen = simulate(anew.rigging)
    if seen is not None:
        reasons += seen.problems(anew.scenario.limits)
    return Verification(not reasons, tuple(reasons), anew, seen)


def _strays(plan: Plan, rigging: Rigging, waypoints: np.ndarray) -> list[str]:
    """Whether a path is none that smoothing makes of the curve through its waypoints."""
    path = rigging.law.path.points
    off = np.abs(path - sample_path(rigging.scenario, waypoints, len(path))).max(axis=1)
    row, most = int(off.argmax()), RADII[0] + TOUCH
    if off[row] <= most:
        return []
    off, most = plan.scenario.units.number(np.array([off[row], most]), "m")
    return [
        f"path is {off:.4g} m off the curve through its waypoints at row {row}; smoothing moves it "
        f"by {most:.4g} m at most"
    ]


def _not_at_rest(plan: Plan) -> list[str]:
    """Whether a law does not lead from rest at the start to rest at the goal."""
    _, arc, speed, acceleration = plan.rigging.own.law.states
    ends = [arc[0], arc[-1] - plan.rigging.own.law.path.length, *speed[[0, -1]]]
    if np.abs([*ends, *acceleration[[0, -1]]]).max() <= TOUCH:
        return []
    return ["law does not lead from rest at the start of the path to rest at its end"]


_STEPS = 1e4
"""Steps of float64 at the robots' bases that the third derivative of a spline can make of one in
`_USUAL`, the benchmark's duration; the faster the law, the more."""

_USUAL = 40.0


def _differences(plan: Plan, anew: Plan, name: str) -> list[str]:
    """Where an array of a plan is not what follows from its waypoints, and what comes of it."""
    frame, unit = plan.scenario.units, UNITS[name].replace(PLACE, "m")
    # Far from the world's origin even float64 has steps that derivatives make large.
    steps = np.spacing(np.abs(frame.origin).max() / frame.length)
    faster = max(_USUAL / plan.rigging.own.law.duration, 1.0) ** -DIMENSIONS[unit][2]
    tolerance = frame.number(TOLERANCES[name] + _STEPS * steps * faster, unit)
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
        f"{name} differs from what follows from path, law and ends by {worst:.4g} {unit}{when} "
        f"(row {row})"
    ]
    if name == "tensions":
        found += _broken(plan, stored, "tension", plan.scenario.limits.tension, "N")
    if name == "lengths":
        found += _broken(plan, stored, "length", plan.scenario.limits.cable_length, "m")
    if name == "position":
        found += _contacts(anew, stored, anew.ends)
    if name == "joints":
        found += _misses(plan, anew)
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


def _contacts(anew: Plan, positions: np.ndarray, ends: np.ndarray) -> list[str]:
    """What load and cables are too close to at stored positions, ends where they belong."""
    units = anew.scenario.units
    system = System(anew.rigging.own)
    scene = Scene(system.bodies)
    shape = len(positions), anew.rigging.cables, 3
    points = system.locate(units.inside(positions), np.broadcast_to(units.inside(ends), shape))
    found: dict[str, str] = {}
    for row, places in enumerate(points):
        for index, body in enumerate(system.bodies):
            scene.place(index, places[body.first], places[body.second])
        for pair in system.pairs:
            if pair.kind > CABLES_TO_ARMS:
                continue
            distance, _ = scene.distance(pair.other, pair.one)
            if distance < pair.required - TOUCH:
                one, other = system.bodies[pair.one].name, system.bodies[pair.other].name
                away = units.number(distance, "m")
                text = "touches" if distance <= 0 else f"is {away:.4g} m from"
                found.setdefault(f"{one} {other}", f"stored row {row}: {one} {text} {other}")
    return list(found.values())


def _misses(plan: Plan, anew: Plan) -> list[str]:
    """Arms whose stored joint angles do not lead to their ends."""
    ends, rigging = np.broadcast_to(anew.ends, anew.joints.shape), anew.rigging
    found = []
    with jax.enable_x64(True):
        bases, links = jnp.asarray(rigging.bases_at(ends)), jnp.asarray(rigging.links)[None]
        held = np.asarray(arm.forward(bases, links, jnp.asarray(plan.joints)))
    off = np.linalg.norm(held - ends, axis=-1)
    for k in range(rigging.cables):
        row = int(np.where(np.isnan(off[:, k]), np.inf, off[:, k]).argmax())
        if not off[row, k] <= plan.scenario.units.number(TOUCH, "m"):
            found.append(
                f"joint angles of robot {k + 1} hold its end {off[row, k]:.4g} m away from where "
                f"it has to be at {plan.times[row]:.2f} s"
            )
    return found
