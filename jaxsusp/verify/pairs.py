"""All bodies of a plan, spanned by points that move along its path, and the pairs to be checked.

A cable or a link is a segment between two points with a radius, the load an upright cylinder
about a point, an obstacle stands still. Every point is w · (load's centre) + s · (end of a cable) +
constant, so that its velocity and a bound of its acceleration follow from those of the two
splines; only the elbow of an arm that moves is not, see `verify.elbow`.
"""

from itertools import combinations
from typing import Any, NamedTuple

import numpy as np

from jaxsusp._types import Float
from jaxsusp.scenario.world import attachments_of, load_of, warning_shape
from jaxsusp.suspension.armclearance import NEAR_END
from jaxsusp.suspension.rigging import Rigging
from jaxsusp.verify.bodies import Body, GroundShape, HullShape, named_shapes
from jaxsusp.verify.elbow import elbow

NEAR_HOOK = 0.1
"""Share of a cable's length, from its lower end, that is not checked against other cables where
they share a hook: there they come together by construction."""

KINDS = (
    "load to obstacles",
    "cables to obstacles",
    "load to arms",
    "cables to arms",
    "cables to each other",
    "arms to obstacles",
    "arms to each other",
    "ends to each other",
    "cables to their own links",
    "arms to themselves",
    "load to the ground",
    "cables to the ground",
    "links to the ground",
)
"""What is measured, in the order of the report."""

PARTS = ("column", "upper link", "lower link")


class Pair(NamedTuple):
    """Two bodies that keep a distance."""

    one: int
    other: int
    kind: int  # of `KINDS`
    required: float  # m


