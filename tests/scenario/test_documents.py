"""Whatever the text of a scenario file: a scenario, or sentences."""

import math
import tomllib

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from statements import MINIMAL

from jaxsusp.errors import ScenarioError
from jaxsusp.scenario.scenario import Scenario, load_scenario
from jaxsusp.scenario.toml import value_text


def inline(value):
    """Any value as TOML, tables within it inline."""
    if isinstance(value, dict):
        return f"{{{', '.join(f'{value_text(key)} = {inline(v)}' for key, v in value.items())}}}"
    if isinstance(value, list):
        return f"[{', '.join(map(inline, value))}]"
    return value_text(value)


def text_of(document):
    return "".join(f"{value_text(key)} = {inline(value)}\n" for key, value in document.items())


def assert_loads_or_explains(text):
    try:
        scenario = Scenario.from_toml(text, "my.toml")
    except ScenarioError as error:
        lines = error.problems
    else:
        assert Scenario.from_toml(scenario.to_toml()) == scenario
        return
    assert lines
    for line in lines:
        assert line.startswith("my.toml: ")
        assert "; " in line
        assert "\n" not in line
        assert not any(junk in line for junk in ("pydantic", "http", "type=", "Input should"))


def numbers(low, high):
    return st.floats(low, high) | st.integers(math.ceil(low), math.floor(high))


def points(low, high):
    return st.lists(numbers(low, high), min_size=3, max_size=3)


OBSTACLE = st.one_of(  # under the floor, where nothing hangs
    st.fixed_dictionaries(
        {"kind": st.just("box"), "center": points(-50, -40), "size": points(0.01, 10)},
        optional={"name": st.text(), "yaw_deg": numbers(-400, 400)},
    ),
    st.fixed_dictionaries(
        {
            "kind": st.just("cylinder"),
            "center": points(-50, -40),
            "radius": numbers(0.01, 10),
            "height": numbers(0.01, 10),
        },
        optional={"name": st.text()},
    ),
    st.fixed_dictionaries(
        {"kind": st.just("sphere"), "center": points(-50, -40), "radius": numbers(0.01, 10)},
        optional={"name": st.text()},
    ),
)


def _name(obstacle):
    """What an obstacle must not share with another one; those without names share nothing."""
    return obstacle.get("name") or id(obstacle)


@st.composite
def documents(draw):
    """Valid scenarios: robots on a circle, the load among them."""
    robots = []
    count = draw(st.integers(3, 6))
    for k in range(count):
        angle = 2 * math.pi * k / count
        x, y = math.cos(angle), math.sin(angle)
        robots.append({"base": [5 * x, 5 * y, 0], "links": [4, 3, 2], "end": [6 * x, 6 * y, 7]})
    place = st.tuples(numbers(-2, 2), numbers(-2, 2), numbers(0.5, 5)).map(list)
    optional = {
        "drive": st.sampled_from(["cable", "end", "base", "hybrid"]),
        "name": st.text(min_size=1),
        "obstacles": st.lists(OBSTACLE, max_size=4, unique_by=_name),
        "fitness": st.fixed_dictionaries(
            {}, optional={"weights": st.lists(numbers(0, 1e9), min_size=6, max_size=6)}
        ),
        "limits": st.fixed_dictionaries(
            {},
            optional={
                "tension": st.tuples(numbers(0, 10), numbers(11, 1e6)).map(list),
                "clearance": numbers(0, 1),
                "joint_limits_deg": st.lists(
                    st.just([[-180, 180]] * 3), min_size=count, max_size=count
                ),
            },
        ),
    }
    size = {"mass": numbers(1e-3, 1e6), "radius": numbers(0.01, 2), "height": numbers(0.01, 2)}
    below = st.tuples(st.just(0), st.just(0), numbers(-0.5, 0)).map(list)
    rim = [[0.1 * robot["base"][0], 0.1 * robot["base"][1], 0.1] for robot in robots]
    required = {
        "payload": st.fixed_dictionaries(
            {**size, "attachments": st.just("hook")}, optional={"center_of_mass": below}
        )
        | st.fixed_dictionaries(
            {**size, "attachments": st.just(rim)}, optional={"center_of_mass": points(-0.5, 0.5)}
        ),
        "task": st.fixed_dictionaries(
            {"start": place, "goal": place}, optional={"duration": numbers(0.1, 1e6)}
        ),
        "robots": st.just(robots),
        "ground": st.just("none") | st.fixed_dictionaries({"height": numbers(-9, -4)}),
    }
    return draw(st.fixed_dictionaries(required, optional=optional))


@settings(deadline=None, max_examples=30)  # numbers of robots compile on first use
@given(documents())
def test_any_valid_document_loads_and_comes_back_unchanged(document):
    scenario = Scenario.from_toml(text_of(document))
    again = Scenario.from_toml(scenario.to_toml(), "else/where.toml")
    assert again == scenario
    assert (again.digest, hash(again)) == (scenario.digest, hash(scenario))


@given(st.text())
def test_random_text_is_refused_in_sentences(text):
    assert_loads_or_explains(text)
    assert_loads_or_explains(MINIMAL + text)


ANYTHING = st.recursive(
    st.booleans() | st.integers() | st.floats() | st.text() | st.dates() | st.times(),
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(st.text(), inner, max_size=3),
    max_leaves=6,
)


def spots(document):
    """Every (container, key) of a document."""
    keys = document if isinstance(document, dict) else range(len(document))
    for key in keys:
        yield document, key
        if isinstance(document[key], dict | list):
            yield from spots(document[key])


BENCHMARK = load_scenario("scenario-1").to_toml()


@settings(deadline=None, max_examples=100)
@given(st.data())
def test_a_wrong_value_at_any_place_loads_or_is_explained(data):
    document = tomllib.loads(BENCHMARK)
    container, key = data.draw(st.sampled_from(list(spots(document))))
    match data.draw(st.sampled_from(["replace", "remove", "add"])):
        case "replace":
            container[key] = data.draw(ANYTHING)
        case "remove":
            del container[key]
        case "add" if isinstance(container, dict):
            container[data.draw(st.text())] = data.draw(ANYTHING)
        case "add":
            container.append(data.draw(ANYTHING))
    assert_loads_or_explains(text_of(document))


@given(st.text())
def test_a_random_name_is_refused_in_a_sentence(name):
    with pytest.raises(ScenarioError):
        load_scenario(f"no-such-folder/{name}.toml")
