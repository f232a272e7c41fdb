"""What can be proved: which quantity every line of the constraint report is about, as strips.

A new line of the report is proved by a new row in the table of these.
"""

from collections.abc import Callable
from functools import cached_property

import numpy as np

from jaxsusp.scenario.world import attachments_of
from jaxsusp.suspension.rigging import Rigging
from jaxsusp.verify.limits.arms import Arms
from jaxsusp.verify.limits.cables import Cables
from jaxsusp.verify.limits.passage import Passage
from jaxsusp.verify.limits.strips import Strip, norm, stacked


class System:
    """Everything that limits are about, over the intervals of one passage.

    Each part is worked out when a line first asks for it.
    """

    def __init__(self, passage: Passage):
        self.passage = passage

    @cached_property
    def cables(self) -> Cables:
        """What the cables carry."""
        return Cables(self.passage)

    @cached_property
    def arms(self) -> Arms:
        """Where the joints are."""
        return Arms(self.passage)

    def inside(self) -> Strip:
        """How far inside the workspace the load's centre is (m), (rows, 6)."""
        position, box = self.passage.position, self.passage.rigging.scenario.workspace
        sides = position - np.array(box.lower), -position + np.array(box.upper)
        return stacked([side[:, i] for side in sides for i in range(3)])

    def stretched(self) -> Strip:
        """How much shorter and longer cables are than given (m), (rows, 2 K)."""
        scenario = self.passage.rigging.scenario
        given = np.array([robot.end for robot in scenario.robots])
        hung = attachments_of(scenario) + scenario.task.start
        return _both_ways(self.cables.lengths - np.linalg.norm(given - hung, axis=1))

    def lifted(self) -> Strip:
        """How much lower and higher bases are than given (m), (rows, 2 K)."""
        given = np.array([robot.end[2] for robot in self.passage.rigging.scenario.robots])
        return _both_ways(self.passage.ends[..., 2] - given)


Quantity = Callable[[System], Strip]

OF_THE_LOAD: dict[str, Quantity] = {
    "inside the workspace": lambda system: system.inside(),
    "speed": lambda system: norm(system.passage.velocity)[:, None],
    "acceleration": lambda system: norm(system.passage.acceleration)[:, None],
    "jerk": lambda system: norm(system.passage.jerk)[:, None],
}
"""Of the load's centre, whatever it hangs on; one column, or several of which any may be worst."""

OF_CABLES: dict[str, Quantity] = {
    "tilt of the load": lambda system: system.cables.tilt,
    "least length": lambda system: system.cables.lengths,
    "greatest length": lambda system: system.cables.lengths,
    "greatest change of length": lambda system: system.stretched(),
    "least tension": lambda system: system.cables.tensions,
    "greatest tension": lambda system: system.cables.tensions,
    "ultimate tension T_lim": lambda system: system.cables.tensions,
    "tension ratio C_t": lambda system: system.cables.ratio,
    "stability factor S_c": lambda system: system.cables.stability,
    "speed of a cable": lambda system: _both_ways(system.cables.speeds),
}
"""Of cables that meet at a hook."""

OF_BASES: dict[str, Quantity] = {"lift of a base": lambda system: system.lifted()}
"""Of robots whose bases roll; their joints stay as they are."""

OF_ARMS: dict[str, Quantity] = {
    "joint speed": lambda system: _both_ways(_flat(system.arms.speeds)),
}
"""Of arms that move their ends."""

OF_ONE_ARM: dict[str, Quantity] = {
    "reach": lambda system: system.arms.distance,
    **{f"joint angle φ{i + 1}": lambda system, i=i: system.arms.angles[..., i] for i in range(3)},
}
"""Of one arm that moves its end, (rows, K)."""


def quantity_of(rigging: Rigging, name: str, about: str) -> Quantity | None:
    """What a line of the report is about, as something to be proved; None where there is no proof.

    Args:
        rigging: the system along its path.
        name: of the line.
        about: "robot 2" where the line is about one robot, whatever else otherwise.
    """
    found = dict(OF_THE_LOAD)
    if rigging.scenario.payload.attachments == "hook":
        found |= OF_CABLES
    if rigging.rolls:
        found |= OF_BASES
    elif rigging.moves:
        found |= OF_ARMS
        if name in OF_ONE_ARM:
            row, of_all = int(about.removeprefix("robot ")) - 1, OF_ONE_ARM[name]
            return lambda system: of_all(system)[:, row : row + 1]
    return found.get(name)


def stays(rigging: Rigging, name: str) -> bool:
    """Whether a line of the report is about something that is the same at every instant."""
    return name in OF_ONE_ARM and (rigging.rolls or not rigging.moves)


def _flat(strip: Strip) -> Strip:
    shape = len(strip.middle), -1
    return Strip(*(each.reshape(shape) for each in (strip.middle, strip.slope, strip.rest)))


def _both_ways(strip: Strip) -> Strip:
    """Sizes of what can have either sign: the worst of these and their opposites."""
    return Strip(
        np.concatenate([strip.middle, -strip.middle], axis=1),
        np.concatenate([strip.slope, -strip.slope], axis=1),
        np.concatenate([strip.rest, strip.rest], axis=1),
    )
