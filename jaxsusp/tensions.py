"""Cable tensions of a scenario at given load positions, for people."""

from collections.abc import Sequence

import jax
import jax.numpy as jnp
import numpy as np

from jaxsusp._types import Array, Float
from jaxsusp.mechanics.cables import cable_lengths, cable_vectors
from jaxsusp.mechanics.statics import hook_tensions, weight
from jaxsusp.problem import require_hook_with_three_cables
from jaxsusp.scenario import Scenario
from jaxsusp.vec3 import Vec3
from jaxsusp.world import build_world, cast_world


def tensions(
    scenario: Scenario,
    position: Float[Array, "*batch xyz"] | Sequence,
    acceleration: Float[Array, "*#batch xyz"] | Sequence | float = 0.0,
) -> Float[Array, "*batch cables"]:
    """Tension of every cable that balances the level payload (Eq. 4; spec §3).

    Args:
        scenario: ends, attachments and mass.
        position: payload centres, (…, 3), m.
        acceleration: of the payload, broadcastable to `position`, m/s².

    Returns:
        T (N), (…, K); negative where a cable would have to push. Float64 for host input, whatever
        JAX's setting; the dtype of `position` for a JAX array.

    Raises:
        InputError: a system whose balance is not that of a hook with three cables.
    """
    require_hook_with_three_cables(scenario)
    dtype = position.dtype if isinstance(position, jax.Array) else np.dtype(np.float64)
    with jax.enable_x64(dtype == np.float64):
        where = jnp.asarray(position, dtype)
        pull = jnp.broadcast_to(jnp.asarray(acceleration, dtype), where.shape)
        world = cast_world(build_world(scenario), dtype)
        vectors = cable_vectors(Vec3.from_array(where), world.bodies.attachments, world.bodies.ends)
        force = Vec3.from_array(pull) * world.mass + weight(world.mass)
        found = hook_tensions(vectors, cable_lengths(vectors), force)
        return jnp.stack(found, axis=-1)
