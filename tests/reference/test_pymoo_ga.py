"""The genetic algorithm against pymoo's `GA` with its default operators.

Once as a whole, by what it finds, and once operator by operator, by how offspring are distributed.
"""

import jax
import jax.numpy as jnp
import numpy as np
import pymoo.core.problem
import pytest
from equivalence import DIM, FUNCTIONS, POPULATION, Function, compare, our_fitness, problem_of
from pymoo.algorithms.soo.nonconvex.ga import GA, comp_by_cv_and_fitness
from pymoo.core.population import Population
from pymoo.operators.crossover.sbx import SBX
from pymoo.operators.mutation.pm import PM
from pymoo.operators.selection.tournament import TournamentSelection
from pymoo.optimize import minimize
from scipy.stats import chi2_contingency, ks_2samp

import jaxsusp as js
from jaxsusp.optim.algorithms.ga import GaCoefficients, crossover, mutate, tournament

GENERATIONS = 200
THEIR_RUNS = 60
OFFSPRING = 20_000
LEAST_P = 1e-3  # of every test of distributions; seeds are fixed, so a pass stays a pass


class Peer(pymoo.core.problem.Problem):
    """One of the functions as pymoo wants it."""

    def __init__(self, function: Function):
        super().__init__(n_var=DIM, n_obj=1, xl=-function.bound, xu=function.bound)
        self.function = function

    def _evaluate(self, x, out, *args, **kwargs):
        out["F"] = self.function.value(x, np)


def found_by_pymoo(function: Function) -> np.ndarray:
    """Final fitness of its runs; the initial population is its generation 1."""
    algorithm = GA(pop_size=POPULATION, eliminate_duplicates=False)
    generations = ("n_gen", GENERATIONS + 1)
    runs = (minimize(Peer(function), algorithm, generations, seed=s) for s in range(THEIR_RUNS))
    return np.array([run.F[0] for run in runs])


@pytest.fixture(scope="module")
def pymoo_runs() -> dict[str, np.ndarray]:
    return {name: found_by_pymoo(function) for name, function in FUNCTIONS.items()}


@pytest.mark.parametrize("name", FUNCTIONS)
def test_finds_what_pymoo_finds(name, pymoo_runs):
    outcome = compare(our_fitness(FUNCTIONS[name], js.ga(), GENERATIONS), pymoo_runs[name])
    print(f"\nGA, {name}: {outcome}")
    assert outcome.holds, str(outcome)


@pytest.mark.parametrize("wrong", [{"mutation_index": 5.0}, {"crossover_probability": 0.3}])
def test_the_statistic_tells_another_ga_apart(wrong, pymoo_runs):
    outcome = compare(
        our_fitness(FUNCTIONS["sphere"], js.ga(**wrong), GENERATIONS), pymoo_runs["sphere"]
    )
    print(f"\nGA with {wrong}, sphere: {outcome}")
    assert not outcome.holds, str(outcome)


# The operators, on parents that cover the range: near and at the bounds, close together, equal.

SPHERE = FUNCTIONS["sphere"]
MOTHER = np.array([-5.12, -5.0, -2.0, 0.0, 1.0, 2.0, 3.0, 4.9, 5.12, -5.12])
FATHER = np.array([-5.0, 5.0, -1.99, 0.1, 1.0, -4.0, 3.7, 5.12, -1.0, 5.12])


def repeated(row: np.ndarray) -> jax.Array:
    return jnp.tile(jnp.asarray(row), (OFFSPRING, 1))


def assert_same_offspring(ours: np.ndarray, theirs: np.ndarray, parent: np.ndarray) -> None:
    """Equal distributions of every variable, changed or not, and of how many were not changed."""
    changed = [
        [x[x != old] for x, old in zip(each.T, parent, strict=True)] for each in (ours, theirs)
    ]
    pairs = [*zip(ours.T, theirs.T, strict=True), *zip(*changed, strict=True)]
    p = [ks_2samp(*pair).pvalue for pair in pairs if min(map(len, pair)) > 0]
    kept = [np.bincount((x == parent).sum(axis=1), minlength=DIM + 1) for x in (ours, theirs)]
    table = np.array(kept)
    p.append(chi2_contingency(table[:, table.sum(axis=0) > 0]).pvalue)
    print(f"\nsmallest of {len(p)} p-values: {min(p):.1e}")
    assert min(p) > LEAST_P, p


