"""Starts lie on the ways of the free space, and say how far about them to look."""

import numpy as np
import pytest

import jaxsusp as js
from jaxsusp.freespace.polylines import corners
from jaxsusp.problem.starts import GATHERED, LEVEL, ROUTES, starts_of


@pytest.mark.parametrize("waypoints", [1, 2, 5, 8])
def test_starts_lie_on_the_ways(scenarios, waypoints):
    space = js.free_space(scenarios[4])
    x, spread = starts_of(space, waypoints)
    assert x.shape == spread.shape == (ROUTES * GATHERED + LEVEL, 3 * waypoints)
    there = np.isfinite(x).all(axis=1)
    routes, level = min(len(space.routes), ROUTES), min(len(space.level), LEVEL)
    assert there.sum() == routes * min(GATHERED, waypoints) + level
    assert np.isnan(x[~there]).all()
    assert (spread[there] > 0).all()
    assert space.contains(x[there].reshape(-1, 3)).all()


def test_gathered_waypoints_are_next_to_the_start(scenarios):
    space = js.free_space(scenarios[0])
    x, spread = starts_of(space, 5)
    routes = min(len(space.routes), ROUTES)
    start = np.array(scenarios[0].task.start)
    for gathered in range(GATHERED):
        row = x[gathered * routes].reshape(-1, 3)
        away = np.linalg.norm(row - start, axis=1)
        assert (away < 0.1).sum() == gathered
        near = spread[gathered * routes].reshape(-1, 3)[:, 0]
        assert (near[:gathered] < 0.1).all()
        shares = corners(np.vstack([start, row, scenarios[0].task.goal]))
        assert (np.diff(shares) > 0).all()


@pytest.mark.fast
def test_a_space_of_an_earlier_version_has_its_polyline():
    from pathlib import Path

    file = Path(__file__).parents[1] / "files" / "scenario-1-0.1.0.free-space.nc"
    x, _ = starts_of(js.load_free_space(file), 5)
    assert np.isfinite(x).all(axis=1).sum() == GATHERED
