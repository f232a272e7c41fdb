"""Limits that are proved at every instant: enclosures of the motion, and what follows from them."""

import functools
from itertools import pairwise

import numpy as np
import pytest
from scipy.integrate import quad

import jaxsusp as js
from experiments.proofs import NO_DISTANCES, outcome, random_motion
from jaxsusp.suspension.rigging import Rigging, ends_beside
from jaxsusp.trajectory.smoothpath import SmoothPath
from jaxsusp.trajectory.timelaw import TimeLaw
from jaxsusp.verify.constraints import sampled_report, with_proofs
from jaxsusp.verify.limits.arclength import ArcLength
from jaxsusp.verify.limits.passage import Course, edges_of
from jaxsusp.verify.limits.pieces import Pieces
from jaxsusp.verify.limits.quantities import System, quantity_of
from jaxsusp.verify.limits.strips import Strip
from jaxsusp.verify.motionlimits import motion_limits

SAMPLES = 33
"""Instants of every interval that are looked at."""


@functools.cache
def motion(seed: int) -> Rigging:
    return random_motion(seed)


def intervals(rigging: Rigging, longest: float, count: int = 40) -> tuple[np.ndarray, ...]:
    """Intervals of time, each within one piece of the law, and instants in them."""
    rng = np.random.default_rng(7)
    breaks = rigging.law.law.x
    piece = rng.integers(0, len(breaks) - 1, count)
    low = rng.uniform(breaks[piece], breaks[piece + 1])
    high = np.minimum(low + longest * rng.uniform(0, 1, count), breaks[piece + 1])
    shares = np.linspace(0, 1, SAMPLES)[:, None]
    return low, high, low + shares * (high - low)


def assert_holds(strip: Strip, values: np.ndarray, slack: float = 1e-9) -> None:
    """Values (instants, intervals, …) are between the bounds, and most bounds are finite."""
    allowed = slack * (1 + np.abs(values))
    assert (values >= strip.lower - allowed).all()
    assert (values <= strip.upper + allowed).all()
    assert np.isfinite(strip.lower).mean() > 0.7


def at(rigging: Rigging, times: np.ndarray, values) -> np.ndarray:
    """What a function of times says at instants of intervals."""
    found = np.asarray(values(times.ravel()))
    return found.reshape(*times.shape, *found.shape[1:])


# The motion


@pytest.mark.parametrize("seed", [1, 5, 10])
@pytest.mark.parametrize("longest", [0.2, 0.01])
def test_the_motion_stays_in_its_strips(seed, longest):
    rigging = motion(seed)
    low, high, times = intervals(rigging, longest)
    with np.errstate(all="ignore"):
        found = Course(rigging).over(low, high)
        for name in ("position", "velocity", "acceleration", "jerk"):
            values = at(rigging, times, lambda t, name=name: getattr(rigging.law.at(t), name))
            scale = np.abs(values).max()
            assert_holds(getattr(found, name), values, 1e-7 * scale)


@pytest.mark.fast
def test_arc_lengths_are_as_exact_as_they_say():
    corner = np.array([[0, 0, 0], [1, 0, 0], [1.001, 0.001, 0], [1, 1, 0], [1, 1.002, 0.0]])
    path = SmoothPath(np.vstack([corner, corner[::-1] + np.array([0, 0, 0.4])]))
    arc = ArcLength(Pieces.of_splines([path.curve]))
    low, high = path.span
    u = np.linspace(low, high, 7)
    length, wrong = arc.at(u)
    knots = path.spline.u
    for place, found, error in zip(u, length, wrong, strict=True):
        cuts = np.unique(np.clip(knots, low, place))
        known = sum(
            quad(lambda v: np.linalg.norm(path.derivatives[0](v)), *cut, epsabs=1e-13, limit=400)[0]
            for cut in pairwise(cuts)
        )
        assert abs(found - known) <= error + 1e-11
    assert wrong.max() < 1e-10


@pytest.mark.fast
def test_pieces_say_how_the_highest_derivative_jumps():
    rng = np.random.default_rng(3)
    path = SmoothPath(np.cumsum(rng.normal(size=(9, 3)), axis=0))
    pieces = Pieces.of_splines([path.curve])
    place = np.array([sum(path.span) / 2])
    which, taylor = pieces.at(place)
    for n in range(6):
        known = path.curve(place, nu=n) / np.prod(np.arange(1, n + 1))
        np.testing.assert_allclose(taylor[n], known, rtol=1e-9, atol=1e-10)
    near, far = (pieces.jump(which, place - away, place + away) for away in (1e-6, 2.0))
    assert (near == 0).all()
    fifth = path.curve(np.linspace(place - 2, place + 2, 999)[:, 0], nu=5) / 120
    assert (np.abs(fifth - taylor[5]).max(axis=0) <= far[0] * (1 + 1e-9)).all()