def our_children(coefficients: GaCoefficients) -> np.ndarray:
    mothers, fathers = repeated(MOTHER), repeated(FATHER)
    both = crossover(jax.random.key(1), mothers, fathers, problem_of(SPHERE), coefficients)
    return np.asarray(problem_of(SPHERE).repair(both))


def their_children() -> np.ndarray:
    population = Population.new("X", np.array([MOTHER, FATHER]))
    parents = np.tile([0, 1], (OFFSPRING, 1))
    rng = np.random.default_rng(1)
    return SBX().do(Peer(SPHERE), population, parents, random_state=rng).get("X")


def our_mutants(coefficients: GaCoefficients) -> np.ndarray:
    mutants = mutate(jax.random.key(2), repeated(MOTHER), problem_of(SPHERE), coefficients)
    return np.asarray(problem_of(SPHERE).repair(mutants))


def their_mutants() -> np.ndarray:
    population = Population.new("X", np.tile(MOTHER, (OFFSPRING, 1)))
    return PM().do(Peer(SPHERE), population, random_state=np.random.default_rng(2)).get("X")


def test_crossover_is_pymoos():
    ours, theirs = our_children(GaCoefficients()), their_children()
    for first, second in (
        (ours[:OFFSPRING], theirs[:OFFSPRING]),
        (ours[OFFSPRING:], theirs[OFFSPRING:]),
    ):
        assert_same_offspring(first, second, MOTHER)
    spans = [np.abs(x[:OFFSPRING] - x[OFFSPRING:]) for x in (ours, theirs)]
    assert_same_offspring(*spans, np.abs(MOTHER - FATHER))


def test_mutation_is_pymoos():
    assert_same_offspring(our_mutants(GaCoefficients()), their_mutants(), MOTHER)


@pytest.mark.parametrize(
    "wrong",
    [
        {"crossover_index": 13.0},
        {"crossover_probability": 0.88},
        {"crossover_per_variable": 0.48},
    ],
)
def test_another_crossover_is_told_apart(wrong):
    ours, theirs = our_children(GaCoefficients(**wrong)), their_children()
    with pytest.raises(AssertionError):
        assert_same_offspring(ours[:OFFSPRING], theirs[:OFFSPRING], MOTHER)


@pytest.mark.parametrize("wrong", [{"mutation_index": 17.0}, {"mutation_probability": 1.0}])
def test_another_mutation_is_told_apart(wrong):
    with pytest.raises(AssertionError):
        assert_same_offspring(our_mutants(GaCoefficients(**wrong)), their_mutants(), MOTHER)


def test_tournament_is_pymoos():
    """How often the member of each rank wins in one generation, over many generations."""
    repeats, fitness = 3000, np.random.default_rng(3).permutation(1.0 * np.arange(POPULATION))
    keys = jax.random.split(jax.random.key(3), repeats)
    draw = jax.jit(jax.vmap(lambda key: tournament(key, jnp.asarray(fitness), POPULATION)))
    population = Population.new("F", fitness[:, None])
    selection = TournamentSelection(func_comp=comp_by_cv_and_fitness)
    rng = np.random.default_rng(3)
    theirs = [
        selection.do(
            Peer(SPHERE), population, POPULATION // 2, 2, to_pop=False, random_state=rng
        ).ravel()
        for _ in range(repeats)
    ]
    ours, theirs = (wins_by_rank(np.asarray(winners), fitness) for winners in (draw(keys), theirs))
    table = np.array([ours, theirs])
    p = chi2_contingency(table[:, table.sum(axis=0) > 0]).pvalue
    print(f"\np = {p:.3f}")
    assert p > LEAST_P
    assert table[0, -1] == table[1, -1] == repeats, "the best member wins both its tournaments"


def wins_by_rank(winners: np.ndarray, fitness: np.ndarray) -> np.ndarray:
    """Number of generations in which a member won 0, 1 or 2 times, worst member first, flat."""
    wins = np.array([np.bincount(row, minlength=POPULATION) for row in winners])
    worst_first = wins[:, np.argsort(-fitness)]
    return np.array([(worst_first == n).sum(axis=0) for n in range(3)]).T.ravel()
