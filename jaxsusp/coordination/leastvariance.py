"""Least variance: of all ends that keep cables clear, the steadiest sequence (Eq. 20).

Dynamic programming over fans of candidate ends finds it (`passes`), a running mean over the fans'
angles rounds the kinks that remain where every limit allows it (`smoothing`).
"""

import functools
from collections.abc import Callable, Sequence
from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np

from jaxsusp._types import Array, Float, Int
from jaxsusp.coordination.ends import load_way
from jaxsusp.coordination.fans import combinations, offsets
from jaxsusp.coordination.passes import Attempt, Found, Outlook, Task, move, stay
from jaxsusp.coordination.smoothing import WIDTHS, running_means
from jaxsusp.errors import InputError, require, require_count
from jaxsusp.mechanics.drives import moving
from jaxsusp.scenario.ownunits import Frame
from jaxsusp.scenario.scenario import Scenario
from jaxsusp.scenario.scope import require_rule
from jaxsusp.scenario.world import build_world, cast_world

SLACKS = (0.0, 0.02, 0.05, 0.1, 0.2)
"""m by which the cables of candidates keep further off obstacles, tried in turn: a sequence whose
every step is clear may still touch something between two steps, and a smoothed one needs room."""

NARROWER = 0.6
"""Share of the angle at which the first fans open where at the full angle nothing will do: a
coarse fan can have its candidates on both sides of the only passage."""


class Coordination(NamedTuple):
    """Ends for a load trajectory, or why there are none. Host arrays, float64 (m, N, rad)."""

    feasible: bool
    reason: str  # empty where feasible
    ends: Float[np.ndarray, "samples cables xyz"]
    lengths: Float[np.ndarray, "samples cables"]
    tensions: Float[np.ndarray, "samples cables"]
    cost: float  # Eq. 20 with the transitions, E and η of the first, widest fans
    costs: Float[np.ndarray, "passes"]  # after every pass of dynamic programming, before smoothing
    candidates: Int[np.ndarray, "samples"]  # feasible joint candidates of every step
    angles: Float[np.ndarray, "cables samples 2"]  # heading, elevation from where the fans opened
    slack: float  # m that candidates kept further off than asked for
    smoothing: float  # standard deviation of the last running mean, in samples; 0: none

    def stated(self, units: Frame) -> "Coordination":
        """The same, of a task in own units, with numbers as a scenario's units make them.

        Costs stay in own units, where one of them means the same at every size.
        """
        return self._replace(
            ends=units.place(self.ends),
            lengths=units.number(self.lengths, "m"),
            tensions=units.number(self.tensions, "N"),
            slack=units.number(self.slack, "m"),
        )


def moving_ends(
    scenario: Scenario,
    position: Float[Array, "samples xyz"] | Sequence,
    fan: int = 9,
    angle_deg: float = 10.0,
    keep: int = 729,
    passes: int = 8,
    margin: float = 0.0,
) -> Coordination:
    """Ends that move with the load and keep the cables clear (cable avoidance, Sect. 3.3).

    The fans open around where the drive mode's plain rule puts the ends. What the mode keeps (the
    lengths in "end"; lengths and heights in "base") is kept exactly at every step. The result is
    checked for contacts between the steps, with load and ends moving straight from step to step.

    Args:
        scenario: in a drive mode whose ends move.
        position: the load's centre along the trajectory (m), at least two steps.
        fan: candidates per cable and step: an odd square number, any odd one in mode "base".
        angle_deg: how far an end may turn from the plain rule to every side (degrees).
        keep: joint candidates that each step keeps: of least step cost, later nearest to the
            sequence found before. The default keeps all of 9 per cable for three cables; with
            more per cable it drops most, which costs smoothness.
        passes: of dynamic programming, each over fans half as wide.
        margin: m that cables keep off obstacles beyond what is required, at and between steps.

    Raises:
        InputError: a drive mode or attachments whose ends do not move so, or fans too large.
    """
    if not moving(scenario.drive):
        raise InputError(
            f'{scenario.name}: drive = "cable" keeps the ends where they are; give "end", "base" '
            'or "hybrid" to move them'
        )
    require_count("keep", keep)
    require_count("passes", passes)
    task = _task(scenario, position, fan, angle_deg, margin)
    keep = min(keep, len(task.choices))
    wide, means = np.deg2rad(angle_deg), running_means(len(task.position))
    scales = wide * 0.5 ** np.arange(passes)

    def attempt(slack: float, opening: float) -> Attempt:
        program = functools.partial(move, scenario.drive, keep, task, wide)
        return program(opening * scales, means, np.float64(slack))

    return _smoothest(attempt, WIDTHS[0]).stated(scenario.units)


