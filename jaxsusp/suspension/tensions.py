"""Cable tensions of a scenario at given load positions, for people."""

from collections.abc import Sequence

import jax
import jax.numpy as jnp
import numpy as np

from jaxsusp._types import Array, Float
from jaxsusp.geometry.cables import cable_lengths, cable_vectors
from jaxsusp.mechanics.statics import force_tensions, weight
from jaxsusp.scenario.scenario import Named, Scenario, load_scenario
from jaxsusp.scenario.world import build_world, cast_world
from jaxsusp.suspension.hanging import equilibrium
from jaxsusp.suspension.levelload import ends_at, tight_tension_limits
from jaxsusp.vec3 import Vec3


def tensions(
    scenario: Scenario | Named,
    position: Float[Array, "*batch xyz"] | Sequence,
    acceleration: Float[Array, "*#batch xyz"] | Sequence | float = 0.0,
) -> Float[Array, "*batch cables"]:
    """Tension of every cable that balances the payload (Eq. 4-7).

    At a hook with more than three cables it is the balance nearest to the middle of the tension
    range and within the limits wherever one is, see `mechanics.tensiondistribution`. With separate
    attachments it is that of the equilibrium posture, see `jaxsusp.equilibrium`. Where the ends
    move, they are where the drive mode's plain rule puts them.

    Args:
        scenario: ends, attachments, mass, limits and drive mode.
        position: payload centres, (…, 3), m.
        acceleration: of the payload, broadcastable to `position`, m/s².

    Returns:
        T (N), (…, K); negative where a cable would have to push, NaN where separate attachments
        find no equilibrium. Float64 for host input, whatever JAX's setting; the dtype of
        `position` for a JAX array.

    Raises:
        InputError: separate attachments whose ends no rule moves.
    """
    scenario = load_scenario(scenario, task_checked=False)
    if scenario.payload.attachments != "hook":
        found = equilibrium(scenario, position, acceleration)
        with jax.enable_x64(found.tensions.dtype == np.float64):
            return jnp.where(found.balanced[..., None], found.tensions, jnp.nan)
    dtype = position.dtype if isinstance(position, jax.Array) else np.dtype(np.float64)
    with jax.enable_x64(dtype == np.float64):
        where = jnp.asarray(position, dtype)
        pull = jnp.broadcast_to(jnp.asarray(acceleration, dtype), where.shape)
        world = cast_world(build_world(scenario), dtype)
        load = Vec3.from_array(where)
        vectors = cable_vectors(
            load, world.bodies.attachments, ends_at(world, load, scenario.drive)
        )
        force = Vec3.from_array(pull) * world.mass + weight(world.mass)
        limits = tight_tension_limits(world.limits, dtype)
        found = force_tensions(vectors, cable_lengths(vectors), force, limits)
        return jnp.stack(found, axis=-1)