class System:
    """The bodies and pairs of one plan.

    With separate attachments the load turns by up to the posture limit: load and cables then take
    the room of every such turn (`scenario.world.warning_shape`).

    Args:
        rigging: the system along its path.
    """

    def __init__(self, rigging: Rigging):
        scenario, cables = rigging.scenario, range(rigging.cables)
        self.rigging = rigging
        self._points: list[tuple[float, float, int, np.ndarray, int]] = []
        self.bodies: list[Body] = []
        nowhere = self._point()
        assert nowhere == 0
        obstacles = [
            self._body(name, obstacle=shape)
            for i, obstacle in enumerate(scenario.obstacles, start=1)
            for name, shape in named_shapes(obstacle, obstacle.name or f"obstacle {i}")
        ]
        shape = warning_shape(scenario)
        center = self._point(along=1.0)
        faces = load_of(scenario)
        load = self._body(
            "load", center, center, shape.radius, shape.half_height,
            load=None if faces is None else HullShape(faces.corners),
        )  # fmt: skip
        upper = [self._on_cable(k, 1.0) for k in cables]
        lower = [self._on_cable(k, 0.0) for k in cables]
        lines = [
            self._body(f"cable {k + 1}", lower[k], upper[k], shape.cable_radius) for k in cables
        ]
        arms = [self._arm(k, upper[k]) for k in cables]
        ends = [self._body(f"end of robot {k + 1}", upper[k], upper[k]) for k in cables]
        apart = lines
        if scenario.payload.attachments == "hook":
            apart = [
                self._body(
                    f"cable {k + 1}", self._on_cable(k, NEAR_HOOK), upper[k], shape.cable_radius
                )
                for k in cables
            ]
        held = [
            self._body(
                f"cable {k + 1}", lower[k], self._on_cable(k, 1 - NEAR_END), shape.cable_radius
            )
            for k in cables
        ]
        gap, separation = scenario.limits.clearance, scenario.limits.separation
        links = [(k, part, body) for k in cables for part, body in enumerate(arms[k])]
        held_up = [body for _, part, body in links if part]  # columns stand on the ground
        ground = scenario.ground_height
        grounds = [] if ground is None else [self._body("ground", obstacle=GroundShape(ground))]
        pairs = [
            *(Pair(load, each, 0, gap) for each in obstacles),
            *(Pair(line, each, 1, gap) for line in lines for each in obstacles),
            *(Pair(load, body, 2, gap) for _, _, body in links),
            *(  # a cable begins at the end of its own arm's lower link
                Pair(lines[k], body, 3, gap)
                for k in cables
                for j, part, body in links
                if (j, part) != (k, 2)
            ),
            *(Pair(other, one, 4, 0.0) for one, other in combinations(apart, 2)),
            *(Pair(body, each, 5, gap) for each in obstacles for _, _, body in links),
            *(
                Pair(other, one, 6, separation)
                for (j, _, one), (k, _, other) in combinations(links, 2)
                if j != k
            ),
            *(Pair(other, one, 7, separation) for one, other in combinations(ends, 2)),
            *(Pair(held[k], arms[k][2], 8, 0.0) for k in cables),
            *(Pair(arm[2], arm[0], 9, 0.0) for arm in arms),
            *(
                Pair(body, each, kind, gap)
                for each in grounds
                for kind, bodies in enumerate(([load], lines, held_up), 10)
                for body in bodies
            ),
        ]
        self.pairs = pairs
        along, share, track, constant, elbow_of = zip(*self._points, strict=True)
        self.along, self.share = np.array(along), np.array(share)
        self.track, self.elbow_of = np.array(track), np.array(elbow_of)
        self._constant = np.array(constant)

    @property
    def moves(self) -> np.ndarray:
        """Which points move."""
        return (self.along != 0) | (self.share != 0) | (self.elbow_of >= 0)

    def locate(
        self, center: Float[np.ndarray, "rows xyz"], ends: Float[np.ndarray, "rows cables xyz"]
    ) -> Float[np.ndarray, "rows points xyz"]:
        """All points for places of the load and of the ends (m)."""
        found = self.rates(center, ends) + self._constant
        rig, elbows = self.rigging, np.flatnonzero(self.elbow_of >= 0)
        if len(elbows):
            known = elbow(rig.shoulders_at(ends), rig.links, ends, rig.elbow_up)
            found[:, elbows] = known[:, self.elbow_of[elbows]]
        return found

    def rates(
        self, center: Float[np.ndarray, "rows xyz"], ends: Float[np.ndarray, "rows cables xyz"]
    ) -> Float[np.ndarray, "rows points xyz"]:
        """The same combinations of velocities; zero for elbows."""
        return self.along[:, None] * center[:, None] + self.share[:, None] * ends[:, self.track]

    def _point(self, along=0.0, share=0.0, track=0, at: Any = (0, 0, 0), elbow_of=-1) -> int:
        self._points.append((along, share, track, np.array(at, np.float64), elbow_of))
        return len(self._points) - 1

    def _body(self, *content: Any, **more: Any) -> int:
        self.bodies.append(Body(*content, **more))
        return len(self.bodies) - 1

    def _on_cable(self, k: int, share: float) -> int:
        """A point of cable k, at a share of its way from attachment to end."""
        rig = self.rigging
        lower = (1 - share) * attachments_of(rig.scenario)[k]
        if rig.moves:
            return self._point(1 - share, share, k, lower)
        return self._point(1 - share, at=lower + share * rig.end_path[0, k])

    def _arm(self, k: int, end: int) -> list[int]:
        """Column, upper and lower link of one robot."""
        rig, robot = self.rigging, self.rigging.scenario.robots[k]
        chain = rig.chains_at(rig.ends_at(np.array(rig.law.path.span[:1])))[0, k]
        if rig.rolls:
            points = [self._point(share=1.0, track=k, at=at - chain[3]) for at in chain[:3]]
        else:
            points = [self._point(at=at) for at in chain[:2]]
            joint = {"elbow_of": k} if rig.moves else {"at": chain[2]}
            points.append(self._point(**joint))
        radii = robot.column_radius, robot.link_radius, robot.link_radius
        return [
            self._body(f"{name} of robot {k + 1}", *span, radius)
            for name, span, radius in zip(
                PARTS, zip(points, [*points[1:], end], strict=True), radii, strict=True
            )
        ]
