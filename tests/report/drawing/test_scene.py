"""Bodies, camera and scene: what hides what, and what the picture holds."""

from types import SimpleNamespace

import numpy as np
import pytest
from matplotlib.colors import to_hex
from scipy.spatial.transform import Rotation
from trimesh.creation import box as box_of

from jaxsusp.report.drawing import scene as scene3d
from jaxsusp.report.drawing.painting import freest, hidden, paint_curve, refine
from jaxsusp.report.drawing.solids import Camera, box, cylinder, of_obstacle, sphere
from jaxsusp.report.drawing.style import PALETTE
from jaxsusp.scenario.models import Mesh, Statement

FROM_SOUTH = Camera(-np.pi / 2, 0.0)
"""Looks north (y up is away): x to the right, z up."""


def stated(**changed) -> Statement:
    """A wall and a ball between start and goal, three robots."""
    ends = [(0, 6, 7), (-5.196, -3, 7), (5.196, -3, 7)]
    bases = [(0, 5, 0), (-4.33, -2.5, 0), (4.33, -2.5, 0)]
    robots = [
        {"base": base, "links": (4, 3, 2), "end": end}
        for base, end in zip(bases, ends, strict=True)
    ]
    wall = {"name": "wall", "kind": "box", "center": (0, 0, 1), "size": (2, 0.4, 2)}
    ball = {"kind": "sphere", "center": (2, 2, 0.5), "radius": 0.5}
    content = {
        "name": "two bodies",
        "payload": {"mass": 10, "radius": 0.1, "height": 0.3},
        "workspace": {"lower": (-3.5, -3.5, 0.2), "upper": (3.5, 3.5, 5.5)},
        "task": {"start": (0, 2, 1), "goal": (0, -2, 3)},
        "robots": robots,
        "obstacles": [wall, ball],
    }
    return Statement.model_validate(content | changed)


@pytest.fixture
def scenario():
    return stated()


@pytest.mark.fast
def test_a_box_is_its_half_spaces():
    body = box((1, 2, 3), (2, 4, 6))
    assert len(body.faces) == 6
    assert sorted(body.offsets) == pytest.approx([0, 0, 0, 2, 4, 6])  # -x <= 0 … z <= 6
    assert (body.corners.min(axis=0), body.corners.max(axis=0)) == (
        pytest.approx([0, 0, 0]),
        pytest.approx([2, 4, 6]),
    )


@pytest.mark.fast
def test_yaw_turns_counter_clockwise():
    body = box((0, 0, 0), (4, 2, 2), yaw_deg=90.0)
    assert body.corners.max(axis=0) == pytest.approx([1, 2, 1])
    slanted = box((0, 0, 0), (2, 0, 1), yaw_deg=30.0)
    far = slanted.corners[slanted.corners[:, 0].argmax()]
    assert far[:2] == pytest.approx([np.sqrt(3) / 2, 0.5], abs=1e-3)


@pytest.mark.parametrize(
    ("body", "volume"),
    [(cylinder((1, 0, 0), 0.5, 2.0), np.pi / 2), (sphere((0, 1, 0), 1.0), 4 * np.pi / 3)],
)
def test_round_bodies_are_close_to_round(body, volume):
    fans = [(face[0], face[i], face[i + 1]) for face in body.faces for i in range(1, len(face) - 1)]
    inside = body.corners.mean(axis=0)
    measured = sum(abs(np.linalg.det(np.array(fan) - inside)) for fan in fans) / 6
    assert measured == pytest.approx(volume, rel=0.02)
    assert (body.corners @ body.normals.T <= body.offsets + 1e-9).all()  # convex


@pytest.mark.fast
def test_a_body_hides_what_is_behind_it():
    body = box((0, 0, 0), (2, 2, 2))
    points = np.array([[0, 2, 0], [0, -2, 0], [1.1, 2, 0], [0, 0.5, 0], [0, 2, 1.1], [0.9, 9, 0.9]])
    assert body.hides(points, FROM_SOUTH.towards).tolist() == [
        *(True, False, False),  # behind, in front, beside
        *(True, False, True),  # inside, above, far behind
    ]


def test_a_round_body_hides_a_round_shadow():
    ball = sphere((0, 0, 0), 1.0)
    angle = np.linspace(0, 2 * np.pi, 9)
    ring = np.stack([np.cos(angle), np.full(9, 3.0), np.sin(angle)], axis=1)
    scale = np.array([1, 0, 1])
    assert ball.hides(ring * np.where(scale, 0.98, 1), FROM_SOUTH.towards).all()
    assert not ball.hides(ring * np.where(scale, 1.02, 1), FROM_SOUTH.towards).any()


