"""The constraint report: all of Eq. 22 with numbers, on the real curve of a plan (spec §9)."""

from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np

from jaxsusp._types import Array, Float
from jaxsusp.constraints import WORKSPACE_TOLERANCE, stability_of
from jaxsusp.mechanics import arm
from jaxsusp.mechanics.cables import cable_lengths, cable_vectors
from jaxsusp.mechanics.statics import GRAVITY, hook_tensions, weight
from jaxsusp.scenario import Scenario
from jaxsusp.trajectory.timelaw import TimeLaw
from jaxsusp.vec3 import Vec3
from jaxsusp.verify.certificate import ROUNDING, Certificate
from jaxsusp.world import World, build_world, cast_world, rounded_counts

INSTANTS = 2001
"""Times at which everything but the distances is computed: every 20 ms of a 40 s plan."""


class Check(NamedTuple):
    """One line of the report."""

    name: str
    value: float
    low: float  # -inf where there is no lower limit
    high: float
    unit: str
    time: float | None  # s, when the value occurs; None where it does not depend on time
    about: str  # which body, cable or robot; "" for the whole system
    slack: float = 0.0  # how far beyond a limit rounding may be

    @property
    def margin(self) -> float:
        """Distance to the nearer limit; negative where it is broken, NaN where nothing is known."""
        return float(np.minimum(self.value - self.low, self.high - self.value))

    @property
    def ok(self) -> bool:
        """Whether the limit is kept (NaN is not)."""
        return self.margin >= -self.slack

    @property
    def limit(self) -> str:
        """The limit in words."""
        if np.isinf(self.low):
            return f"at most {self.high:.5g} {self.unit}".rstrip()
        if np.isinf(self.high):
            return f"at least {self.low:.5g} {self.unit}".rstrip()
        return f"{self.low:.5g} to {self.high:.5g} {self.unit}".rstrip()

    @property
    def reason(self) -> str:
        """What is wrong, as a sentence."""
        about = f" of {self.about}" if self.about else ""
        when = "" if self.time is None else f" at {self.time:.2f} s"
        value = f"{self.value:.5g} {self.unit}".rstrip()
        return f"{self.name}{about} is {value}{when}, allowed is {self.limit}"


class Loads(NamedTuple):
    """Cables at many instants."""

    lengths: Float[np.ndarray, "times cables"]  # m
    static: Float[np.ndarray, "times cables"]  # tensions of a load at rest there, N
    tensions: Float[np.ndarray, "times cables"]  # with inertia, N
    stability: Float[np.ndarray, "times"]  # S_c, without inertia


def cable_loads(
    scenario: Scenario,
    ends: Float[Array, "cables xyz"],
    position: Float[Array, "times xyz"],
    acceleration: Float[Array, "times xyz"],
) -> Loads:
    """Lengths, tensions and stability factor of the level payload, float64 (Eq. 3, 4, 6, 18)."""
    with jax.enable_x64(True):
        world = with_ends(
            cast_world(build_world(scenario, rounded_counts(scenario)), np.float64), ends
        )
        found = _loads(world, jnp.asarray(position), jnp.asarray(acceleration))
        return Loads(*map(np.asarray, found))


def with_ends(world: World, ends: Float[Array, "cables xyz"]) -> World:
    """The same world with other cable ends."""
    return world._replace(bodies=world.bodies._replace(ends=Vec3.from_array(jnp.asarray(ends))))


@jax.jit
def _loads(world: World, position, acceleration) -> tuple[Array, ...]:
    where = Vec3.from_array(position)
    vectors = cable_vectors(where, world.bodies.attachments, world.bodies.ends)
    lengths, still = cable_lengths(vectors), weight(world.mass)
    static = hook_tensions(vectors, lengths, still)
    moving = hook_tensions(vectors, lengths, Vec3.from_array(acceleration) * world.mass + still)
    columns = (jnp.stack(each, axis=-1) for each in (lengths, static, moving))
    return *columns, stability_of(world, where, static)


