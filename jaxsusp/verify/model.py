"""The system of a plan as a MuJoCo model: ends, cables that only pull, and the load.

A cable is a spatial tendon from its end to the hook, driven by an actuator that pulls in
proportion to how much longer the tendon is than the commanded length, with damping, and never
pushes. The load has six freedoms. Its rotations are damped a little, as friction in a hook would:
the paper gives no number, ours is a tenth of critical.
"""

from typing import Any

import numpy as np

from jaxsusp.plans import Plan, hold
from jaxsusp.verify.engine import mujoco
from jaxsusp.verify.scene import BoxShape, CapsuleShape, CylinderShape, Fixed, fixed_bodies

TIMESTEP = 0.002
"""s; a tenth of the shortest period of the stretched cables."""

STIFFNESS = 1e5
"""N/m; a cable under 100 N is 1 mm longer than commanded."""

DAMPING = 500.0
"""N s/m, of the winches: about a third of critical for the default load."""

SWING_DAMPING = 0.1
"""Share of critical damping of the load's swing about the hook."""

_STONE, _ARM = (0.79, 0.80, 0.83, 1.0), (0.60, 0.64, 0.69, 1.0)
_LOAD, _CABLE = (0.77, 0.24, 0.0, 1.0), (0.17, 0.17, 0.17, 1.0)


def build_spec(plan: Plan) -> Any:
    """The model as an editable MuJoCo specification, the load at the start.

    Controls are cable lengths (m), one actuator per cable, in order.
    """
    spec = mujoco.MjSpec()
    spec.modelname = plan.scenario.name
    spec.option.timestep = TIMESTEP
    spec.option.integrator = mujoco.mjtIntegrator.mjINT_IMPLICITFAST
    spec.visual.global_.offwidth, spec.visual.global_.offheight = 1920, 1080
    spec.visual.headlight.ambient = [0.45] * 3
    spec.visual.headlight.diffuse = [0.45] * 3
    spec.visual.map.zfar = 60.0
    _surroundings(spec, plan)
    _load(spec, plan)
    for k, end in enumerate(plan.ends):
        spec.worldbody.add_site(name=f"end {k + 1}", pos=end, size=[0.05] * 3, rgba=_ARM)
        tendon = spec.add_tendon(name=f"cable {k + 1}", rgba=_CABLE)
        tendon.width = 2 * plan.scenario.limits.cable_radius  # twice life, to be seen from afar
        tendon.wrap_site(f"end {k + 1}")
        tendon.wrap_site("hook")
        spec.add_actuator(
            name=f"winch {k + 1}",
            target=f"cable {k + 1}",
            trntype=mujoco.mjtTrn.mjTRN_TENDON,
            gaintype=mujoco.mjtGain.mjGAIN_FIXED,
            gainprm=[STIFFNESS, *[0] * 9],
            biastype=mujoco.mjtBias.mjBIAS_AFFINE,
            biasprm=[0, -STIFFNESS, -DAMPING, *[0] * 7],
            ctrllimited=True,
            ctrlrange=[0, 2 * plan.scenario.limits.cable_length[1]],
            forcelimited=True,
            forcerange=[-1e6, 0],  # a cable pulls and never pushes
        )
    return spec


def _surroundings(spec: Any, plan: Plan) -> None:
    """Floor, lights, obstacles and arms."""
    world = spec.worldbody
    spec.add_texture(
        name="sky", type=mujoco.mjtTexture.mjTEXTURE_SKYBOX, width=64, height=384,
        builtin=mujoco.mjtBuiltin.mjBUILTIN_GRADIENT, rgb1=[1, 1, 1], rgb2=[0.86, 0.89, 0.93],
    )  # fmt: skip
    world.add_light(
        pos=[3, -6, 12], dir=[-0.2, 0.4, -0.9], diffuse=[0.4] * 3,
        type=mujoco.mjtLightType.mjLIGHT_DIRECTIONAL,
    )  # fmt: skip
    world.add_geom(
        name="floor", type=mujoco.mjtGeom.mjGEOM_PLANE, size=[9, 9, 0.1],
        rgba=[0.93, 0.93, 0.92, 1],
    )  # fmt: skip
    elbow_up = plan.joints[0, :, 2] >= 0
    posture = hold(plan.scenario, plan.law, plan.ends, len(plan.times), elbow_up)
    for index, body in enumerate(fixed_bodies(plan.scenario, posture.chains)):
        name = f"{body.name}" if body.robot >= 0 else f"{index + 1} {body.name}"
        _geom(world, name, body)


def _geom(world: Any, name: str, body: Fixed) -> None:
    """A body that stands still, with contacts."""
    look = {"name": name, "rgba": _STONE if body.robot < 0 else _ARM}
    kinds = mujoco.mjtGeom
    match body.shape:
        case BoxShape(center, half, yaw):
            turn = [np.cos(yaw / 2), 0, 0, np.sin(yaw / 2)]
            world.add_geom(type=kinds.mjGEOM_BOX, pos=center, size=half, quat=turn, **look)
        case CylinderShape(center, radius, half_height):
            size = [radius, half_height, 0]
            world.add_geom(type=kinds.mjGEOM_CYLINDER, pos=center, size=size, **look)
        case CapsuleShape(start, stop, radius) if np.allclose(start, stop):
            world.add_geom(type=kinds.mjGEOM_SPHERE, pos=start, size=[radius, 0, 0], **look)
        case CapsuleShape(start, stop, radius):
            line = [*start, *stop]
            size = [radius, 0, 0]
            world.add_geom(type=kinds.mjGEOM_CAPSULE, fromto=line, size=size, **look)


def _load(spec: Any, plan: Plan) -> None:
    """The load at the start: three translations, a ball joint, and the hook on top."""
    payload = plan.scenario.payload
    hook = payload.height / 2
    body = spec.worldbody.add_body(name="load", pos=plan.scenario.task.start)
    for name, axis in (("x", [1, 0, 0]), ("y", [0, 1, 0]), ("z", [0, 0, 1])):
        body.add_joint(name=name, type=mujoco.mjtJoint.mjJNT_SLIDE, axis=axis)
    inertia = payload.mass * (payload.height**2 / 12 + payload.radius**2 / 4 + hook**2)
    stiffness = payload.mass * 9.81 * hook  # of the pendulum about the hook, N m/rad
    damping = 2 * SWING_DAMPING * np.sqrt(inertia * stiffness)
    turn = body.add_joint(name="turn", type=mujoco.mjtJoint.mjJNT_BALL)
    turn.damping = np.full(np.shape(turn.damping), damping) if np.ndim(turn.damping) else damping
    body.add_geom(
        name="load", type=mujoco.mjtGeom.mjGEOM_CYLINDER, rgba=_LOAD, mass=payload.mass,
        size=[payload.radius, payload.height / 2, 0],
    )  # fmt: skip
    body.add_site(name="hook", pos=[0, 0, hook], size=[0.02] * 3, rgba=_CABLE)
