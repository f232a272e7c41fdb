"""The system of a plan as a MuJoCo model: ends, cables that only pull, and the load.

A cable is a spatial tendon from its end to its attachment, driven by an actuator that pulls in
proportion to how much longer the tendon is than the commanded length, with damping, and never
pushes. The load has six freedoms. Its rotations are damped a little, as friction in a hook would:
the paper gives no number, ours is a tenth of critical.
"""

from typing import Any, NamedTuple

import numpy as np

from jaxsusp.scenario.scenario import Scenario
from jaxsusp.scenario.world import attachments_of
from jaxsusp.suspension.rigging import Rigging
from jaxsusp.verify.armmodel import add_robots, servo_names, servo_positions
from jaxsusp.verify.bodies import (
    BoxShape,
    CapsuleShape,
    CylinderShape,
    HullShape,
    Shape,
    named_shapes,
)
from jaxsusp.verify.engine import mujoco

# All of these are in the task's own units (see `jaxsusp.scenario.ownunits`), which are those of the
# benchmark's loads: a model in SI units has them converted, and is the same system at every size.

ELONGATION = 1e-3
"""How much longer than commanded a cable is under its greatest tension."""

DAMPING_RATIO = 0.433013
"""Share of critical, of winches whose cables hold the load straight up together."""

STEPS_PER_PERIOD = 18
"""Time steps, at least, per period of the load on those cables: its fastest translation."""

TIMESTEP = 0.002
"""Longest time step in the task's own units, for a load that swings about its attachments."""

SWING_DAMPING = 0.1
"""Share of critical damping of the load's swing about the hook."""

_STONE = (0.79, 0.80, 0.83, 1.0)
_LOAD, _CABLE = (0.77, 0.24, 0.0, 1.0), (0.17, 0.17, 0.17, 1.0)


class Cables(NamedTuple):
    """What makes cables behave alike at every size and load."""

    stiffness: float  # N/m
    damping: float  # N s/m, of the winches
    timestep: float  # s

    @classmethod
    def of(cls, scenario: Scenario) -> "Cables":
        """From the greatest tension, the load's mass and the number of cables."""
        mass, count = scenario.payload.mass, len(scenario.robots)
        stiffness = scenario.limits.tension[1] / scenario.units.number(ELONGATION, "m")
        period = 2 * np.pi * np.sqrt(mass / (count * stiffness))
        damping = 2 * DAMPING_RATIO * np.sqrt(stiffness * mass / count)
        longest = scenario.units.number(TIMESTEP, "s")
        return cls(stiffness, float(damping), min(longest, float(period / STEPS_PER_PERIOD)))


def build_spec(rigging: Rigging) -> Any:
    """The model as an editable MuJoCo specification; its key frame 0 is the start at rest.

    Controls are unstretched cable lengths (m), one per cable in order, and behind them what the
    servos of moving robots hold (`armmodel.servo_names`).
    """
    spec = mujoco.MjSpec()
    spec.modelname = rigging.scenario.name
    units = rigging.scenario.units
    stiffness, damping, spec.option.timestep = Cables.of(rigging.scenario)
    spec.option.integrator = mujoco.mjtIntegrator.mjINT_IMPLICITFAST
    spec.visual.global_.offwidth, spec.visual.global_.offheight = 1920, 1080
    spec.visual.headlight.ambient = [0.45] * 3
    spec.visual.headlight.diffuse = [0.45] * 3
    spec.visual.map.zfar = units.number(60.0, "m")
    _surroundings(spec, rigging)
    _load(spec, rigging)
    limits = rigging.scenario.limits
    for k in range(rigging.cables):
        tendon = spec.add_tendon(name=f"cable {k + 1}", rgba=_CABLE)
        tendon.width = 2 * limits.cable_radius  # twice life, to be seen from afar
        spec.add_actuator(
            name=f"winch {k + 1}",
            target=f"cable {k + 1}",
            trntype=mujoco.mjtTrn.mjTRN_TENDON,
            gaintype=mujoco.mjtGain.mjGAIN_FIXED,
            gainprm=[stiffness, *[0] * 9],
            biastype=mujoco.mjtBias.mjBIAS_AFFINE,
            biasprm=[0, -stiffness, -damping, *[0] * 7],
            ctrllimited=True,
            ctrlrange=[0, 2 * limits.cable_length[1]],
            forcelimited=True,
            forcerange=[-units.number(1e6, "N"), 0],  # a cable pulls and never pushes
        )
    add_robots(spec, rigging)
    for k, tendon in enumerate(spec.tendons):
        tendon.wrap_site(f"end {k + 1}")
        tendon.wrap_site(f"attachment {k + 1}")
    _key_frame(spec, rigging)
    return spec


def _key_frame(spec: Any, rigging: Rigging) -> None:
    """The state at the start: servos where they are to be, the load in its posture."""
    model = spec.compile()
    state = np.zeros(model.nq)
    servos = servo_positions(rigging, np.array(rigging.law.path.span[:1]))[0]
    for name, value in zip(servo_names(rigging), servos, strict=True):
        state[model.joint(name).qposadr[0]] = value
    turn = model.joint("turn").qposadr[0]
    loads, stiffness = rigging.loads(np.zeros(1)), Cables.of(rigging.scenario).stiffness
    mujoco.mju_mat2Quat(state[turn : turn + 4], loads.posture[0].ravel())
    control = np.concatenate([loads.lengths[0] - loads.tensions[0] / stiffness, servos])
    spec.add_key(name="start", qpos=state, ctrl=control)


