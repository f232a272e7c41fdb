"""Pictures of one task are alike whatever its size and wherever it is."""

import numpy as np
import pytest

import jaxsusp as js
from jaxsusp.report import freespace
from jaxsusp.report.drawing import scene as scene3d
from jaxsusp.report.drawing.scales import anchor, axis_name, decimals, tick
from jaxsusp.scenario import ownunits


def restated(scenario: js.Scenario, length: float = 1.0, move=(0.0, 0.0, 0.0)) -> js.Scenario:
    """The same task of another size, and elsewhere."""
    return ownunits.restated(scenario, ownunits.Frame(length, 1.0, move))


@pytest.fixture(scope="module")
def scenario() -> js.Scenario:
    return js.load_scenario("scenario-1")


@pytest.mark.fast
def test_a_scale_counts_from_zero_but_far_away_from_a_round_number():
    assert anchor(-3.5, 3.5) == anchor(-120.0, 900.0) == 0
    assert anchor(349996.5, 350003.5) == 350000
    assert 5500100 <= anchor(5500120.0, 5500127.0) <= 5500200
    assert axis_name(0, -3.5, 3.5) == "x (m)"
    assert axis_name(1, 5499996.5, 5500003.5) == "y − 5500000 (m)"
    assert axis_name(2, -20003.5, -19996.5) == "z + 20000 (m)"
    assert tick(350000.3, 350000.0) == "0.3"
    assert [decimals(length) for length in (3.5, 1.0, 0.1, 0.01)] == [2, 2, 3, 4]


@pytest.mark.parametrize("size", [0.1, 3.5])
def test_labels_are_where_they_are_in_the_benchmark(scenario, size):
    """As far as the picture is concerned; numbers on scales are round in m."""

    def labels(axes, unit):
        return {
            text.get_text(): np.array(text.get_position()) / unit
            for text in axes.texts
            if text.get_text() in ("start", "goal", "P₁", "P₂", "P₃")
        }

    for one, other in zip(
        scene3d.scene(scenario).axes, scene3d.scene(restated(scenario, size)).axes, strict=True
    ):
        here, there = labels(one, 1.0), labels(other, size)
        assert {"start", "goal", "P₁"} <= here.keys() == there.keys()
        for text, place in here.items():
            np.testing.assert_allclose(there[text], place, atol=1e-6, err_msg=text)


def test_scales_at_map_coordinates_are_those_of_the_benchmark(scenario):
    there = scene3d.scene(restated(scenario, move=(350000.0, 5500000.0, 0.0)))
    texts = [text.get_text() for text in there.axes[0].texts]
    assert {"x − 350000 (m)", "y − 5500000 (m)", "z (m)", "-3", "3"} <= {*texts}
    assert (
        max(len(text) for text in texts if text.lstrip("-")[:1].isdigit() and " " not in text) < 3
    )
    top = there.axes[1]
    assert top.get_ylabel() == "y − 5500000 (m)"
    top.figure.canvas.draw()
    shown = [text.get_text() for text in top.get_yticklabels()]
    assert {"−3", "0", "3"} <= {*shown}
    assert top.yaxis.get_offset_text().get_text() == ""


def test_robots_stand_on_the_floor_of_a_picture(scenario):
    """On a table or a roof as on the ground."""
    one, other = (
        np.array(scene3d.scene(each).axes[0].patches[0].get_path().vertices)
        for each in (scenario, restated(scenario, move=(0.0, 0.0, 40.0)))
    )
    assert np.ptp(other, axis=0) == pytest.approx(np.ptp(one, axis=0))
    lift = (other - one)[:, 1]
    assert lift == pytest.approx(lift[0])
    assert lift[0] > 30


def test_a_region_far_away_has_all_its_faces(scenario):
    document = restated(scenario, move=(350000.0, 5500000.0, 0.0)).model_dump(exclude_none=True)
    near = js.free_space(scenario, coverage=0.3)
    far = js.free_space(js.Scenario.model_validate(document), coverage=0.3)
    for one, other in zip(near.regions, far.regions, strict=True):
        here, there = freespace._solid(one), freespace._solid(other)
        assert len(here.faces) == len(there.faces)
        np.testing.assert_allclose(there.normals, here.normals, atol=1e-4)