@pytest.mark.fast
def test_the_camera_keeps_right_up_and_scale():
    point = np.array([1.0, 2.0, 3.0])
    assert FROM_SOUTH.project(point) == pytest.approx([1, 3])
    assert Camera.above().project(point) == pytest.approx([1, 2])
    assert Camera(0.0, 0.0).project(point) == pytest.approx([2, 3])  # seen from the east
    right, up = Camera(0.4, 0.3).frame
    assert np.cross(right, up) == pytest.approx(Camera(0.4, 0.3).towards)


def test_bodies_are_painted_from_back_to_front():
    tall = box((0, 0, 5), (1, 1, 10))
    # the centre of the long wall is nearer to the viewer than the tower, yet it stands behind it
    wall = box((30, 1, 1), (62, 0.2, 2))
    near = cylinder((0, -2, 1), 0.3, 2.0)
    viewer = Camera(-np.pi / 2 + 0.5, 0.3)
    bodies = [near, tall, wall]
    centres = [body.corners.mean(axis=0) @ viewer.towards for body in bodies]
    assert centres[2] > centres[1]
    order = viewer.back_to_front(bodies)
    assert order.index(2) < order.index(1)
    assert FROM_SOUTH.back_to_front(bodies) == [2, 1, 0]


def test_a_small_body_before_a_large_one_is_painted_after_it():
    wall, pillar = box((0, 0, 2), (8, 0.4, 4)), cylinder((1, 6, 2), 0.2, 4.0)
    small = cylinder((0.3, -1, 1.4), 0.1, 0.3)  # before no corner, edge or face centre of the wall
    for order in ([wall, pillar, small], [small, wall, pillar]):
        painted = [order[i] for i in FROM_SOUTH.back_to_front(order)]
        assert [len(body.faces) for body in painted] == [50, 6, 50]
        assert painted[-1] is small


@pytest.mark.fast
def test_a_turned_cylinder_is_the_upright_one_turned_about_its_centre():
    center, turn = np.array([1.0, 2, 3]), Rotation.from_euler("xy", [20, -40], degrees=True)
    upright, turned = cylinder(center, 0.2, 1.0), cylinder(center, 0.2, 1.0, turn.as_matrix())
    expected = center + turn.apply(upright.corners - center)
    np.testing.assert_allclose(turned.corners, expected, atol=1e-12)
    np.testing.assert_allclose(turned.normals, turn.apply(upright.normals), atol=1e-12)


@pytest.mark.fast
def test_a_label_goes_to_the_first_place_with_room():
    drawn = np.array([[0.0, 1.0], [0.3, 0.0]])
    places = np.array([[0.0, 0.9], [0.0, -1.0], [-3.0, 0.0]])
    assert freest(places, drawn, enough=0.5) == 1
    assert freest(places, drawn, enough=9.0) == 2


def test_bodies_that_run_into_each_other_are_painted_by_depth():
    crossing = [box((0, 0, 0), (4, 1, 1)), box((0, 0.1, 0), (1, 4, 1)), box((0, 9, 0), (1, 1, 1))]
    assert FROM_SOUTH.back_to_front(crossing) == [2, 1, 0]


def test_a_mesh_is_drawn_as_its_bounding_box(tmp_path):
    box_of((1.0, 2.0, 3.0)).export(tmp_path / "hook.stl")
    mesh = Mesh(file=str(tmp_path / "hook.stl"), scale=2.0, center=(0, 0, 3))
    assert of_obstacle(mesh).corners.max(axis=0) == pytest.approx([1, 2, 6])


def test_a_flat_mesh_still_has_two_sides():
    plate = box((0, 0, 1), (1, 1, 0))
    above_and_below = np.array([[0, 0, 0.5], [0, 0, 1.5]])
    assert plate.hides(above_and_below, Camera.above().towards).tolist() == [True, False]


def test_an_unknown_obstacle_is_an_error():
    with pytest.raises(ValueError, match="'cloud'"):
        of_obstacle(SimpleNamespace(kind="cloud"))


def test_refine_keeps_the_curve():
    fine = refine(np.array([[0, 0, 0], [1.0, 0, 2], [1, 3, 2]]), parts=2)
    assert fine.tolist() == [[0, 0, 0], [0.5, 0, 1], [1, 0, 2], [1, 1.5, 2], [1, 3, 2]]


def test_a_curve_is_pale_where_it_is_hidden():
    body = box((0, 0, 0), (2, 2, 2))
    axes = scene3d.picture(4.0, 4.0).subplots()
    passing = np.array([[-2.0, 2, 0], [2, 2, 0]])
    paint_curve(axes, FROM_SOUTH, [body], refine(passing, 20), 3.0, color="k", linewidth=2)
    before, behind, after = axes.get_lines()
    assert (before.get_linewidth(), behind.get_linewidth(), after.get_linewidth()) == (2, 1.1, 2)
    assert behind.get_alpha() == 0.4
    assert behind.get_xdata().min() == pytest.approx(-1, abs=0.05)
    assert behind.get_xdata().max() == pytest.approx(1, abs=0.05)