def _surroundings(spec: Any, rigging: Rigging) -> None:
    """Floor, lights, obstacles and arms."""
    world = spec.worldbody
    spec.add_texture(
        name="sky", type=mujoco.mjtTexture.mjTEXTURE_SKYBOX, width=64, height=384,
        builtin=mujoco.mjtBuiltin.mjBUILTIN_GRADIENT, rgb1=[1, 1, 1], rgb2=[0.86, 0.89, 0.93],
    )  # fmt: skip
    units = rigging.scenario.units
    world.add_light(
        pos=units.place([3, -6, 12]), dir=[-0.2, 0.4, -0.9], diffuse=[0.4] * 3,
        type=mujoco.mjtLightType.mjLIGHT_DIRECTIONAL,
    )  # fmt: skip
    if (height := rigging.scenario.ground_height) is not None:
        middle = units.place([0, 0, 0])
        _floor(world, [middle[0], middle[1], height], units.length)
    for number, obstacle in enumerate(rigging.scenario.obstacles, start=1):
        name = f"{number} {obstacle.name or f'obstacle {number}'}"
        for part, shape in named_shapes(obstacle, name):
            _geom(spec, part, shape)


def _floor(world: Any, place: list[float], length: float) -> None:
    """The ground, drawn about the robots and in contact everywhere."""
    world.add_geom(
        name="floor", type=mujoco.mjtGeom.mjGEOM_PLANE, pos=place,
        size=[9 * length, 9 * length, 0.1 * length], rgba=[0.93, 0.93, 0.92, 1], contype=0,
    )  # fmt: skip


def _geom(spec: Any, name: str, shape: Shape) -> None:
    """An obstacle; like all that is not the load it is in contact with the load only."""
    look = {"name": name, "rgba": _STONE, "contype": 0}
    kinds, world = mujoco.mjtGeom, spec.worldbody
    match shape:
        case HullShape():
            shape.add(spec, name)
            geom = spec.geom(name)
            geom.rgba, geom.contype = _STONE, 0
        case BoxShape(center, half, yaw):
            turn = [np.cos(yaw / 2), 0, 0, np.sin(yaw / 2)]
            world.add_geom(type=kinds.mjGEOM_BOX, pos=center, size=half, quat=turn, **look)
        case CylinderShape(center, radius, half_height):
            size = [radius, half_height, 0]
            world.add_geom(type=kinds.mjGEOM_CYLINDER, pos=center, size=size, **look)
        case CapsuleShape(start, _, radius):  # obstacles of this shape are spheres
            world.add_geom(type=kinds.mjGEOM_SPHERE, pos=start, size=[radius, 0, 0], **look)


def _load(spec: Any, rigging: Rigging) -> None:
    """The load at the start: three translations, a ball joint, and its attachments."""
    payload = rigging.scenario.payload
    hook = payload.height / 2 - payload.center_of_mass[2]  # above the centre of mass
    body = spec.worldbody.add_body(name="load", pos=rigging.scenario.task.start)
    for name, axis in (("x", [1, 0, 0]), ("y", [0, 1, 0]), ("z", [0, 0, 1])):
        body.add_joint(name=name, type=mujoco.mjtJoint.mjJNT_SLIDE, axis=axis)
    faces = payload.body
    inertia = payload.mass * (payload.height**2 / 12 + payload.radius**2 / 4 + hook**2)
    if faces is not None:
        inertia = payload.mass * float(faces.inertia[:2, :2].trace() / 2 + hook**2)
    stiffness = payload.mass * 9.81 * hook  # of the pendulum about the hook, N m/rad
    damping = 2 * SWING_DAMPING * np.sqrt(inertia * stiffness)
    turn = body.add_joint(name="turn", type=mujoco.mjtJoint.mjJNT_BALL)
    turn.damping = np.full(np.shape(turn.damping), damping) if np.ndim(turn.damping) else damping
    body.explicitinertial, body.mass = True, payload.mass
    body.ipos = payload.center_of_mass
    if faces is None:
        body.add_geom(
            name="load", type=mujoco.mjtGeom.mjGEOM_CYLINDER, rgba=_LOAD,
            size=[payload.radius, payload.height / 2, 0],
        )  # fmt: skip
        across = payload.mass * (payload.height**2 / 12 + payload.radius**2 / 4)
        body.inertia = [across, across, payload.mass * payload.radius**2 / 2]
    else:
        spec.add_mesh(name="load", uservert=faces.corners.ravel())
        kind = mujoco.mjtGeom.mjGEOM_MESH
        body.add_geom(name="load", type=kind, meshname="load", rgba=_LOAD)
        (xx, xy, xz), (_, yy, yz), (_, _, zz) = (payload.mass * faces.inertia).tolist()
        body.fullinertia = [xx, yy, zz, xy, xz, yz]
    dot = rigging.scenario.units.number(0.02, "m")
    for k, place in enumerate(attachments_of(rigging.scenario)):
        body.add_site(name=f"attachment {k + 1}", pos=place, size=[dot] * 3, rgba=_CABLE)
