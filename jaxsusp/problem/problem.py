"""What an optimiser sees: a fitness to minimise, bounds, and a rule that keeps candidates inside.

A `Problem` is a pytree: scenarios of one static shape share a compiled program, and stacked
problems go through `vmap`. Any JAX function can take the place of the suspension's fitness.
"""

from collections.abc import Callable, Sequence
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from jax.tree_util import Partial

from jaxsusp._types import Array, Float
from jaxsusp.errors import InputError, require_count, require_known
from jaxsusp.freespace.build import free_space
from jaxsusp.freespace.cells.subdivision import proved_blocked
from jaxsusp.freespace.space import FreeSpace
from jaxsusp.problem.choices import CONTACTS, SEARCHES
from jaxsusp.problem.fitness import FitnessTerms
from jaxsusp.problem.flatbatch import one_flat_batch
from jaxsusp.problem.given import bounds_of, held, require_fitness
from jaxsusp.problem.search import Regions, keep_inside, pad_regions, regions_of
from jaxsusp.problem.starts import Starts, starts_of
from jaxsusp.problem.suspension import Suspension, nearby_in, with_common_lists
from jaxsusp.scenario.ownunits import UNCHANGED, Frame
from jaxsusp.scenario.scenario import Named, Scenario, load_scenario
from jaxsusp.scenario.scope import require_rule
from jaxsusp.scenario.world import World, build_world, lowest
from jaxsusp.vec3 import Vec3


@jax.jit
def _flat_repair(regions: Regions, x: Array) -> Array:
    waypoints = x.T.reshape(-1, 3, len(x))
    inside = keep_inside(regions, Vec3(*(waypoints[:, i] for i in range(3))))
    return jnp.stack(inside, axis=1).reshape(-1, len(x)).T


_population_repair = one_flat_batch(_flat_repair)


