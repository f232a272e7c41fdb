"""A fast law of bounded jerk: convex programmes one after another, from a law that keeps limits.

With b = ṡ² and a = s̈ over arc length the jerk is √b (p_s a' + 3 p_ss a + p_sss b), so that a limit
J of it is |p_s a' + 3 p_ss a + p_sss b| <= J/√b. The left side is convex, and so is 1/√b: its
tangent at a known law lies below it, and with the tangent in its place the limit is convex and
stricter than the true one. Every programme therefore begins from a law that it allows, and ends
with one that is no slower.

A limit of snap, how fast s⃛ changes, is one of differences between neighbouring intervals.

The grid is even in time, not in length, for from rest s ∝ t³: over length the acceleration rises
without bound there. Between places the jerk is constant in time; what that makes of an interval's
mean acceleration and of its time is taken from the law before (exact where programmes end).
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from scipy.interpolate import BSpline

from jaxsusp._types import Float
from jaxsusp.trajectory.fastest import Cones, Demands
from jaxsusp.trajectory.timelaw import TimeLaw

INTERVALS = 96

ROUNDS = 12

ENOUGH = 2e-3
"""Relative gain of a round below which there are no more."""


class _States(NamedTuple):
    """A law at times: arc length (m), ṡ (m/s) and s̈ (m/s²)."""

    times: np.ndarray
    arc: np.ndarray
    speed: np.ndarray
    acceleration: np.ndarray


def jerk_limited(start: TimeLaw, demanded: Callable[[np.ndarray], Demands]) -> TimeLaw:
    """A law of bounded jerk that is about as fast as limits allow.

    Args:
        start: a law that keeps the limits, or nearly.
        demanded: gives what limits the motion at arc lengths (m).

    Returns:
        The fastest law found, to be checked: in pieces of constant jerk, or C4 where snap is
        limited.
    """
    law, snap = start, np.inf
    for _ in range(ROUNDS):
        states = _even(law)
        demands = demanded(states.arc)
        found, snap = _faster(states, demands), demands.snap
        if found is None:
            break
        gain = 1 - found.times[-1] / law.duration
        law = TimeLaw.passing(law.path, *found)
        if gain < ENOUGH:
            break
    return law if law is start or np.isinf(snap) else _without_steps(law)


def _without_steps(law: TimeLaw) -> TimeLaw:
    """The quintic spline nearest to a law in steps of jerk, at rest at both ends."""
    knots = np.linspace(0, law.duration, INTERVALS // 2 + 1)
    padded = np.concatenate([[0.0] * 5, knots, [law.duration] * 5])
    times = np.linspace(0, law.duration, 8 * INTERVALS + 1)
    table = BSpline.design_matrix(times, padded, 5).toarray()
    length = law.path.length
    control = np.zeros(table.shape[1])
    control[-3:] = length  # with the first three and last three equal it begins and ends at rest
    inner = slice(3, -3)
    rest = law.law(times) - table[:, -3:].sum(axis=1) * length
    control[inner] = np.linalg.lstsq(table[:, inner], rest, rcond=None)[0]
    spline = BSpline(padded, control, 5)
    states = (spline(knots, nu=order) for order in range(3))
    return TimeLaw.passing(law.path, knots, *states)


def _even(law: TimeLaw) -> _States:
    """A law at even times, at rest at both ends to the last bit."""
    times = np.linspace(0, law.duration, INTERVALS + 1)
    arc, speed, acceleration = (law.law(times, nu=order) for order in range(3))
    speed[[0, -1]] = acceleration[[0, -1]] = 0
    arc[[0, -1]] = 0, law.path.length
    return _States(times, arc, np.maximum(speed, 0), acceleration)


def _faster(known: _States, demands: Demands) -> _States | None:
    """One programme: the fastest law that the tangent at a known one allows."""
    step, length = np.diff(known.times), np.diff(known.arc)
    if (length <= 0).any():
        return None
    v, a = known.speed, known.acceleration
    sums, unit = v[1:] + v[:-1], max(float(np.abs(a).max()), 1e-12)
    cones = Cones(demands, 1.0)
    ratio, count = cones.variables(len(v)), len(v) - 1  # of b to the known one
    ends, all_places = np.array([0, count]), np.arange(count + 1)
    cones.equal(ratio[ends], 1.0)
    root = cones.variables(len(v))
    cones.cone(ratio + 1.0, ratio + -1.0, root * 2.0)
    push = cones.variables(len(v)) * unit
    cones.equal(push[ends] * (1 / unit), 0.0)
    square = ratio * v**2
    early = step * (v[:-1] / 2 + a[:-1] * step / 6 + np.diff(a) * step / 24) / length
    cones.equal(
        (square[1:] + square[:-1] * -1.0) * (1 / (2 * length * unit))
        + push[:-1] * (-early / unit) + push[1:] * ((early - 1) / unit), 0.0,
    )  # fmt: skip
    stretch = cones.variables(count)  # of time
    mean = root[1:] * (v[1:] / sums) + root[:-1] * (v[:-1] / sums)
    cones.cone(stretch + mean, stretch + mean * -1.0, stretch * 0.0 + 2.0)
    cones.keep(square, push, all_places)
    faster = [(ratio[side : side + count] + -1.0) * (v[side : side + count] / (2 * sums))
              for side in (0, 1)]  # fmt: skip
    tangent = (faster[0] + faster[1]) * -demands.jerk + demands.jerk
    change = (push[1:] + push[:-1] * -1.0) * (1 / step)
    for side in (0, 1):
        at = slice(side, side + count)
        parts = [
            change * demands.along[at, axis]
            + push[at] * (3 * v[at] * demands.bend[at, axis])
            + square[at] * (v[at] * demands.twist[at, axis])
            for axis in range(3)
        ]
        cones.cone(tangent, *parts)
    if np.isfinite(demands.snap):
        turn = change[1:] + change[:-1] * -1.0
        beats, outer = (step[1:] + step[:-1]) / 2, np.array([0, count - 1])
        for rate in (turn * (1 / beats), change[outer] * (2 / step[outer])):
            cones.atmost(rate, demands.snap)
            cones.atmost(rate * -1.0, demands.snap)
    found = cones.minimise(stretch * step)
    if found is None:
        return None
    speed = np.sqrt(np.maximum(square.at(found), 0))
    return _of_constant_jerk(length, speed, push.at(found))


def _of_constant_jerk(
    length: Float[np.ndarray, "intervals"],
    speed: Float[np.ndarray, "places"],
    acceleration: Float[np.ndarray, "places"],
) -> _States | None:
    """A law whose s̈ is linear in time between places, from what a programme found there.

    Times are those in which a constant jerk takes the load along the intervals. What then lacks of
    rest at the goal is put right by a polynomial, of a thousandth of the acceleration or so.
    """
    middle = (speed[1:] + speed[:-1]) / 2
    rest = np.maximum(middle**2 - np.diff(acceleration) * length / 3, 0)
    step = 2 * length / (middle + np.sqrt(rest))
    times = np.append(0.0, np.cumsum(step))
    share = times / times[-1]
    hump = share * (1 - share)
    shapes = np.stack([acceleration, hump, hump * (1 - 2 * share)], axis=1)
    reached = np.array([[each[-1] for each in _integrals(step, shape)] for shape in shapes.T])
    wanted = np.array([0.0, length.sum()]) - reached[0]
    if not np.isfinite(reached).all():
        return None
    acceleration = acceleration + shapes[:, 1:] @ np.linalg.solve(reached[1:].T, wanted)
    speed, arc = _integrals(step, acceleration)
    speed[-1], arc[-1] = 0.0, length.sum()
    return _States(times, arc, speed, acceleration)


def _integrals(step: np.ndarray, acceleration: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Speeds and arc lengths of an acceleration that is linear between times, from rest."""
    speed = np.append(0.0, np.cumsum(step * (acceleration[1:] + acceleration[:-1]) / 2))
    gone = step * speed[:-1] + step**2 * (2 * acceleration[:-1] + acceleration[1:]) / 6
    return speed, np.append(0.0, np.cumsum(gone))
