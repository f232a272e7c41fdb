"""The robots of a plan in a MuJoCo model: standing where the ends stay, driven where they move.

A driven arm turns about the vertical at its shoulder (φ1) and in its own plane at shoulder and
elbow (φ2, φ3); where bases roll they slide over the ground. Position servos hold all of these.
They are as stiff as drives with gears are: under a cable of 100 N the end of a stretched arm of
5 m gives way by 0.1 mm.
"""

from typing import Any, NamedTuple

import numpy as np

from jaxsusp._types import Float
from jaxsusp.scenario.ownunits import Frame
from jaxsusp.suspension.rigging import Rigging
from jaxsusp.verify.engine import mujoco
from jaxsusp.verify.pairs import PARTS

COLOR = (0.60, 0.64, 0.69, 1.0)

# All of these are in the task's own units, as those of `verify.model`.

ARMATURE = 1e3
"""kg m² (kg of a base); inertia of the drives."""

GAIN = 2.5e7
"""N m/rad (N/m of a base)."""

DAMPING = 2 * np.sqrt(GAIN * ARMATURE)
"""N m s/rad; critical."""


def add_robots(spec: Any, rigging: Rigging) -> None:
    """Add columns, links and cable ends; driven arms with servos, in the order of `commands`."""
    add = _add_driven if rigging.moves else _add_standing
    for k in range(rigging.cables):
        add(spec, rigging, k)


def servo_names(rigging: Rigging) -> list[str]:
    """Joints that servos hold: none where the ends stay."""
    if not rigging.moves:
        return []
    bases = ("base x", "base y") if rigging.rolls else ()
    return [
        f"{name} {k + 1}"
        for k in range(rigging.cables)
        for name in (*bases, "joint 1", "joint 2", "joint 3")
    ]


def servo_positions(
    rigging: Rigging, u: Float[np.ndarray, "times"]
) -> Float[np.ndarray, "times servos"]:
    """Where the servos are to be (m, rad)."""
    if not rigging.moves:
        return np.empty((len(u), 0))
    ends = rigging.ends_at(u)
    joints = rigging.joints_at(ends)
    if rigging.rolls:
        shift = (rigging.bases_at(ends) - rigging.bases)[..., :2]
        joints = np.concatenate([shift, joints], axis=-1)
    return joints.reshape(len(u), -1)


def _add_standing(spec: Any, rigging: Rigging, k: int) -> None:
    world, robot = spec.worldbody, rigging.scenario.robots[k]
    chain = rigging.chains_at(rigging.ends_at(np.zeros(1)))[0, k]
    for part, name in enumerate(PARTS):
        radius = robot.link_radius if part else robot.column_radius
        _capsule(world, f"{name} of robot {k + 1}", chain[part], chain[part + 1], radius)
    _end(world, rigging.scenario.units, k, chain[3])


def _add_driven(spec: Any, rigging: Rigging, k: int) -> None:
    robot, number = rigging.scenario.robots[k], k + 1
    units, origin = rigging.scenario.units, np.zeros(3)
    turn = _Servo(spec, units, mujoco.mjtJoint.mjJNT_HINGE)
    a1, a2, a3 = (np.array([0.0, 0.0, length]) for length in robot.links)
    foot = _body(spec.worldbody, units, f"robot {number}", robot.base)
    if rigging.rolls:
        slide = _Servo(spec, units, mujoco.mjtJoint.mjJNT_SLIDE)
        for name, axis in (("base x", [1, 0, 0]), ("base y", [0, 1, 0])):
            slide.add(foot, f"{name} {number}", axis)
    _capsule(foot, f"column of robot {number}", origin, a1, robot.column_radius)
    shoulder = _body(foot, units, f"shoulder {number}", a1)
    turn.add(shoulder, f"joint 1 {number}", [0, 0, 1])
    upper = _body(shoulder, units, f"upper {number}", origin)
    turn.add(upper, f"joint 2 {number}", [0, 1, 0])
    _capsule(upper, f"upper link of robot {number}", origin, a2, robot.link_radius)
    lower = _body(upper, units, f"lower {number}", a2)
    turn.add(lower, f"joint 3 {number}", [0, 1, 0])
    _capsule(lower, f"lower link of robot {number}", origin, a3, robot.link_radius)
    _end(lower, units, k, a3)


def _body(parent: Any, units: Frame, name: str, place: Any) -> Any:
    """A body whose weight the drives carry."""
    body = parent.add_body(name=name, pos=place, gravcomp=1)
    mass = units.number(1.0, "kg")
    body.explicitinertial, body.mass = True, mass
    body.inertia, body.ipos = [mass * units.length**2] * 3, [0.0] * 3  # without it no file has them
    return body


class _Servo(NamedTuple):
    """Joints of one kind, with the position servos that hold them."""

    spec: Any
    units: Frame
    kind: Any

    def add(self, body: Any, name: str, axis: list[int]) -> None:
        """Add one joint and its servo."""
        lever = 1.0 if self.kind == mujoco.mjtJoint.mjJNT_SLIDE else self.units.length**2
        gain, damping, armature = (
            lever * self.units.number(value, unit)
            for value, unit in ((GAIN, "N/m"), (DAMPING, "N s/m"), (ARMATURE, "kg"))
        )
        joint = body.add_joint(name=name, type=self.kind, axis=axis)
        joint.armature = armature
        self.spec.add_actuator(
            name=name,
            target=name,
            trntype=mujoco.mjtTrn.mjTRN_JOINT,
            gaintype=mujoco.mjtGain.mjGAIN_FIXED,
            gainprm=[gain, *[0] * 9],
            biastype=mujoco.mjtBias.mjBIAS_AFFINE,
            biasprm=[0, -gain, -damping, *[0] * 7],
        )


def _capsule(parent: Any, name: str, start: Any, stop: Any, radius: float) -> None:
    parent.add_geom(
        name=name, type=mujoco.mjtGeom.mjGEOM_CAPSULE, fromto=[*start, *stop],
        size=[radius, 0, 0], rgba=COLOR, contype=0,
    )  # fmt: skip


def _end(parent: Any, units: Frame, k: int, place: Any) -> None:
    size = [units.number(0.05, "m")] * 3
    parent.add_site(name=f"end {k + 1}", pos=place, size=size, rgba=COLOR)
