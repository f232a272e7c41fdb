"""Random scenes with any robots: sound, of their stated kinds, and the same for the same seed."""

import numpy as np
import pytest

import jaxsusp as js
from jaxsusp.scenario.ownunits import Frame
from jaxsusp.studies.rigs import (
    FARTHEST,
    LARGEST,
    benchmark_rig,
    drawn_kind,
    drawn_rig,
    elsewhere,
)


@pytest.mark.fast
def test_rigs_of_every_kind_are_drawn():
    generators = [np.random.default_rng(seed) for seed in range(120)]
    rigs = [drawn_rig(each, drawn_kind(each)) for each in generators]
    assert {len(rig["robots"]) for rig, _ in rigs} == {3, 4, 5, 6}
    assert {rig["drive"] for rig, _ in rigs} == {"cable", "end", "base", "hybrid"}
    assert sum(rig["payload"]["attachments"] != "hook" for rig, _ in rigs) > 0
    sizes = np.array([frame.length for _, frame in rigs])
    assert 1 / LARGEST <= sizes.min() < 0.1
    assert 10 < sizes.max() <= LARGEST
    far = [np.hypot(*frame.origin[:2]) for _, frame in rigs]
    assert min(far) < 10
    assert 1e6 < max(far) <= FARTHEST


def test_a_scene_of_any_rig_is_admissible_blocked_and_the_same_again():
    scenario = js.random_scenario(3, 6, "any")
    assert scenario.name == "any-3-6"
    assert len(scenario.obstacles) == 6
    assert scenario.digest == js.random_scenario(3, 6, "any").digest
    assert scenario.units != Frame()
    line = np.linspace(scenario.task.start, scenario.task.goal, 7)[1:-1]
    assert js.plan_through(scenario, line).certificate.contacts


@pytest.mark.fast
def test_a_ring_holds_as_many_robots_as_asked():
    assert benchmark_rig(3) == benchmark_rig()
    robots = benchmark_rig(8)["robots"]
    assert robots[0]["base"] == list(benchmark_rig()["robots"][0]["base"])
    for place, radius in (("base", 5.0), ("end", 6.0)):
        places = np.array([robot[place] for robot in robots])
        np.testing.assert_allclose(np.linalg.norm(places[:, :2], axis=1), radius, atol=2e-6)
        apart = np.linalg.norm(places - np.roll(places, 1, axis=0), axis=1)
        np.testing.assert_allclose(apart, 2 * radius * np.sin(np.pi / 8), atol=2e-6)


@pytest.mark.fast
def test_drawn_rigs_have_the_robots_asked_for():
    kinds = [drawn_kind(np.random.default_rng(seed), 5) for seed in range(9)]
    assert {(kind.robots, kind.drive, kind.hook) for kind in kinds} == {(5, "cable", True)}


@pytest.mark.fast
def test_what_is_moved_nowhere_is_the_same_scene(scenarios):
    assert elsewhere(scenarios[0], Frame()) is scenarios[0]


@pytest.mark.fast
def test_an_unknown_rig_is_told():
    with pytest.raises(js.InputError, match="choose from any, benchmark"):
        js.random_scenario(0, 5, "mine")