def test_the_best_view_sees_a_curve_behind_a_wall():
    wall = [box((0, 0, 2), (8, 0.2, 4))]
    behind = np.array([[-1.0, 1, 1], [1, 1, 1]])
    camera = scene3d.best_view(wall, [behind])
    assert not hidden(refine(behind), wall, camera).any()
    assert camera.towards[1] > 0.5  # from the north


def test_scene_shows_every_trajectory_in_both_pictures(scenario, comparison):
    cell = comparison.isel(scenario=0)
    view, top = scene3d.scene(scenario, cell).axes
    for axes in (view, top):
        drawn = {to_hex(line.get_color()).upper() for line in axes.get_lines()}
        assert {PALETTE[name] for name in ("pso", "ga", "dbo", "sdbo")} <= drawn
    orange = [line for line in top.get_lines() if to_hex(line.get_color()).upper() == PALETTE["ga"]]
    xy = np.concatenate([line.get_xydata() for line in orange])
    expected = refine(cell["position"].sel(algorithm="ga").values)[:, :2]
    assert {tuple(p) for p in xy.round(9)} == {tuple(p) for p in expected.round(9)}


def test_scene_names_what_it_shows(scenario, comparison):
    figure = scene3d.scene(scenario, comparison.isel(scenario=0))
    (legend,) = figure.legends
    assert [text.get_text() for text in legend.get_texts()] == [
        *("cables at start", "cables at goal", "PSO  400.0", "GA  300.0"),
        *("DBO  200.0  (violates limits)", "SDBO  100.0"),
    ]
    view, top = figure.axes
    words = [text.get_text() for text in view.texts]
    assert {"start", "goal", "P₁", "P₂", "P₃", "x (m)", "1 wall   2 sphere"} <= set(words)
    assert {"1", "2", "start", "goal"} <= {text.get_text() for text in top.texts}
    assert "two bodies" in figure.get_suptitle()


def test_the_top_view_is_the_workspace_to_scale(scenario):
    _, top = scene3d.scene(scenario).axes
    assert (top.get_xlim(), top.get_ylim()) == ((-3.5, 3.5), (-3.5, 3.5))
    assert top.get_aspect() == 1


def test_scales_suit_the_size_of_the_workspace():
    scenario = stated(workspace={"lower": (-3.5, -3.5, 0.2), "upper": (36.5, 36.5, 15.5)})
    view, _ = scene3d.scene(scenario).axes
    numbers = {float(t.get_text()) for t in view.texts[:40] if t.get_text().lstrip("-").isdigit()}
    assert {0, 10, 20, 30} <= numbers
    assert 7 not in numbers


def test_cables_run_from_every_attachment_to_its_end():
    payload = {"mass": 10, "radius": 0.1, "height": 0.3}
    payload["attachments"] = [(0.1, 0, 0.15), (-0.1, 0, 0.15), (0, 0.1, 0.15)]
    scenario = stated(payload=payload, obstacles=[])
    _, top = scene3d.scene(scenario).axes
    cables = [line for line in top.get_lines() if line.get_linewidth() == 1.0]
    tips = [line.get_xydata()[[0, -1]] for line in cables]
    assert len(tips) == 6
    assert tips[0] == pytest.approx(np.array([[0.1, 2], [0, 6]]))
    assert tips[5] == pytest.approx(np.array([[0, -1.9], [5.196, -3]]))


def test_arms_are_drawn_when_asked_for(scenario):
    def joints(arms):
        view, _ = scene3d.scene(scenario, arms=arms).axes
        return [line for line in view.get_lines() if len(line.get_xdata()) == 4]

    assert joints(arms=False) == []
    assert len(joints(arms=True)) == 3


def test_an_algorithm_without_a_trajectory_is_left_out(scenario, comparison):
    comparison["position"][0, 1] = np.nan
    (legend,) = scene3d.scene(scenario, comparison.isel(scenario=0)).legends
    assert not any(text.get_text().startswith("GA") for text in legend.get_texts())


def test_a_scene_is_saved_as_png(scenario, comparison, tmp_path):
    scene3d.save(scene3d.scene(scenario, comparison.isel(scenario=0)), tmp_path / "scene.png")
    assert (tmp_path / "scene.png").read_bytes().startswith(b"\x89PNG")


def test_for_print_curves_carry_markers_and_obstacles_only_their_numbers(scenario, comparison):
    figure = scene3d.scene(scenario, comparison.isel(scenario=0), width=7.09)
    for axes in figure.axes:
        assert {"o", "s", "^", "D"} <= {line.get_marker() for line in axes.get_lines()}
    told = " ".join(text.get_text() for text in figure.axes[0].texts)
    names = scene3d.obstacle_names(scenario)
    assert names[0].startswith("1 ")
    assert names[0] not in told
    assert names[0] in " ".join(t.get_text() for t in scene3d.scene(scenario).axes[0].texts)