# What follows from it


QUANTITIES = {
    "least length": lambda loads: loads.lengths,
    "least tension": lambda loads: loads.tensions,
    "stability factor S_c": lambda loads: loads.stability[:, None],
}


@pytest.mark.parametrize("seed", [3, 4, 10])
def test_what_cables_carry_stays_in_its_strips(seed):
    """Three cables, four, and ends that move."""
    rigging = motion(seed)
    low, high, times = intervals(rigging, 0.2)
    loads = rigging.loads(times.ravel())
    inside = np.array(rigging.scenario.limits.tension)
    with np.errstate(all="ignore"):
        system = System(Course(rigging).over(low, high))
        for name, values in QUANTITIES.items():
            quantity = quantity_of(rigging, name, "")
            assert quantity is not None
            known = values(loads).reshape(*times.shape, -1)
            if rigging.cables > 3:  # stated where the load can be held within the limits
                held = loads.tensions.reshape(*times.shape, -1)
                fine = ((held >= inside[0]) & (held <= inside[1])).all(axis=(0, 2))
                found = quantity(system)[fine]
                assert_holds(found, known[:, fine])
            else:
                assert_holds(quantity(system), known)


def test_joints_stay_in_their_strips():
    rigging = motion(6)  # arms carry the ends along
    assert rigging.moves
    assert not rigging.rolls
    low, high, times = intervals(rigging, 0.5)
    flat = times.ravel()

    def joints(t: np.ndarray) -> np.ndarray:
        return np.rad2deg(rigging.joints_at(rigging.ends_at(rigging.law.parameter(t))))

    order = np.argsort(flat)
    known = np.empty((len(flat), rigging.cables, 3))
    known[order] = joints(flat[order])
    step = 1e-5
    grown = (joints(np.sort(flat) + step) - joints(np.sort(flat) - step)) / (2 * step)
    rates = np.empty_like(known)
    rates[order] = grown
    with np.errstate(all="ignore"):
        system = System(Course(rigging).over(low, high))
        assert_holds(system.arms.angles, known.reshape(*times.shape, -1, 3))
        assert_holds(system.arms.speeds, rates.reshape(*times.shape, -1, 3), 1e-4)


@pytest.mark.fast
def test_the_gauge_of_still_ends_is_the_least_of_linear_functions():
    square = np.array([[0, 0], [2, 0], [2, 2], [0, 2.0]])
    slopes, offsets = edges_of(np.vstack([square, [[1, 0.5]]]))  # one end inside counts for nothing

    def inside(place):
        return (slopes @ np.array(place) + offsets).min()

    assert inside((1, 1)) == pytest.approx(1)
    assert inside((2, 1)) == pytest.approx(0)
    assert inside((1, 0.5)) == pytest.approx(0.5)
    assert inside((3, 1)) == pytest.approx(-1)


# Proofs


@pytest.mark.parametrize("seed", [0, 1, 3, 4, 6, 10])
def test_limits_are_proved_where_they_are_kept_and_nowhere_else(seed):
    found = outcome(motion(seed))
    assert len(found.kept) >= 6
    assert found.wrong == []
    assert found.refused == []


def rig(**limits) -> Rigging:
    """Scenario 1 along a bow."""
    content = js.load_scenario("scenario-1").model_dump()
    content["limits"] = {**content["limits"], **limits}
    scenario = js.Scenario.model_validate(content)
    bow = np.linspace(scenario.task.start, scenario.task.goal, 12)
    bow[:, 0] += 0.8 * np.sin(np.linspace(0, np.pi, 12))
    law = TimeLaw.through(bow, scenario.task.duration)
    return Rigging.of(scenario, law, ends_beside(scenario, bow))


FEW = np.linspace(0, 40, 4)
"""Instants that see little of the motion."""


