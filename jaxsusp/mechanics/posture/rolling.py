"""Rolling bases that keep a load with three separate attachments level.

Where bases roll, heights of the ends and lengths of the cables stay. With attachments at one
height, moments about level axes then fix what every cable carries upwards,

    Σ v_k = m g,  Σ v_k (B'_k - c) = 0 in plan,

wherever the load is. Its height gives the slope of each cable and with it the level pull
h_k = v_k out_k / rise_k. What is left are three headings for three equations: the level pulls
must close to a triangle and must not turn the load about the vertical. Three sides close to one
triangle, given which way round it goes, and of the two ways to turn it that leave no moment the
one is stable in which cables pull outwards.
"""

import jax.numpy as jnp

from jaxsusp._types import Array, Float
from jaxsusp.mechanics.drives import Anchors
from jaxsusp.vec3 import Vec3, component, norm, pack, safe_sqrt


def upward_shares(
    attachments: Float[Array, "cables=3 xyz"], center_of_mass: Float[Array, "xyz"]
) -> Float[Array, "cables=3"]:
    """Share of the weight that each cable carries: where the centre of mass is in their triangle.

    One that is not positive would have to push.
    """
    a, b, c = jnp.asarray(attachments)[:, :2]
    p = jnp.asarray(center_of_mass)[:2]
    parts = jnp.stack([_cross(b - p, c - p), _cross(c - p, a - p), _cross(a - p, b - p)])
    return parts / parts.sum()


def rolled_level_ends(
    position: Vec3, anchors: Anchors, shares: Float[Array, "cables=3"], center_of_mass: Vec3
) -> Vec3:
    """Ends P_k (3, …) at their heights, by cables of their lengths, that hold the load level.

    Args:
        position: the load's centre, any shape (m).
        anchors: where ends and load begin; attachments of one height.
        shares: of the weight, see `upward_shares`.
        center_of_mass: from the load's centre (m).

    Returns:
        The ends; NaN where a cable is too short to reach up to its end's height, or where the level
        pulls close to no triangle; every limit check refuses that.
    """
    outs, pulls = [], []
    for k in range(3):
        end, lower = component(anchors.ends, k), component(anchors.attachments, k)
        rise = end.z - (position.z + lower.z)
        square = norm(end - (anchors.position + lower)) ** 2 - rise**2
        out = jnp.where(square >= 0, safe_sqrt(jnp.maximum(square, 0)), jnp.nan)
        outs.append(out)
        pulls.append(shares[k] * out / rise)
    around = jnp.sign(_cross(*(_plan(anchors, k, k + 1) for k in (0, 1))))
    headings = _triangle(pulls, around)
    arms = [component(anchors.attachments, k) - center_of_mass for k in range(3)]
    along, turning = jnp.zeros_like(outs[0]), jnp.zeros_like(outs[0])
    for pull, arm, (x, y) in zip(pulls, arms, headings, strict=True):
        along += pull * (arm.x * x + arm.y * y)
        turning += pull * (arm.x * y - arm.y * x)
    size = safe_sqrt(along**2 + turning**2)
    size = jnp.where(size > 0, size, jnp.nan)  # nothing holds its heading
    cos, sin = along / size, -turning / size
    found = []
    for k, (out, (x, y)) in enumerate(zip(outs, headings, strict=True)):
        lower = component(anchors.attachments, k)
        found.append(
            Vec3(
                position.x + lower.x + out * (cos * x - sin * y),
                position.y + lower.y + out * (sin * x + cos * y),
                jnp.broadcast_to(component(anchors.ends, k).z, out.shape),
            )
        )
    return pack(found)


def _triangle(pulls: list[Array], around: Array) -> list[tuple[Array, Array]]:
    """Headings of three level pulls that add up to nothing, the first along x."""
    one, two, three = pulls
    second = (three**2 - one**2 - two**2) / (2 * one * two)  # cosines of their headings
    third = (two**2 - one**2 - three**2) / (2 * one * three)
    closes = jnp.abs(second) < 1
    sines = [
        jnp.where(closes, safe_sqrt(jnp.maximum(1 - cosine**2, 0)), jnp.nan)
        for cosine in (second, third)
    ]
    return [
        (jnp.ones_like(one), jnp.zeros_like(one)),
        (second, around * sines[0]),
        (third, -around * sines[1]),
    ]


def _plan(anchors: Anchors, k: int, after: int) -> Float[Array, "2"]:
    """From one end to the next, seen from above."""
    step = component(anchors.ends, after) - component(anchors.ends, k)
    return jnp.stack([jnp.asarray(step.x), jnp.asarray(step.y)])


def _cross(a: Array, b: Array) -> Array:
    return a[0] * b[1] - a[1] * b[0]
