"""Sections of regions against closed forms, and figures that hold what they should."""

from dataclasses import replace

import numpy as np
import pytest
from matplotlib.patches import Ellipse

import jaxsusp as js
from jaxsusp.freespace.ellipsoid import Ellipsoid
from jaxsusp.freespace.polyhedra import HalfSpaces
from jaxsusp.report import freespace


@pytest.fixture(scope="module")
def small() -> tuple[js.Scenario, js.FreeSpace]:
    scenario = js.load_scenario("scenario-1")
    return scenario, js.free_space(scenario, coverage=0.3)


def area(polygon: np.ndarray) -> float:
    x, y = polygon.T
    return abs(x @ np.roll(y, -1) - y @ np.roll(x, -1)) / 2


@pytest.mark.fast
@pytest.mark.parametrize("height", [0.0, 0.3, 0.99, 1.2])
def test_section_of_an_octahedron(height):
    signs = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], float)
    octahedron = HalfSpaces(signs / np.sqrt(3), np.full(8, 1 / np.sqrt(3)))
    found = freespace.section(octahedron, height, (-3, -3), (3, 3))
    assert area(found) == pytest.approx(2 * (1 - height) ** 2) if height < 1 else len(found) == 0


@pytest.mark.fast
def test_section_is_cut_off_at_the_rectangle():
    everything = HalfSpaces.box(np.full(3, -9.0), np.full(3, 9.0))
    assert area(freespace.section(everything, 0.0, (-1, -2), (3, 2))) == pytest.approx(16)


@pytest.mark.fast
def test_section_of_an_ellipsoid():
    """Points of the ellipse lie on the ellipsoid, at the height asked for."""
    random = np.random.default_rng(0)
    C, d = random.normal(size=(3, 3)), np.array([1.0, -2.0, 3.0])
    top = np.sqrt((C @ C.T)[2, 2])
    ellipse = freespace.ellipse_of(Ellipsoid(C, d), 3.0 + 0.4 * top)
    assert isinstance(ellipse, Ellipse)
    on = ellipse.get_patch_transform().transform(
        np.stack([np.cos([0, 1, 2, 4]), np.sin([0, 1, 2, 4])], axis=1)
    )
    points = np.column_stack([on, np.full(4, 3.0 + 0.4 * top)])
    np.testing.assert_allclose(np.linalg.norm(np.linalg.solve(C, (points - d).T), axis=0), 1)
    assert freespace.ellipse_of(Ellipsoid(C, d), 3.0 + 1.01 * top) is None


def test_figures_and_table(small):
    scenario, space = small
    figure = freespace.slices(scenario, space)
    assert [axes.get_title(loc="left") for axes in figure.axes][::2] == ["z = 1.00 m", "z = 3.00 m"]
    assert "shortest polyline" in freespace.view(scenario, space)._suptitle.get_text()
    frame = freespace.region_table(space)
    assert len(frame) == len(space.d)
    assert sorted(int(place) for place in frame["route"] if place) == [
        *range(1, len(space.route) + 1)
    ]
    np.testing.assert_allclose(frame[["polytope", "ellipsoid"]], space.volumes)


def test_a_long_title_stays_within_its_figure(small):
    """As that of a space which does not connect start and goal, of a scenario with a long name."""
    scenario, space = small
    scenario = scenario.model_copy(update={"name": "a crane that has a long name " * 5})
    reason = f"no collision-free route found: {'start and goal stay in separate parts ' * 5}"
    apart = replace(space, route=space.route[:0], reason=reason)
    figure = freespace.view(scenario, apart)
    extent = figure._suptitle.get_window_extent(figure.canvas.get_renderer())
    assert extent.x1 < figure.bbox.x1


@pytest.mark.fast
def test_a_free_space_is_one_line_for_people(small):
    _, space = small
    assert repr(space).startswith(f"<FreeSpace: {len(space.d)} regions cover ")
    assert repr(space).endswith(f" %, route of {space.length:.4g} m>")
