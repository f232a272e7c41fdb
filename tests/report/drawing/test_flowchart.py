"""Flow charts say what the source says."""

import inspect
import textwrap

import pytest

from jaxsusp.freespace import iris
from jaxsusp.report.drawing import sourceflow
from jaxsusp.report.drawing.flowchart import chart
from jaxsusp.report.drawing.sourceflow import Choice, Leave, Loop, Step, first_sentence, flow

pytestmark = pytest.mark.fast


def names(elements):
    """All steps, whatever they stand in."""
    for each in elements:
        match each:
            case Step(name, _):
                yield name
            case Loop(_, body):
                yield from names(body)
            case Choice(_, then, otherwise):
                yield from names((*then, *otherwise))


def test_iris_is_read_with_its_loop_and_the_ways_out_of_it():
    elements = flow(iris.iris)
    before, ball, loop, end = elements
    assert (before.name, ball.name) == ("require_free", "ball")
    assert loop.head == "for _ in range(limit)"
    assert [*names(loop.body)] == ["separate", "largest_ellipsoid"]
    ways_out = [each.condition for each in loop.body if isinstance(each, Choice)]
    assert ways_out[1] == "found is None"
    assert len(ways_out) == 3
    assert end == Leave("return region")


def test_a_step_that_is_renamed_is_renamed_in_the_chart(monkeypatch):
    """The chart can fail: it follows the source, and does not know what is no longer called."""
    source = inspect.getsource(iris.iris).replace("separate(", "part_from(")
    monkeypatch.setattr(inspect, "getsource", lambda _: source)
    assert "part_from" not in [*names(flow(iris.iris))]  # there is no such function
    monkeypatch.setattr(iris, "part_from", iris.separate, raising=False)
    monkeypatch.setattr(inspect.unwrap(iris.separate), "__name__", "part_from")
    assert "part_from" in [*names(flow(iris.iris))]


def test_steps_say_the_first_sentence_of_their_documentation():
    separate = next(each for each in flow(iris.iris)[2].body if isinstance(each, Step))
    assert separate.says == first_sentence(iris.separate)
    assert iris.separate.__doc__.startswith(separate.says)

    def cites():
        """As in Eq. 20 of the paper. More."""

    assert first_sentence(cites) == "As in Eq. 20 of the paper"


def test_left_out_steps_and_other_statements(monkeypatch):
    source = """
    def iris(x):
        with suppress(ValueError):
            while separate(x):
                if x:
                    _require_free(x)
                else:
                    break
        return separate(_require_free(x))
    """
    monkeypatch.setattr(inspect, "getsource", lambda _: textwrap.dedent(source))
    loop, inner, outer, end = flow(iris.iris)
    (choice,) = loop.body
    assert [*names(choice.then)] == ["require_free"]
    assert choice.otherwise == (Leave("break"),)
    assert (inner.name, outer.name, end.how) == ("require_free", "separate", "return")
    assert "require_free" not in [*names(flow(iris.iris, {"_require_free"}))]


def test_what_is_reached_through_others():
    found = sourceflow.reached(iris.iris)
    assert {*map(inspect.unwrap, (iris.separate, iris.proved_apart, iris._tangent))} <= found


def test_the_chart_writes_every_step_inside_of_the_picture():
    figure = chart(flow(iris.iris), "begin", 4.6)
    (axes,) = figure.axes
    told = [text.get_text() for text in axes.texts]
    assert told[0] == "begin"
    for name in names(flow(iris.iris)):
        assert name in told
    assert told.count("yes") == 3
    width, height = figure.get_size_inches()
    assert all(0 <= t.get_position()[0] <= width for t in axes.texts)
    assert all(0 <= t.get_position()[1] <= height for t in axes.texts)
    assert min(text.get_fontsize() for text in axes.texts) >= 7
