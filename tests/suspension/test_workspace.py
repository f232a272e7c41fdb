"""The workspace map against single positions, closed forms and its command."""

import json

import jax
import jax.numpy as jnp
import numpy as np
import pytest

import jaxsusp as js
from jaxsusp.geometry.collisions import count_collisions
from jaxsusp.report.workspace import slices, volume_table
from jaxsusp.scenario.world import build_world
from jaxsusp.vec3 import Vec3


@pytest.fixture(scope="module")
def space() -> js.Workspace:
    return js.workspace(js.load_scenario("scenario-5"), 0.35)


def test_cells_fill_the_box(space):
    assert space.clear.shape == (20, 20, 15)
    assert space.volume(np.ones_like(space.clear)) == pytest.approx(7 * 7 * 5.3)
    for axis, low, high in zip(space.axes, (-3.5, -3.5, 0.2), (3.5, 3.5, 5.5), strict=True):
        pitch = (high - low) / len(axis)
        np.testing.assert_allclose(axis, low + pitch * (np.arange(len(axis)) + 0.5))


def test_every_cell_is_what_its_centre_is(space):
    rng = np.random.default_rng(0)
    world = build_world(space.scenario)
    cells = tuple(rng.integers(0, space.clear.shape, (200, 3)).T)
    places = np.stack([axis[n] for axis, n in zip(space.axes, cells, strict=True)], axis=-1)
    tensions = np.asarray(js.tensions(space.scenario, places))
    np.testing.assert_allclose(space.tensions[cells], tensions, rtol=1e-9, atol=1e-9)
    admissible = ((tensions >= 1) & (tensions <= 100)).all(axis=-1)
    np.testing.assert_array_equal(space.admissible[cells], admissible)
    count = jax.jit(count_collisions)
    for place, clear in zip(places[:40], space.clear[cells], strict=False):
        still = Vec3(*(jnp.asarray([c, c]) for c in place))
        assert clear == (int(count(still, world.bodies, world.obstacles)) == 0)
    assert 0 < space.volume(space.usable) < space.volume(space.admissible)


def test_without_upper_limit_it_is_the_prism_below_the_triangle_of_the_ends():
    """Level ends hold whatever hangs below their triangle: area 27·√3 m², cut by the box."""
    scenario = js.load_scenario("scenario-1")
    strong = scenario.limits.model_copy(update={"tension": (0.0, 1e6)})
    box = scenario.workspace.model_copy(
        update={"lower": (-6.0, -4.0, 0.2), "upper": (6.0, 7.0, 5.2)}
    )
    scenario = scenario.model_copy(update={"limits": strong, "workspace": box, "obstacles": ()})
    space = js.workspace(scenario, 0.1)
    expected = 27 * np.sqrt(3) * 5.0
    assert space.volume(space.admissible) == pytest.approx(expected, rel=0.01)
    assert space.clear.all()


def test_a_rim_holds_the_load_only_where_it_turns_little():
    scenario = js.load_scenario("rim")
    space = js.workspace(scenario, 0.7)
    points = np.stack(np.meshgrid(*space.axes, indexing="ij"), axis=-1)[space.admissible]
    found = js.equilibrium(scenario, np.resize(points, (1024, 3)))  # as many as the map's batches
    assert 0 < len(points) < space.clear.size / 2
    assert np.rad2deg(found.turn).max() <= 10
    assert found.stable.all()


def test_more_robots_hold_more():
    four = js.load_scenario("four-robots")
    three = four.model_copy(update={"robots": four.robots[:3]})
    volumes = [
        space.volume(space.admissible) for space in map(js.workspace, (three, four), (0.35, 0.35))
    ]
    assert volumes[1] > 1.2 * volumes[0]


def test_the_picture_has_six_slices_and_the_table_the_volumes(space):
    figure = slices(space)
    assert len(figure.axes) == 7  # and the colour bar
    titles = [axes.get_title(loc="left") for axes in figure.axes[:6]]
    assert [title[0] for title in titles] == ["z"] * 3 + ["x"] * 3
    table = volume_table(space).set_index("set")
    assert table.loc["both", "volume"] == space.volume(space.usable)
    assert table.loc["workspace box", "share"] == 1


def test_the_command_writes_picture_and_table(tmp_path, monkeypatch, capsys):
    from jaxsusp.cli.main import main
    from jaxsusp.optim import devices

    monkeypatch.setattr(devices, "configure", lambda **_: None)  # JAX has started already
    arguments = ["jaxsusp", "workspace", "four-robots", "--spacing", "0.35", "--json"]
    monkeypatch.setattr("sys.argv", [*arguments, "--output", str(tmp_path)])
    with pytest.raises(SystemExit) as ended:
        main()
    said = capsys.readouterr()
    assert ended.value.code == 0
    answer = json.loads(said.out)
    assert answer["cells"] == [20, 20, 15]
    assert 0 < answer["volumes"]["both"] < answer["volumes"]["admissible tensions"]
    assert sorted(path.name for path in tmp_path.iterdir()) == ["workspace.csv", "workspace.png"]


@pytest.mark.fast
def test_bad_requests_are_refused():
    scenario = js.load_scenario("scenario-1")
    for spacing in (0.0, -1.0, float("nan")):
        with pytest.raises(js.InputError, match="give a length above 0 m"):
            js.workspace(scenario, spacing)
    with pytest.raises(js.InputError, match=r"too many cells; give 0\.037 or more"):
        js.workspace(scenario, 0.001)
    rim = js.load_scenario("rim")
    steps = [(*at[:2], 0.1 + 0.01 * k) for k, at in enumerate(rim.payload.attachments)]
    uneven = rim.payload.model_copy(update={"attachments": tuple(steps)})
    with pytest.raises(js.InputError, match="give all of them one height"):
        js.workspace(rim.model_copy(update={"drive": "base", "payload": uneven}))
