"""What the figures show, read back from their artists."""

from itertools import combinations

import matplotlib
import matplotlib.image
import numpy as np
import pytest
from matplotlib.colors import to_rgb

from jaxsusp.report.comparison import figures
from jaxsusp.report.drawing.style import CYCLE, styles


def lines(axes):
    return {line.get_label(): line for line in axes.get_lines()}


def test_convergence_has_a_panel_per_scenario_and_a_line_per_algorithm(comparison):
    figure = figures.convergence(comparison)
    assert [axes.get_title("left") for axes in figure.axes] == ["scenario-1", "scenario-5"]
    assert [axes.get_title("right") for axes in figure.axes] == ["6 obstacles", "10 obstacles"]
    for axes in figure.axes:
        assert list(lines(axes)) == ["PSO", "GA", "DBO", "SDBO"]
        assert axes.get_yscale() == "log"
    (legend,) = figure.legends
    assert [text.get_text() for text in legend.get_texts()] == ["PSO", "GA", "DBO", "SDBO"]


def test_titles_tell_how_many_runs_there_are_where_algorithms_differ(comparison):
    comparison["obstacles"][0] = 1
    whole = figures.convergence(comparison)
    assert whole._suptitle.get_text() == "Convergence: median and quartiles of 4 runs"
    assert whole.axes[0].get_title("right") == "1 obstacle"
    comparison["fitness"][:, 1, 3:] = np.nan
    comparison["fitness"][:, 2] = np.nan  # of another comparison
    for draw in (figures.convergence, figures.fitness_boxes):
        assert "of 3 to 4 runs" in draw(comparison)._suptitle.get_text()


def test_convergence_draws_the_median_over_evaluations(comparison):
    axes = figures.convergence(comparison).axes[0]
    pso, sdbo = lines(axes)["PSO"], lines(axes)["SDBO"]
    # runs 400 800 1200 2400: median 1000, halved in every iteration
    assert pso.get_ydata().tolist() == [16_000, 8_000, 4_000, 2_000, 1_000]
    assert pso.get_xdata().tolist() == [30, 60, 90, 120, 150]
    # sdbo ran three iterations and spent 300 evaluations in them
    assert sdbo.get_xdata().tolist() == [100, 200, 300]
    assert sdbo.get_ydata()[-1] == 250


def test_convergence_bands_are_quartiles(comparison):
    axes = figures.convergence(comparison).axes[0]
    band = axes.collections[0].get_paths()[0].vertices
    at_the_end = band[band[:, 0] == 150][:, 1]
    # 400 800 1200 2400: quartiles 700 and 1500
    assert (at_the_end.min(), at_the_end.max()) == (700, 1500)


def test_convergence_survives_infinite_beginnings_and_missing_runs(comparison):
    comparison["history"][0, 0, :, 0] = np.inf
    comparison["history"][0, 1, 2:] = np.nan
    axes = figures.convergence(comparison).axes[0]
    assert np.isnan(lines(axes)["PSO"].get_ydata()[0])
    assert lines(axes)["GA"].get_ydata()[-1] == 450  # of 600 and 300


def test_only_panels_without_one_below_carry_the_x_label(comparison):
    four = comparison.isel(scenario=[0, 1, 0, 1]).assign_coords(scenario=list("abcd"))
    labels = [axes.get_xlabel() != "" for axes in figures.convergence(four).axes]
    assert labels == [False, True, True, True]


@pytest.mark.fast
def test_quartiles_know_infinity():
    assert figures.quartiles(np.array([1.0, 2.0, 3.0, 4.0])).tolist() == [1.75, 2.5, 3.25]
    assert figures.quartiles(np.array([1.0, 1.0, np.inf, np.inf])).tolist() == [1, np.inf, np.inf]
    assert figures.quartiles(np.array([5.0, np.nan])).tolist() == [5, 5, 5]


def test_boxes_show_every_run_and_which_are_clear(comparison):
    axes = figures.fitness_boxes(comparison).axes[0]
    assert [label.get_text() for label in axes.get_xticklabels()] == ["PSO", "GA", "DBO", "SDBO"]
    filled, hollow = axes.collections[0:2]  # pso: three clear runs, one with collisions
    assert sorted(filled.get_offsets()[:, 1]) == [400, 800, 1200]
    assert hollow.get_offsets()[:, 1].tolist() == [2400]
    assert to_rgb(filled.get_facecolor()[0]) == to_rgb(figures.PALETTE["pso"])
    assert to_rgb(hollow.get_facecolor()[0]) == (1, 1, 1)
    points = sum(len(c.get_offsets()) for c in axes.collections)
    assert points == 16


