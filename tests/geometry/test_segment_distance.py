"""Distance of two segments against a convex minimisation that we did not write."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp
from scipy.optimize import lsq_linear

from jaxsusp.geometry.segments import segment_distance
from jaxsusp.vec3 import Vec3

POINT = hnp.arrays(np.float64, 3, elements=st.integers(-4, 4).map(float))


def distance(*points) -> float:
    return float(
        segment_distance(*(Vec3.from_array(np.atleast_2d(np.asarray(p, float))) for p in points))[0]
    )


@given(POINT, POINT, POINT, POINT)
@settings(max_examples=150, deadline=None)
def test_it_is_the_least_distance(a, b, c, d):
    """Min over s, t in [0, 1] of |a + s(b - a) - c - t(d - c)|, parallel and point segments too."""
    matrix, target = np.column_stack([b - a, c - d]), c - a
    best = lsq_linear(matrix, target, bounds=(0, 1), method="bvls", tol=1e-14)
    assert abs(distance(a, b, c, d) - np.sqrt(2 * best.cost)) < 1e-6


@pytest.mark.fast
def test_it_is_symmetric_and_exact_where_it_is_known():
    assert distance([0, 0, 0], [2, 0, 0], [1, -1, 3], [1, 1, 3]) == 3
    assert distance([0, 0, 0], [2, 0, 0], [5, 4, 0], [5, 9, 0]) == 5
    assert distance([0, 0, 0], [1, 0, 0], [3, 0, 0], [2, 0, 0]) == 1
    assert distance([0, 0, 0], [0, 0, 0], [0, 3, 4], [0, 3, 4]) == 5
