"""Cable tensions against MuJoCo: the load hung from three one-sided spatial tendons.

MuJoCo knows nothing of Eq. 4. Each cable is a tendon from a fixed site to the hook, limited to
[0, l_k]; the load is a rigid body with six freedoms. It settles under gravity and damping, and the
forces of the tendon limits are the tensions. The soft limits let the load sink by a fraction of a
millimetre, so what is compared is MuJoCo's force with `js.tensions` at the position where the load
came to rest, not where it was released.
"""

from typing import NamedTuple

import mujoco
import numpy as np
import pytest

import jaxsusp as js

POSITIONS = 30
TIMESTEP = 0.002  # s
SETTLING = 10_000  # steps

NOMINAL = (7.0, 7.0, 7.0)  # m, heights of the three ends
UNEVEN = (6.3, 7.0, 7.7)


class Rest(NamedTuple):
    """A load that hangs still."""

    position: np.ndarray  # centre of mass, m
    tensions: np.ndarray  # N
    stretch: np.ndarray  # of the cables beyond their lengths, m
    tilt: float  # rad
    speed: float  # greatest of all m/s and rad/s


def with_end_heights(scenario: js.Scenario, heights: tuple[float, ...]) -> js.Scenario:
    content = scenario.model_dump()
    for robot, height in zip(content["robots"], heights, strict=True):
        robot["end"] = (*robot["end"][:2], height)
    return js.Scenario.model_validate(content)


def hang(scenario: js.Scenario, position: np.ndarray) -> Rest:
    """Release the load at `position` with taut cables and wait until it rests."""
    payload = scenario.payload
    hook = position + np.array([0.0, 0.0, payload.height / 2])
    lengths = [np.linalg.norm(np.subtract(robot.end, hook)) for robot in scenario.robots]
    model = mujoco.MjModel.from_xml_string(_xml(scenario, position, lengths))
    data = mujoco.MjData(model)
    mujoco.mj_step(model, data, SETTLING)
    speed = np.abs(data.qvel).max()
    mujoco.mj_forward(model, data)

    limits = data.efc_type == mujoco.mjtConstraint.mjCNSTR_LIMIT_TENDON
    assert limits.sum() == len(lengths), "a cable is slack"
    tensions = np.empty(len(lengths))
    tensions[data.efc_id[limits]] = data.efc_force[limits]
    upright = data.body("load").xmat[8]
    return Rest(
        data.body("load").xpos.copy(),
        tensions,
        data.ten_length - lengths,
        np.arccos(min(1.0, upright)),
        speed,
    )


def _xml(scenario: js.Scenario, position, lengths) -> str:
    payload = scenario.payload

    def row(numbers) -> str:
        return " ".join(repr(float(number)) for number in numbers)

    ends = "".join(
        f'<site name="end{k}" pos="{row(robot.end)}"/>' for k, robot in enumerate(scenario.robots)
    )
    cables = "".join(
        f'<spatial limited="true" range="0 {length!r}" solreflimit=".004 1" '
        f'solimplimit=".99 .9999 .001"><site site="end{k}"/><site site="hook"/></spatial>'
        for k, length in enumerate(map(float, lengths))
    )
    return f"""
    <mujoco>
      <option gravity="0 0 -9.81" timestep="{TIMESTEP}" tolerance="0" iterations="50"/>
      <worldbody>
        {ends}
        <body name="load" pos="{row(position)}">
          <joint type="free" damping="20"/>
          <geom type="cylinder" size="{payload.radius} {payload.height / 2}" mass="{payload.mass}"/>
          <site name="hook" pos="0 0 {payload.height / 2}"/>
        </body>
      </worldbody>
      <tendon>{cables}</tendon>
    </mujoco>"""


def positions_with_pull_in_every_cable(scenario: js.Scenario, seed: int) -> np.ndarray:
    """Random positions in the workspace, straight below the triangle of the ends."""
    rng = np.random.default_rng(seed)
    workspace = scenario.workspace
    candidates = rng.uniform(workspace.lower, workspace.upper, (20 * POSITIONS, 3))
    corners = np.array([robot.end for robot in scenario.robots])
    planar = np.vstack([corners[:, :2].T, np.ones(3)])
    weights = np.linalg.solve(planar, np.vstack([candidates[:, :2].T, np.ones(len(candidates))]))
    inside = (weights > 0.03).all(axis=0)
    return candidates[inside][:POSITIONS]


@pytest.mark.parametrize("heights", [NOMINAL, UNEVEN], ids=["level ends", "uneven ends"])
def test_tensions_are_those_of_a_load_at_rest_on_three_tendons(scenarios, heights):
    scenario = with_end_heights(scenarios[0], heights)
    positions = positions_with_pull_in_every_cable(scenario, seed=1)
    assert len(positions) == POSITIONS

    rests = [hang(scenario, position) for position in positions]
    settled = np.array([rest.position for rest in rests])
    theirs = np.array([rest.tensions for rest in rests])
    ours = np.asarray(js.tensions(scenario, settled))
    error = np.abs(ours / theirs - 1).max()
    sunk = np.abs(settled - positions).max()
    print(
        f"\nlargest relative error {error:.1e}; tensions {theirs.min():.1f} to"
        f" {theirs.max():.1f} N; load sank by up to {1e3 * sunk:.2f} mm"
    )

    assert max(rest.speed for rest in rests) < 1e-8
    assert max(rest.tilt for rest in rests) < 1e-6
    assert max(np.abs(rest.stretch).max() for rest in rests) < 1e-3
    assert theirs.min() > 0
    assert theirs.max() > 2 * theirs.min()
    np.testing.assert_allclose(ours, theirs, rtol=1e-7)
