"""Laws of bounded jerk against closed forms, their bound, and their limits at any instant."""

import numpy as np
import pytest
from lifts import demands_of, straight, winding

from jaxsusp.trajectory.fastest import least_time
from jaxsusp.trajectory.jerklimited import jerk_limited
from jaxsusp.trajectory.shaping import shaped
from jaxsusp.trajectory.timelaw import TimeLaw


@pytest.mark.fast
def test_with_jerk_alone_a_straight_lift_takes_its_closed_form():
    """Jerk J, -J, -J, J for a quarter of the time each: L = 2 J (T/4)³."""
    path, jerk = straight(3.0), 0.9
    law = jerk_limited(TimeLaw.least_jerk(path, 12.0), lambda arc: demands_of(path, arc, jerk=jerk))
    assert law.duration == pytest.approx(4 * (3.0 / (2 * jerk)) ** (1 / 3), rel=0.01)
    found = np.abs(law.at(np.linspace(0, law.duration, 4001)).jerk).max()
    assert found <= jerk * 1.02


@pytest.mark.parametrize("seed", range(4))
def test_limits_nearly_hold_at_any_instant_and_the_bound_is_below(seed):
    path, limits = winding(seed), {"acceleration": 0.6, "jerk": 0.8}
    law = jerk_limited(TimeLaw.least_jerk(path, 40.0), lambda arc: demands_of(path, arc, **limits))
    motion = law.at(np.random.default_rng(seed).uniform(0, law.duration, 4000))
    over = max(
        np.sqrt(np.linalg.norm(motion.acceleration, axis=1).max() / limits["acceleration"]),
        np.cbrt(np.linalg.norm(motion.jerk, axis=1).max() / limits["jerk"]),
    )
    assert 0.99 < over < 1.08  # between its places a law may need so much more time
    edges = np.linspace(0, path.length, 201)
    bound = least_time(edges, lambda arc: demands_of(path, arc, **limits))
    assert bound is not None
    assert bound.duration < law.duration < 2 * bound.duration
    assert (law.law(np.linspace(0, law.duration, 999), nu=1) >= -1e-9).all()


@pytest.mark.fast
def test_with_limited_snap_jerk_has_no_steps():
    path = winding(1)
    limits = {"acceleration": 0.6, "jerk": 0.8, "snap": 0.8}
    law = jerk_limited(TimeLaw.least_jerk(path, 40.0), lambda arc: demands_of(path, arc, **limits))
    along = law.law(np.linspace(0, law.duration, 4001)[1:-1], nu=3)
    assert abs(along[0]) < 0.02
    assert np.abs(np.diff(along)).max() < 2 * 0.8 * law.duration / 4000  # within twice its limit
    for state in (law.law(0.0, nu=1), law.law(law.duration, nu=1), law.law(law.duration, nu=2)):
        assert abs(float(state)) < 1e-9


@pytest.mark.fast
def test_a_shaped_law_is_the_mean_of_three_and_leaves_no_swing():
    path, period = straight(2.0), 0.9
    plain = TimeLaw.least_jerk(path, 3.0)
    law = shaped(plain, period)
    assert law.duration == pytest.approx(3.0 + period)
    times = np.linspace(0, law.duration, 500)
    parts = [plain.law(np.clip(times - late, 0, 3.0)) for late in (0, period / 2, period)]
    np.testing.assert_allclose(law.law(times), np.average(parts, axis=0, weights=[1, 2, 1]))
    fine = np.linspace(0, law.duration, 20_001)
    spectrum = [
        abs(np.trapezoid(each.law(np.clip(fine, 0, each.duration), nu=2) * (fine <= each.duration)
                         * np.exp(2j * np.pi * fine / period), fine))
        for each in (plain, law)
    ]  # fmt: skip
    assert spectrum[1] < 1e-4 * spectrum[0]