def test_what_is_broken_between_the_instants_is_found():
    free = rig()
    name = "tilt of the load"

    def tilt(rigging: Rigging, times: np.ndarray | None):
        return next(
            each for each in sampled_report(rigging, NO_DISTANCES, times) if each.name == name
        )

    seen, worst = tilt(free, FEW), tilt(free, None)
    assert seen.value < worst.value
    limit = (seen.value + worst.value) / 2
    strict = rig(posture_deg=limit)
    sampled = sampled_report(strict, NO_DISTANCES, FEW)
    assert all(each.ok for each in sampled)
    line = next(each for each in with_proofs(strict, sampled) if each.name == name)
    assert not line.ok
    assert not line.proved
    assert line.value > limit
    law = strict.law.at(np.array([line.time]))
    sideways = np.hypot(*law.acceleration[0, :2])
    known = np.rad2deg(np.arctan2(sideways, 9.81 + law.acceleration[0, 2]))
    assert line.value == pytest.approx(known, abs=1e-6)


@pytest.mark.parametrize("size", [1e-9, 1e-3])
def test_a_limit_of_motion_is_broken_by_a_hundred_thousandth_however_small(size):
    """And none is proved with a bound beyond it."""
    free = rig()
    law = free.law.restated(free.law.path, 1.0, (_fastest(free, "acceleration") / size) ** 0.5)
    for name, beyond in (("acceleration", 1e-5), ("acceleration", -1e-5), ("speed", 1e-5)):
        slow = Rigging(free.scenario, law, free.end_path, free.elbow_up)
        limit = _fastest(slow, name) / (1 + beyond)
        limits = slow.scenario.limits.model_copy(update={name: limit})
        scenario = slow.scenario.model_copy(update={"limits": limits})
        slow = Rigging(scenario, law, free.end_path, free.elbow_up)
        (line,) = with_proofs(slow, motion_limits(slow))
        assert line.ok == (beyond < 0)
        assert line.bound is None or line.bound <= limit * (1 + 1e-5)


def test_rounding_beyond_ordinary_limits_is_what_it_was():
    ordinary = rig(speed=0.5, acceleration=0.1, jerk=0.01, cable_speed=0.4)
    report = (*sampled_report(ordinary, NO_DISTANCES), *motion_limits(ordinary))
    slacks = {each.name: each.slack for each in report}
    names = ("speed", "acceleration", "jerk", "speed of a cable", "tilt of the load")
    assert [slacks[name] for name in names] == [1e-9] * 5
    assert slacks["stability factor S_c"] == 1e-9


def _fastest(rigging: Rigging, name: str) -> float:
    motion = rigging.law.at(np.linspace(0, rigging.law.duration, 2001))
    vector = {"speed": motion.velocity, "acceleration": motion.acceleration}[name]
    return float(np.linalg.norm(vector, axis=1).max())


def test_every_line_of_a_hook_with_still_ends_is_proved_and_bounds_are_near():
    rigging = rig(stability=0.3, posture_deg=2.0)
    report = with_proofs(rigging, sampled_report(rigging, NO_DISTANCES))
    for each in report:
        assert each.proved, each.name
        assert each.bound is not None
        near = each.low if each.value - each.low < each.high - each.value else each.high
        size = max(abs(near), each.margin)
        assert abs(each.bound - each.value) <= 0.0101 * size, each.name


def test_of_separate_attachments_what_hangs_is_sampled_and_what_stands_is_proved():
    rim = js.load_scenario("rim").own
    hook = rig()
    rigging = Rigging(rim, hook.law, hook.end_path, hook.elbow_up)
    report = with_proofs(rigging, sampled_report(hook, NO_DISTANCES))
    kept = {each.name: each.kept for each in report}
    assert kept["least tension"] == kept["least length"] == "sampled"
    assert kept["inside the workspace"] == kept["reach"] == "proved"


def test_a_path_with_a_place_of_no_speed_is_refused_rather_than_proved_wrongly():
    """Out and back along the same line: somewhere |p'| is zero, and nothing is known there."""
    scenario = js.load_scenario("scenario-1")
    start = np.array(scenario.task.start)
    points = start + np.array([0, 0.2, 0.4, 0.2, 0.0])[:, None] * [0, -1.0, 0]
    rigging = Rigging.of(scenario, TimeLaw.through(points, 40.0), ends_beside(scenario, points))
    report = with_proofs(rigging, sampled_report(rigging, NO_DISTANCES))
    assert {each.kept for each in report if each.name == "least tension"} <= {"sampled", "broken"}