def constraint_report(
    scenario: Scenario,
    law: TimeLaw,
    ends: Float[Array, "cables xyz"],
    joints: Float[Array, "cables joints"],
    certificate: Certificate,
) -> tuple[Check, ...]:
    """Every limit of Eq. 22 on the real curve.

    Tensions are those with inertia; they must keep T_lo and T_hi, and their peak is compared with
    the ultimate tension T_lim = k_a T_hi as well. The posture is level by plan; what is reported is
    the tilt at which a hanging load would ride the planned acceleration.

    Args:
        scenario: the limits.
        law: the motion of the load's centre.
        ends: P_k (m).
        joints: (φ1, φ2, φ3) of every robot (rad).
        certificate: distances.
    """
    times = np.linspace(0, law.duration, INSTANTS)
    motion = law.at(times)
    loads = cable_loads(scenario, ends, motion.position, motion.acceleration)
    limits = scenario.limits
    low, high = limits.tension
    ultimate = limits.safety_factor * high
    balance = _ratio(loads.tensions.min(axis=1), loads.tensions.max(axis=1))
    tilt = np.rad2deg(
        np.arctan2(
            np.linalg.norm(motion.acceleration[:, :2], axis=1), GRAVITY + motion.acceleration[:, 2]
        )
    )
    inf = np.inf
    checks = [
        _extreme("tilt of the load", tilt, times, max, -inf, limits.posture_deg, "°"),
        *_distances(certificate),
        _of_cable("length", loads.lengths, times, min, limits.cable_length[0], inf, "m"),
        _of_cable("length", loads.lengths, times, max, -inf, limits.cable_length[1], "m"),
        _of_cable("tension", loads.tensions, times, min, low, inf, "N"),
        _of_cable("tension", loads.tensions, times, max, -inf, high, "N"),
        _of_cable("ultimate tension T_lim", loads.tensions, times, max, -inf, ultimate, "N"),
        _extreme("tension ratio C_t", balance, times, min, 0.0, 1.0, "")._replace(slack=-1e-12),
        _extreme("stability factor S_c", loads.stability, times, min, limits.stability, inf, ""),
        *_inside(scenario, motion.position, times),
        *_robots(scenario, np.asarray(ends), np.asarray(joints)),
    ]
    return tuple(checks)


def _distances(certificate: Certificate) -> list[Check]:
    """The clearances of the certificate; kinds of which there is no pair are left out."""
    return [
        Check(
            f"distance of {each.kind}", each.value, each.required, np.inf, "m", each.time,
            " and ".join(each.bodies), ROUNDING,
        )
        for each in certificate.clearances
        if each.bodies[0]
    ]  # fmt: skip


def _extreme(name, values, times, which, low, high, unit, about="") -> Check:
    """The worst of a quantity over time; a NaN is the worst of all."""
    at = int(np.argmin(values) if which is min else np.argmax(values))
    return Check(name, float(values[at]), low, high, unit, float(times[at]), about, 1e-9)


def _of_cable(name, values, times, which, low, high, unit) -> Check:
    """The worst of a quantity over time and cables."""
    flat = int(np.argmin(values) if which is min else np.argmax(values))
    at, k = np.unravel_index(flat, values.shape)
    word = "least" if which is min else "greatest"
    about = f"cable {k + 1}"
    return Check(f"{word} {name}" if "ultimate" not in name else name, float(values[at, k]),
                 low, high, unit, float(times[at]), about, 1e-9)  # fmt: skip


def _inside(scenario: Scenario, position: np.ndarray, times: np.ndarray) -> list[Check]:
    """How far inside its workspace the load's centre stays."""
    box = scenario.workspace
    inside = np.minimum(position - box.lower, box.upper - position)
    return [
        _extreme(
            "inside the workspace", inside.min(axis=1), times, min,
            -WORKSPACE_TOLERANCE, np.inf, "m", "load",
        )
    ]  # fmt: skip


def _robots(scenario: Scenario, ends: np.ndarray, joints: np.ndarray) -> list[Check]:
    """Reach and joint angles of every robot."""
    checks = []
    with jax.enable_x64(True):
        for k, robot in enumerate(scenario.robots):
            base, links = jnp.array(robot.base), jnp.array(robot.links)
            distance = float(arm.shoulder_distance(base, links, jnp.asarray(ends[k])))
            near, far = map(float, arm.reach(links))
            about = f"robot {k + 1}"
            checks.append(Check("reach", distance, near, far, "m", None, about, 1e-9))
    limits = scenario.limits.joint_limits_deg
    if limits is not None:
        for k in range(len(ends)):
            ranges = limits[k if len(limits) > 1 else 0]
            for i, (low, high) in enumerate(ranges):
                value, about = float(np.rad2deg(joints[k, i])), f"robot {k + 1}"
                checks.append(
                    Check(f"joint angle φ{i + 1}", value, low, high, "°", None, about, 1e-9)
                )
    return checks


def _ratio(low: np.ndarray, high: np.ndarray) -> np.ndarray:
    return np.where(high > 0, low / np.where(high > 0, high, 1), 0.0)
