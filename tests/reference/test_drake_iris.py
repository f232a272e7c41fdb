"""Regions between random boxes against Drake's `Iris`: same seeds, same options."""

import pytest

from benchmarks.drake import compare


@pytest.mark.parametrize("count", [10, 40, 100])
@pytest.mark.parametrize("seed", [1, 2])
def test_ellipsoids_have_the_volumes_of_drakes(count, seed):
    for pair in compare(count, 12, seed):
        assert pair.ours == pytest.approx(pair.drakes, rel=1e-3)
