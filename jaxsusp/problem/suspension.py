"""The fitness of the suspended load as optimisers evaluate it."""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import jax

from jaxsusp._types import Array, Float
from jaxsusp.geometry.nearby import Nearby, nearby_of, padded
from jaxsusp.mechanics.drives import moving
from jaxsusp.problem.choices import CONTACTS
from jaxsusp.problem.fitness import FitnessTerms, fitness_terms, waypoint_stability
from jaxsusp.problem.flatbatch import one_flat_batch
from jaxsusp.problem.twin import twin_fitness
from jaxsusp.scenario.world import World, cast_world

FEW = 100
"""Obstacles up to which all are tested against every segment: lists of them would cost as much."""


@jax.tree_util.register_dataclass
@dataclass(frozen=True, eq=False)  # compared and hashed by identity, so that jit accepts it
class Suspension:
    """Fitness of the suspended load (Eq. 21) as a callable pytree: world in, structure static."""

    world: World
    samples: int = field(metadata={"static": True})
    with_stability: bool = field(metadata={"static": True})
    drive: str = field(default="cable", metadata={"static": True})
    with_cables: bool = field(default=True, metadata={"static": True})
    contacts: str = field(default=CONTACTS[0], metadata={"static": True})
    nearby: Nearby | None = None  # of scenarios with more than `FEW` obstacles

    def terms(self, x: Float[Array, "dim *batch"]) -> FitnessTerms:
        """All terms of Eq. 21 in the dtype of x; trailing axes of x are batch."""
        world, nearby = cast_world(self.world, x.dtype), cast_world(self.nearby, x.dtype)
        return fitness_terms(world, x, *self._structure, nearby=nearby)

    def __call__(self, x: Float[Array, "dim"]) -> Float[Array, ""]:
        """Total fitness of one decision vector."""
        return self.terms(x).total

    def population(self, x: Float[Array, "pop dim"]) -> Float[Array, "pop"]:
        """Total fitness of many decision vectors, candidates in the last axis of all arithmetic."""
        return _population_fitness(self, x)

    def twin(self, x: Float[Array, "pop dim"], band) -> Float[Array, "pop"]:
        """The fitness of many decision vectors with depths in place of counts, see `twin`."""
        return twin_fitness(cast_world(self.world, x.dtype), x.T, *self._structure, band)

    def stability(self, x: Float[Array, "pop dim"]) -> Float[Array, "pop waypoints"]:
        """S_c of every waypoint of every candidate (Eq. 18)."""
        return waypoint_stability(cast_world(self.world, x.dtype), x.T, self.drive).T

    @property
    def _structure(self) -> tuple[int, bool, str, bool, str]:
        return self.samples, self.with_stability, self.drive, self.with_cables, self.contacts


@jax.jit  # inside the outer program: an optimiser evaluates several times and traces this once
def _flat_fitness(suspension: Suspension, x: Array) -> Array:
    return suspension.terms(x.T).total


_population_fitness = one_flat_batch(_flat_fitness)


def nearby_in(world: World, drive: str) -> Nearby | None:
    """Which obstacles can be touched from where; None where testing all of them is faster.

    Where the ends move, a position does not say where the cables are. Hulls of meshes, and loads
    that are no cylinders, have no lists.
    """
    listed = world.obstacles.hulls is None and world.bodies.sums is None
    if not listed or moving(drive):
        return None
    if sum(int(kind.active.sum()) for kind in world.obstacles[:3]) <= FEW:
        return None
    return nearby_of(world.bodies, world.obstacles, world.lower, world.upper)


def with_common_lists(fitness: Sequence[Suspension]) -> list[Suspension]:
    """The same with lists that stack: of one length, or none unless all have them."""
    lists = [each.nearby for each in fitness if each.nearby is not None]
    if len(lists) < len(fitness):
        return [replace(each, nearby=None) for each in fitness]
    common = max(each.numbers.size for each in lists)
    pairs = zip(fitness, lists, strict=True)
    return [replace(each, nearby=padded(own, common)) for each, own in pairs]
