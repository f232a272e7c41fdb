"""The suite: 24 functions by their numbers, and a fitness that is any of them.

Which function it is, is an argument of the compiled program and not part of it: `lax.switch` picks
one branch while it runs, as long as nobody maps over the number. Instances may be mapped over.
"""

from dataclasses import dataclass

import jax
import numpy as np

from jaxsusp._types import Array, Float, Int
from jaxsusp.problem.problem import Problem
from jaxsusp.studies.bbob import multimodal, unimodal
from jaxsusp.studies.bbob.instances import Instance, instance

FUNCTIONS = (
    unimodal.sphere, unimodal.ellipsoid, unimodal.rastrigin, unimodal.bueche_rastrigin,
    unimodal.linear_slope, unimodal.attractive_sector, unimodal.step_ellipsoid,
    unimodal.rosenbrock, unimodal.rosenbrock_rotated, unimodal.ellipsoid_rotated, unimodal.discus,
    unimodal.bent_cigar, unimodal.sharp_ridge, unimodal.different_powers,
    multimodal.rastrigin_rotated, multimodal.weierstrass, multimodal.schaffers,
    multimodal.schaffers_ill_conditioned, multimodal.griewank_rosenbrock, multimodal.schwefel,
    multimodal.gallagher_101, multimodal.gallagher_21, multimodal.katsuura, multimodal.lunacek,
)  # fmt: skip
"""f1 to f24."""

GROUPS = {
    "separable": range(1, 6),
    "moderate condition": range(6, 10),
    "high condition": range(10, 15),
    "multimodal": range(15, 20),
    "weak structure": range(20, 25),
}
"""COCO's groups of functions."""

BOUND = 5.0
"""The box is [-5, 5]^D."""


@jax.tree_util.register_dataclass
@dataclass(frozen=True, eq=False)
class Landscape:
    """One function at one instance as a fitness: f(x), at least f_opt."""

    number: Int[Array, "*stack"]  # 1 to 24
    at: Instance

    def __call__(self, x: Float[Array, "dim"]) -> Float[Array, ""]:
        """The value at one point."""
        return self.population(x[None])[0]

    def population(self, x: Float[Array, "pop dim"]) -> Float[Array, "pop"]:
        """The values at many points."""
        branches = [jax.vmap(function, in_axes=(0, None)) for function in FUNCTIONS]
        return jax.lax.switch(self.number - 1, branches, x, self.at) + self.at.offset


def landscape(function: int, dim: int, number: int) -> Landscape:
    """A function of the suite by its number, with its instance drawn.

    Raises:
        InputError: there is no such function, dimension or instance.
    """
    return Landscape(np.array(function, np.int32), instance(function, dim, number))


def problem_of(fitness: Landscape, dim: int) -> Problem:
    """Minimise it in the box, in float64."""
    bound = np.full(dim, BOUND)
    return Problem(fitness=fitness, lower=-bound, upper=bound)