def fixed_ends(
    scenario: Scenario,
    position: Float[Array, "samples xyz"] | Sequence,
    fan: int = 9,
    angle_deg: float = 10.0,
    margin: float = 0.0,
) -> Coordination:
    """The one joint candidate of least cost that serves the whole trajectory (mode "cable").

    Its fans open around the given ends as seen from the trajectory's middle; arguments as in
    `moving_ends`. Fans may be wide: 25 candidates per cable within 30° take a second or two.
    """
    if moving(scenario.drive):
        raise InputError(
            f'{scenario.name}: drive = "{scenario.drive}" moves the ends; give "cable" to fix them'
        )
    task = _task(scenario, position, fan, angle_deg, margin)
    wide = np.deg2rad(angle_deg)

    def attempt(slack: float, opening: float) -> Attempt:
        return stay(task, opening * wide, np.float64(slack))

    return _smoothest(attempt, 0.0).stated(scenario.units)


def _task(scenario: Scenario, position, fan: int, angle_deg: float, margin: float) -> Task:
    require_rule(scenario)
    require(
        scenario.payload.attachments == "hook",
        f"{scenario.name}: fans of ends are for cables that meet at a hook: with separate "
        'payload.attachments they would turn the load; give attachments = "hook"',
    )
    require_count("fan", fan)
    require(0 < angle_deg <= 90, f"angle_deg = {angle_deg:g}: give degrees from above 0 to 90")
    require(0 <= margin < np.inf, f"margin = {margin:g}: give a finite number of at least 0 m")
    where, margin = scenario.units.inside(load_way(position)), margin / scenario.units.length
    scenario = scenario.own
    choices = combinations(fan, len(scenario.robots))
    turns = offsets(scenario.drive, fan, 1.0)
    with jax.enable_x64(True):
        world = cast_world(build_world(scenario), jnp.float64)
    return Task(world, where, turns, choices, np.asarray(margin, np.float64))


def _smoothest(attempt: Callable[[float, float], Attempt], widest: float) -> Coordination:
    """The smoothest of what more and more slack finds; stops where it cannot be smoother."""
    best = None
    with jax.enable_x64(True):
        for slack in SLACKS:
            found, outlook = _opened(attempt, slack)
            made = _coordination(found, outlook, slack)
            if best is None or _merit(made) > _merit(best):
                best = made
            if _dead(outlook) or outlook.load or _merit(made) == (True, widest):
                break
    assert best is not None
    return best


def _opened(attempt: Callable[[float, float], Attempt], slack: float) -> Attempt:
    """What opens at the full angle, or more narrowly where nothing does; on the host."""
    made = jax.tree.map(np.asarray, attempt(slack, 1.0))
    if made[1].load or not _dead(made[1]):
        return made
    narrower = jax.tree.map(np.asarray, attempt(slack, NARROWER))
    return made if _dead(narrower[1]) else narrower


def _dead(outlook: Outlook) -> bool:
    """Whether there is no sequence of candidates at all."""
    return not outlook.costs[0] < np.inf


def _merit(made: Coordination) -> tuple[bool, float]:
    return made.feasible, made.smoothing if made.feasible else 0.0


def _coordination(found: Found, outlook: Outlook, slack: float) -> Coordination:
    reason = _reason(found, outlook)
    return Coordination(
        feasible=not reason,
        reason=reason,
        ends=np.asarray(found.sequence.ends),
        lengths=np.asarray(found.sequence.lengths),
        tensions=np.asarray(found.sequence.tensions),
        cost=float(found.cost),
        costs=np.asarray(outlook.costs),
        candidates=np.asarray(outlook.counts),
        angles=np.asarray(found.angles),
        slack=slack,
        smoothing=float(found.width),
    )


def _reason(found: Found, outlook: Outlook) -> str:
    """Why a sequence will not do; empty if it will."""
    if outlook.load:
        return f"the load itself meets an obstacle ({outlook.load} contacts)"
    counts = outlook.counts
    if not counts.all():
        return (
            "no joint candidate is in reach, apart, in tension and clear at step "
            f"{np.argmin(counts > 0)} ({(counts == 0).sum()} of {len(counts)} steps)"
        )
    if _dead(outlook):
        return "no single joint candidate serves all steps"
    if not found.fine:
        return f"cables meet an obstacle between steps ({found.contacts} contacts)"
    return ""
