"""Own units: the same task in any size, mass and place is the same numbers."""

from typing import get_args

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import jaxsusp as js
from jaxsusp.scenario import models
from jaxsusp.scenario.ownunits import DIMENSIONS, GRID, UNITS, Frame, in_words, restated

pytestmark = pytest.mark.fast

SECTIONS = {
    "payload": [models.Payload],
    "limits": [models.Limits],
    "workspace": [models.Workspace],
    "ground": [models.Ground],
    "task": [models.Task],
    "robots": [models.Robot],
    "obstacles": [models.Box, models.Cylinder, models.Sphere, models.Mesh],
}
WITHOUT_UNIT = {
    "kind", "name", "file", "shape", "yaw_deg", "posture_deg", "stability", "safety_factor",
    "joint_limits_deg", "pieces",
}  # fmt: skip

frames = st.builds(
    Frame,
    st.floats(0.05, 20.0),
    st.floats(1e-6, 1e6),
    st.tuples(*[st.floats(-1e7, 1e7)] * 2, st.floats(-1e4, 1e4)),
)


def test_every_key_has_a_unit_or_none():
    """A new key of a scenario has to say what becomes of it in another size or place."""
    for section, tables in SECTIONS.items():
        known = {key for table in tables for key in table.model_fields} - WITHOUT_UNIT
        assert known == set(UNITS[section]), section
    tables = {key for key, field in models.Statement.model_fields.items() if has_model(field)}
    assert tables - {"fitness"} == set(UNITS)


def has_model(field) -> bool:
    def inside(annotation) -> bool:
        return hasattr(annotation, "model_fields") or any(map(inside, get_args(annotation)))

    return inside(field.annotation)


@pytest.mark.parametrize("name", js.scenarios())
def test_the_benchmark_is_in_its_own_units(name):
    scenario = js.load_scenario(name)
    assert scenario.own is scenario
    assert scenario.units == scenario.frame == Frame()


@settings(deadline=None, max_examples=40)
@given(frame=frames, name=st.sampled_from(["scenario-1", "scenario-6", "hybrid", "rim"]))
def test_a_task_anywhere_in_any_size_is_the_same_numbers(frame, name):
    scenario = js.load_scenario(name)
    own = restated(scenario, frame).own
    for section in UNITS:
        for one, other in zip(numbers(own, section), numbers(scenario.own, section), strict=True):
            assert abs(one - other) <= 1.01 * GRID + 4e-9 / frame.length, section
    back = restated(own, own.frame)
    for section in UNITS:
        for one, other in zip(
            numbers(back, section), numbers(restated(scenario, frame), section), strict=True
        ):
            scale = max(frame.length, frame.mass, 1.0)
            assert abs(one - other) <= 2 * GRID * scale * np.sqrt(scale) + 4e-9


def numbers(scenario, section: str) -> list[float]:
    def flat(value):
        if isinstance(value, dict):
            return [number for each in value.values() for number in flat(each)]
        if isinstance(value, list | tuple):
            return [number for each in value for number in flat(each)]
        return [float(value)] if isinstance(value, int | float) else []

    return flat(scenario.model_dump()[section])


@settings(deadline=None, max_examples=40)
@given(
    length=st.sampled_from([0.05, 0.1, 0.25, 1.0, 3.0, 20.0]),
    mass=st.sampled_from([1e-4, 0.05, 1.0, 80.0]),
    origin=st.tuples(*[st.integers(-(10**7), 10**7)] * 3),
)
def test_sizes_and_places_that_people_choose_are_the_very_same_input(length, mass, origin):
    """So that float32 and searches, which see own units alone, do the very same."""
    placed = restated(js.load_scenario("scenario-1"), Frame(length, mass, origin))
    known = restated(js.load_scenario("scenario-1"), Frame(2.0, 1.0, (350000, 5500000, 0)))
    assert placed.own.digest == known.own.digest


def test_what_is_copied_from_own_units_stays_in_them():
    scenario = restated(js.load_scenario("scenario-1"), Frame(0.5, 2.0, (3, 4, 5)))
    own = scenario.own
    tighter = own.limits.model_copy(update={"clearance": 0.07})
    copy = own.model_copy(update={"limits": tighter})
    assert copy.own is copy
    assert copy.frame == own.frame
    assert scenario.own.limits.clearance == 0.05
    changed = scenario.model_copy(update={"name": "other"})
    assert changed.own.name == "other"


def test_frames_turn_numbers_and_places_and_back():
    frame = Frame(4.0, 3.0, (10.0, -20.0, 1.0))
    assert frame.factor("s") == 2
    assert frame.factor("N") == 3  # g keeps its number
    assert frame.factor("m/s²") == 1
    assert frame.factor("N m") == 12
    assert set(DIMENSIONS) >= {"m", "N", "s", "°", ""}
    np.testing.assert_allclose(frame.place([1.0, 1.0, 1.0]), [14, -16, 5])
    np.testing.assert_allclose(frame.inverse.place(frame.place([1.0, 2.0, 3.0])), [1, 2, 3])
    np.testing.assert_allclose(frame.inside(frame.place([1.0, 2.0, 3.0])), [1, 2, 3])


def test_places_far_away_are_told_to_the_millimetre():
    assert in_words((0.0, 2.0, 1.23456)) == "(0, 2, 1.235)"
    assert in_words((350000.12345, 5500002.0, 1.0)) == "(350000.123, 5500002, 1)"


def test_lengths_are_told_to_a_thousandth_of_the_unit():
    assert Frame().thousandths(0.08) == "0.080"
    assert Frame(0.05).thousandths(0.00012) == "0.00012"
    assert Frame(20.0).thousandths(1.5) == "1.500"
