"""A task that is admissible begins and ends in its free space, however near things are."""

import numpy as np
import pytest

import jaxsusp as js
from jaxsusp.freespace.bodies import bodies_of
from jaxsusp.freespace.cells.doorstep import opened
from jaxsusp.freespace.cells.forbidden import forbidden_of
from jaxsusp.freespace.iris import Bodies

START = (0.0, 2.0, 1.0)  # of scenario 1, whose load is 0.1 m in radius and 0.3 m high


def beside(gap: float, kind: str) -> js.Scenario:
    """Scenario 1 with one obstacle that leaves the load so much (m) at the start."""
    top, side = 0.8 - gap, 2 - 0.1 - 0.05 - 0.4 - gap
    obstacle = {
        "box": {"center": (0.0, 2.0, top / 2), "size": (1.0, 1.0, top)},
        "cylinder": {"center": (0.3, side, 0.5), "radius": 0.4, "height": 1.0},
        "sphere": {"center": (0.0, side, 1.0), "radius": 0.4},
    }[kind] | {"kind": kind, "name": "near"}
    if kind == "cylinder":  # not where its polyhedron touches it
        away, angle = 0.4 + 0.15 + gap, np.pi / 24
        obstacle["center"] = (away * np.sin(angle), 2 - away * np.cos(angle), 0.5)
    tables = js.load_scenario("scenario-1").model_dump() | {"obstacles": [obstacle]}
    return js.Scenario.model_validate(tables)


@pytest.mark.parametrize("kind", ["box", "cylinder", "sphere"])
@pytest.mark.parametrize("gap", [1e-6, 5e-5, 1e-3])
def test_a_start_that_is_clear_is_in_the_free_space(gap, kind):
    scenario = beside(gap, kind)
    space = js.free_space(scenario, routes=False, cache=False)
    assert space.connected
    assert space.contains(np.array([START])).all()


@pytest.mark.fast
@pytest.mark.parametrize("kind", ["box", "cylinder", "sphere"])
def test_nothing_that_is_forbidden_is_cut_off(kind):
    scenario = beside(2e-6, kind)
    before = bodies_of(scenario)
    after = opened(scenario, before)
    assert any(one is not other for one, other in zip(before, after, strict=True))
    assert not Bodies(after).holding(np.array([START])).any()
    points = np.random.default_rng(0).uniform([-1.5, 0.5, 0.2], [1.5, 3.5, 2.5], (20000, 3))
    forbidden = forbidden_of(scenario)
    for number, body in enumerate(after):
        inside = forbidden.room(points, np.full(len(points), number), inner=True) < -1e-6
        assert (body.faces.excess(points[inside]) <= 1e-9).all(), body.name


@pytest.mark.fast
def test_bodies_that_leave_room_stay_as_they_are(scenarios):
    for scenario in scenarios:
        bodies = bodies_of(scenario)
        pairs = zip(bodies, opened(scenario, bodies), strict=True)
        assert all(one is other for one, other in pairs)