class Problem:
    """Minimise `fitness` over `lower` <= x <= `upper`.

    Args:
        fitness: any JAX function from (D,) to a scalar; a callable pytree passes its leaves as
            arguments of the compiled program. One that offers `population(x)` is evaluated
            through it, (N, D) to (N,).
        lower: lower bounds, (D,).
        upper: upper bounds, (D,), above `lower`. The dtype of the bounds is that of the search.
        reference: the point that `frame="task"` moves relative to; default the middle of the
            bounds.
        regions: convex regions in whose union every waypoint (x, y, z) of a candidate is kept;
            default only the bounds.
        starts: candidates worth starting from, for optimisers that can use them.
        frame: how waypoints become places in the world, see `jaxsusp.scenario.ownunits`; default
            that they are such places, or none at all.

    Raises:
        InputError: bounds of different shapes, not finite, or lower >= upper anywhere; a plain
            function that JAX cannot follow, or that returns anything but one number.
    """

    fitness: Callable[[Array], Array]
    lower: Array
    upper: Array
    reference: Array
    regions: Regions | None
    starts: Starts | None
    frame: Frame

    def __init__(
        self, fitness: Callable, lower, upper, reference=None, regions=None, starts=None,
        frame: Frame = UNCHANGED,
    ):  # fmt: skip
        lower, upper = bounds_of(lower, upper)
        middle = lower + (upper - lower) / 2
        taken_apart = _is_pytree(fitness)  # its leaves may be tracers or placeholders
        if not taken_apart:
            require_fitness(fitness, lower.size, lower.dtype)
        self.fitness = fitness if taken_apart else Partial(fitness)
        self.lower, self.upper = lower, upper
        self.reference = middle if reference is None else np.asarray(reference, lower.dtype)
        self.frame = jax.tree.map(np.float64, frame)
        self.regions, self.starts = jax.tree.map(
            lambda leaf: np.asarray(leaf, lower.dtype), (regions, starts)
        )

    @classmethod
    def from_scenario(
        cls,
        scenario: Scenario | Named,
        waypoints: int = 5,
        samples: int = 40,
        search: str = SEARCHES[0],
        dtype: Any = None,
        world: World | None = None,
        with_stability: bool | None = None,
        space: FreeSpace | None = None,
        contacts: str = CONTACTS[0],
    ) -> "Problem":
        """Planning the load's trajectory of a scenario: x holds the m waypoints, D = 3m.

        All of it is in the task's own units and frame (see `jaxsusp.scenario.ownunits`), the terms
        of the fitness too; `places` and `decision` convert.

        Args:
            scenario: the task.
            waypoints: number m of free waypoints between start and goal.
            samples: number n of trajectory samples, both ends included.
            search: what waypoints are kept in: "free-space" (the polytopes of the scenario's free
                space), "ellipsoid" (their ellipsoids, the paper's rule) or "box" (the workspace).
            dtype: of the bounds and thereby of a search; default JAX's default float.
            world: the arrays of `scenario.own` if they are at hand (for example padded to a common
                number of obstacles); default built from the scenario.
            with_stability: whether S_cmin is checked; default: if the scenario sets it above 0.
            space: the scenario's free space if it is at hand; default `jaxsusp.free_space` of it.
            contacts: where they are looked for: "swept", at every instant of the polyline, or
                "sampled", the paper's check at the samples alone, through which cables slip.

        Raises:
            InputError: too few waypoints or samples, an unknown search rule, a suspension that
                planning cannot handle (see `scenario.scope`), or no collision-free route
                where the search is confined to the free space.
        """
        asked = load_scenario(scenario)
        scenario = asked.own
        require_count("waypoints", waypoints)
        require_count("samples", samples, least=3)  # fewer define no curvature
        require_known("search", search, SEARCHES)
        require_known("contacts", contacts, CONTACTS)
        require_rule(scenario)
        dtype = dtype or jnp.zeros(()).dtype
        world = build_world(scenario) if world is None else world
        if with_stability is None:
            with_stability = scenario.limits.stability > 0
        line = np.linspace(scenario.task.start, scenario.task.goal, waypoints + 2)[1:-1]
        return cls(
            Suspension(
                world,
                samples,
                with_stability,
                scenario.drive,
                contacts=contacts,
                nearby=nearby_in(world, scenario.drive),
            ),
            np.tile(np.asarray(lowest(scenario), dtype), waypoints),
            np.tile(np.asarray(scenario.workspace.upper, dtype), waypoints),
            line.reshape(-1),
            *(_confine(scenario, search, space, waypoints) if search != "box" else (None, None)),
            asked.units,
        )

    def places(self, x: Float[Array, "*batch dim"]) -> Float[np.ndarray, "*batch waypoints xyz"]:
        """The waypoints of decision vectors as places in the world (m, float64)."""
        waypoints = np.asarray(x, np.float64).reshape(*np.shape(x)[:-1], -1, 3)
        return self._frame.place(waypoints)

    def decision(
        self, places: Float[Array, "*batch waypoints xyz"] | Sequence
    ) -> Float[Array, "*batch dim"]:
        """The decision vectors of waypoints in the world (m), float64."""
        waypoints = self._frame.inside(places)
        return waypoints.reshape(*waypoints.shape[:-2], -1)

    @property
    def _frame(self) -> Frame:
        """The frame as plain numbers."""
        return jax.tree.map(float, self.frame)

    @property
    def origin(self) -> Float[Array, "dim"]:
        """The world's origin as a decision vector: what `frame="world"` moves relative to."""
        along = [-c / self.frame.length for c in self.frame.origin]
        row = jnp.stack(along).astype(held(self.lower.dtype))
        return jnp.tile(row, self.dim // 3 + 1)[: self.dim]

    @property
    def low(self) -> Float[Array, "1 dim"]:
        """Lower bounds as a row, beside a population."""
        return self.lower[None]

    @property
    def high(self) -> Float[Array, "1 dim"]:
        """Upper bounds as a row, beside a population."""
        return self.upper[None]

    @property
    def dim(self) -> int:
        """Number D of decision variables."""
        return self.lower.shape[-1]

    def terms(self, x: Float[Array, "dim"]) -> FitnessTerms:
        """All terms of Eq. 21 for one decision vector, in its dtype."""
        if not isinstance(self.fitness, Suspension):
            raise AttributeError(
                "terms belong to problems made by Problem.from_scenario; call fitness(x) instead"
            )
        return self.fitness.terms(jnp.asarray(x))

    def evaluate(self, x: Float[Array, "pop dim"]) -> Float[Array, "pop"]:
        """Fitness of a population; anything that is not finite ranks as +inf."""
        population = getattr(self.fitness, "population", None) or jax.vmap(self.fitness)
        value = population(x).astype(held(x.dtype))
        return jnp.where(jnp.isfinite(value), value, jnp.inf)

    def twin(self, x: Float[Array, "pop dim"], band: Any = 0.0) -> Float[Array, "pop"]:
        """A fitness with a gradient that is of use: that of the suspension's smooth twin.

        Equal to the fitness wherever nothing is in contact and no limit is violated, see
        `problem.twin`; of a generic problem the fitness itself.

        Args:
            x: a population.
            band: how near to a contact or limit, in shares of what counts as one, what is clear
                costs already; 0: nothing does.
        """
        if twin := getattr(self.fitness, "twin", None):
            return twin(x, band)
        population = getattr(self.fitness, "population", None) or jax.vmap(self.fitness)
        return population(x).astype(held(x.dtype))

    def stability(self, x: Float[Array, "pop dim"]) -> Float[Array, "pop waypoints"] | None:
        """S_c of every candidate's waypoints (Eq. 18); None on a generic problem."""
        stability = getattr(self.fitness, "stability", None)
        return stability(x) if stability else None

    def repair(self, x: Float[Array, "pop dim"]) -> Float[Array, "pop dim"]:
        """The admissible point that is evaluated and kept in place of x."""
        inside = self.clip(x)
        return inside if self.regions is None else _population_repair(self.regions, inside)

    def clip(self, x: Float[Array, "pop dim"]) -> Float[Array, "pop dim"]:
        """The nearest point within the bounds, whatever the regions."""
        return jnp.clip(x, self.low, self.high)

    def with_fitness(self, fitness: Callable[[Array], Array]) -> "Problem":
        """The same bounds, regions and reference with another fitness, a callable pytree."""
        return self._with(fitness=fitness)

    def with_padded_regions(self, count: int, rows: int) -> "Problem":
        """The same problem with so many regions of so many rows, some of which hold nothing."""
        assert self.regions is not None
        padded = pad_regions(self.regions, count, rows)
        return self._with(regions=padded)

    def _with(self, **changed: Any) -> "Problem":
        leaves = {name: getattr(self, name) for name in _LEAVES}
        return _unflatten(None, (leaves | changed).values())

    def sample(self, key, count: int) -> Float[Array, "pop dim"]:
        """Uniform random candidates."""
        unit = jax.random.uniform(key, (count, self.dim), held(self.lower.dtype))
        return self.repair(self.low + (self.high - self.low) * unit)


_LEAVES = ("fitness", "lower", "upper", "reference", "regions", "starts", "frame")


def _flatten(problem: Problem):
    return tuple(getattr(problem, name) for name in _LEAVES), None


def _unflatten(_, children) -> Problem:
    problem = object.__new__(Problem)  # leaves may be tracers or placeholders: nothing to check
    for name, child in zip(_LEAVES, children, strict=True):
        setattr(problem, name, child)
    return problem


jax.tree_util.register_pytree_node(Problem, _flatten, _unflatten)


def stack_problems(problems: Sequence[Problem]) -> Problem:
    """Stack problems along a new leading axis of every leaf.

    They are of equal static shape but for their regions, which are padded to common counts.
    """
    problems = _alike(problems)
    shapes = [each.regions.table.shape for each in problems if each.regions is not None]
    if shapes:
        count, rows, _ = np.max(shapes, axis=0).tolist()
        problems = [each.with_padded_regions(count, rows) for each in problems]
    return jax.tree.map(lambda *leaves: np.stack(leaves), *problems)


def _alike(problems: Sequence[Problem]) -> Sequence[Problem]:
    """Problems whose fitness is of one structure: lists of obstacles of one length, or none."""
    fitness = [each.fitness for each in problems]
    if not any(isinstance(each, Suspension) and each.nearby for each in fitness):
        return problems
    pairs = zip(problems, with_common_lists(fitness), strict=True)  # type: ignore[arg-type]
    return [each.with_fitness(alike) for each, alike in pairs]


def _confine(
    scenario: Scenario, search: str, space: FreeSpace | None, waypoints: int
) -> tuple[Regions | None, Starts]:
    """The regions of a search rule, and starts on routes through them.

    Raises:
        InputError: start and goal are not connected.
    """
    space = free_space(scenario) if space is None else space.own
    if not space.connected:
        remedy = 'move start, goal or obstacles, or search = "box"'
        if proved_blocked(scenario):
            remedy = "it is proved that there is none, see jaxsusp.why_not; move obstacles or task"
        raise InputError(f'{scenario.name}: search = "{search}": {space.reason}; {remedy}')
    return regions_of(space, search), starts_of(space, waypoints)


def _is_pytree(value: Any) -> bool:
    """Whether JAX knows how to take a callable apart (a plain function is a leaf)."""
    return not jax.tree_util.all_leaves([value])