def test_boxes_span_the_quartiles(comparison):
    axes = figures.fitness_boxes(comparison).axes[0]
    heights = axes.patches[0].get_path().vertices[:, 1]
    assert (heights.min(), heights.max()) == (700, 1500)


def test_infinite_runs_are_counted_and_not_drawn(comparison):
    comparison["fitness"][0, 0, :3] = np.inf
    comparison["fitness"][0, 1] = np.inf
    axes = figures.fitness_boxes(comparison).axes[0]
    assert [text.get_text() for text in axes.texts] == ["3 × ∞", "4 × ∞"]
    assert sum(len(c.get_offsets()) for c in axes.collections) == 9


@pytest.mark.fast
def test_colours_belong_to_the_algorithm():
    alone, all_of_them = styles(["sdbo"]), styles(["pso", "mine", "sdbo-task", "sdbo", "yours"])
    assert alone["sdbo"] == all_of_them["sdbo"]
    assert all_of_them["mine"].color == CYCLE[0]
    assert all_of_them["yours"].color == CYCLE[1]
    assert all_of_them["sdbo-task"].label == "SDBO-task"
    assert all_of_them["mine"].label == "mine"
    assert (alone["sdbo"].dash, all_of_them["sdbo-task"].dash) == ("-", "--")


# Machado, Oliveira and Fernandes 2009: what remains of linear RGB without one kind of cone.
DICHROMACY = {
    "deuteranopia": [
        [0.367322, 0.860646, -0.227968],
        [0.280085, 0.672501, 0.047413],
        [-0.011820, 0.042940, 0.968881],
    ],
    "protanopia": [
        [0.152286, 1.052583, -0.204868],
        [0.114503, 0.786281, 0.099216],
        [-0.003882, -0.048116, 1.051998],
    ],
    "tritanopia": [
        [1.255528, -0.076749, -0.178779],
        [-0.078411, 0.930809, 0.147602],
        [0.004733, 0.691367, 0.303900],
    ],
}


def lab(linear):
    """CIE L*a*b* of linear sRGB."""
    to_xyz = [[0.4124, 0.3576, 0.1805], [0.2126, 0.7152, 0.0722], [0.0193, 0.1192, 0.9505]]
    xyz = np.array(to_xyz) @ np.clip(linear, 0, 1) / [0.95047, 1, 1.08883]
    x, y, z = np.where(xyz > 0.008856, np.cbrt(xyz), 7.787 * xyz + 16 / 116)
    return np.array([116 * y - 16, 500 * (x - y), 200 * (y - z)])


@pytest.mark.fast
@pytest.mark.parametrize("vision", DICHROMACY)
def test_the_palette_is_distinct_for_every_kind_of_colour_vision(vision):
    seen = {}
    for name, color in figures.PALETTE.items():
        rgb = np.array(to_rgb(color))
        linear = np.where(rgb <= 0.04045, rgb / 12.92, ((rgb + 0.055) / 1.055) ** 2.4)
        seen[name] = lab(np.array(DICHROMACY[vision]) @ linear)
    closest = min(np.linalg.norm(seen[a] - seen[b]) for a, b in combinations(seen, 2))
    assert closest > 15


def test_saving_is_repeatable_and_leaves_the_global_state_alone(comparison, tmp_path):
    before = dict(matplotlib.rcParams)
    for name in ("a.png", "b.png"):
        figures.save(figures.fitness_boxes(comparison.isel(scenario=[0])), tmp_path / name)
    assert (tmp_path / "a.png").read_bytes() == (tmp_path / "b.png").read_bytes()
    assert matplotlib.image.imread(tmp_path / "a.png").shape[1] == 2400
    assert dict(matplotlib.rcParams) == before


def test_a_figure_that_cannot_be_drawn_leaves_the_old_file(comparison, tmp_path):
    target = tmp_path / "figure.png"
    target.write_bytes(b"old")
    figure = figures.convergence(comparison)
    figure.axes[0].set_title("$broken_{mathtext$")
    with pytest.raises(ValueError, match="broken"):
        figures.save(figure, target)
    assert target.read_bytes() == b"old"
    assert list(tmp_path.iterdir()) == [target]


def test_figures_show_themselves_in_notebooks(comparison):
    png = figures.convergence(comparison.isel(scenario=[0]))._repr_png_()
    assert png.startswith(b"\x89PNG")
