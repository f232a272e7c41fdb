"""COCO's functions: their least values are where they say, and known values come out."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from jaxsusp.errors import InputError
from jaxsusp.studies.bbob import draws, suite, transformations
from jaxsusp.studies.bbob.instances import instance, stacked
from jaxsusp.studies.bbob.suite import FUNCTIONS, Landscape, landscape

DIM, POINTS = 5, 8
NUMBERS = range(1, len(FUNCTIONS) + 1)

KNOWN = {
    1: (92.30397568000001, 169.37077568),
    2: (3674431.69134575, 4075655.4291125727),
    3: (-335.00311431916236, -119.29405194377148),
    4: (-343.8990342967856, 118.21445346388492),
    5: (98.60985161055396, 127.64177755150868),
    6: (55101.90109825283, 509536.93398220977),
    7: (106.05513987471636, 1433.2292608987304),
    8: (1476.207257345201, 243512.38654415478),
    9: (149.82999999999998, 50586.34032163513),
    10: (6036865.921981279, 23597201.802096713),
    11: (5445766.046437906, 3872210.9426174765),
    12: (32757629.628032066, 28963082.308079798),
    13: (1078.0864654237093, 1669.9126153785458),
    14: (11.306788139507752, -41.48263749049018),
    15: (1383.329773849239, 6008.835844640225),
    16: (191.91748548972296, 149.62181679741119),
    17: (9.747141552149841, 4.19146551374876),
    18: (77.76123986175664, 97.67415417752652),
    19: (-102.29962625728024, -84.18614069193393),
    20: (6046.154472764689, 34927.56913884383),
    21: (75.32477295756946, 106.9062571432062),
    22: (-919.4283013301417, -929.2852716866705),
    23: (13.586939244582254, 27.85740256040034),
    24: (171.46484536493915, 10292.369717429361),
}
"""f(0) and f(2, -1, 3, -6, 0.5) of instance 1, by coco-experiment 2.8.2."""


@pytest.fixture(scope="module")
def value():
    return jax.jit(Landscape.population)


@pytest.mark.parametrize("number", NUMBERS)
def test_known_values_come_out(value, number):
    x = jnp.array([[0.0] * DIM, [2.0, -1.0, 3.0, -6.0, 0.5]] * (POINTS // 2))
    found = value(landscape(number, DIM, 1), x)[:2]
    np.testing.assert_allclose(found, KNOWN[number], rtol=1e-9)


@pytest.mark.parametrize("number", NUMBERS)
def test_the_least_value_is_at_the_optimum(value, number):
    fitness = landscape(number, DIM, 3)
    near = np.random.default_rng(number).normal(0, 0.05, (POINTS, DIM))
    near[0] = 0
    found = value(fitness, jnp.asarray(np.clip(fitness.at.optimum + near, -5, 5)))
    np.testing.assert_allclose(found[0], fitness.at.offset, rtol=0, atol=2e-10)
    assert (found[1:] > found[0]).sum() >= (2 if number == 5 else POINTS - 1)  # clipped to f5's


def test_instances_in_a_batch_are_the_single_ones_and_only_one_function_is_computed(monkeypatch):
    """Mapped over instances, the number stays a choice of one branch."""
    monkeypatch.setattr(suite, "FUNCTIONS", FUNCTIONS[:3])  # others compile as well, and longer
    x = jnp.asarray(np.random.default_rng(0).uniform(-6, 6, (2, 7, DIM)))
    drawn, number = [instance(3, DIM, each) for each in (1, 2)], jnp.asarray(3, jnp.int32)

    def both(number, at, x):
        return jax.vmap(lambda at, x: Landscape(number, at).population(x))(at, x)

    together = jax.jit(both)(number, stacked(drawn), x)
    alone = [jax.jit(FUNCTIONS[2])(x[i, 4], drawn[i]) + drawn[i].offset for i in range(2)]
    np.testing.assert_allclose(together[:, 4], alone, rtol=1e-12)
    program = jax.make_jaxpr(both)(number, stacked(drawn), x)
    branches = [len(each.params["branches"]) for each in program.eqns if "branches" in each.params]
    assert branches == [3]


def test_coco_draws_are_the_same_everywhere():
    assert draws.uniform(1, 1)[0] == pytest.approx(0.41599935685098144, rel=1e-15)
    assert draws.offset(1 + 10_000) == 79.48  # of f1, instance 1
    Q = draws.rotation(DIM, 7)
    np.testing.assert_allclose(Q @ Q.T, np.eye(DIM), atol=1e-14)
    assert (np.abs(draws.optimum(200, 5)) <= 4).all()
    assert 0 not in draws.optimum(200, 5)


def test_transformations_keep_what_they_are_to_keep():
    z, point = np.linspace(-4, 4, 201), np.array([4.0, -4.0, 4.0])

    @jax.jit
    def all_of_them(z, point):
        skewed, stretched = (
            transformations.skewed(point, 0.5),
            transformations.stretched(point, 100.0),
        )
        return (
            transformations.oscillated(z),
            skewed,
            stretched,
            transformations.penalty(1.5 * z[:3]),
        )

    bumpy, skewed, stretched, penalty = map(np.asarray, all_of_them(z, point))
    assert (np.diff(bumpy) > 0).all()  # monotone
    np.testing.assert_allclose(bumpy[[75, 100, 125]], [-1.0, 0.0, 1.0], atol=1e-12)
    assert np.abs(bumpy - z).max() > 0.05
    np.testing.assert_allclose(skewed, [4.0, -4.0, 16.0])
    np.testing.assert_allclose(stretched, [4.0, -4 * 10**0.5, 40.0])
    assert penalty == pytest.approx(1.0 + 0.94**2 + 0.88**2)


@pytest.mark.fast
@pytest.mark.parametrize(("wrong", "named"), [((25, 5, 1), "function"), ((1, 1, 1), "dimension")])
def test_what_there_is_not_is_refused(wrong, named):
    with pytest.raises(InputError, match=f"{named} = {wrong[0] if named == 'function' else 1}"):
        landscape(*wrong)
