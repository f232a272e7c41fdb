"""The tables and keys of a scenario file, each with its type, default and description.

A `Statement` is what the file says and no more. What must hold between its values is looked at by
`admissible`; a `Scenario` is a statement that passed. SI units, degrees where a name ends in
`_deg`; world frame, z up.
"""

from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import (
    AfterValidator,
    Discriminator,
    Field,
    Tag,
    field_validator,
)

from jaxsusp.geometry.meshes import bounding_box, hull
from jaxsusp.geometry.pieces import PIECES, pieces_of, require_divisible
from jaxsusp.geometry.polytopes import Polytope
from jaxsusp.mechanics.drives import Drive
from jaxsusp.scenario.messages import RefusalError
from jaxsusp.scenario.payload import Payload, Section, anchored, mesh_of_use
from jaxsusp.scenario.quantities import (
    Lengths,
    NonNegative,
    NonNegativeRange,
    Number,
    Point,
    Positive,
    Range,
    Weights,
)


class Limits(Section):
    """The bounds of Eq. 22."""

    tension: NonNegativeRange = Field(
        default=(1.0, 100.0), description="the least and greatest tension of a cable in N"
    )
    cable_length: NonNegativeRange = Field(
        default=(0.5, 15.0), description="the least and greatest length of a cable in m"
    )
    posture_deg: Positive = Field(
        default=10.0, le=180, description="the greatest tilt of the load in degrees"
    )
    clearance: NonNegative = Field(
        default=0.05, description="the width in m of the warning area around obstacles"
    )
    cable_radius: Positive = Field(default=0.01, description="the radius of a cable in m")
    stability: NonNegative = Field(
        default=0.0, le=1, description="the least stability factor S_c, from 0 (no limit) to 1"
    )
    safety_factor: Number = Field(
        default=1.5,
        ge=1,
        description="the ultimate over the greatest tension of a cable, 1 or more",
    )
    separation: NonNegative = Field(
        default=0.5, description="the least distance in m between the ends and arms of two robots"
    )
    joint_limits_deg: tuple[tuple[Range, Range, Range], ...] | None = Field(
        default=None,
        description="three [low, high] pairs in degrees per robot, or once for all robots",
    )
    speed: Positive | None = Field(
        default=None, description="the greatest speed of the load in m/s"
    )
    acceleration: Positive | None = Field(
        default=None, description="the greatest acceleration of the load in m/s²"
    )
    jerk: Positive | None = Field(default=None, description="the greatest jerk of the load in m/s³")
    cable_speed: Positive | None = Field(
        default=None, description="the greatest speed in m/s at which a cable is let out or wound"
    )
    joint_speed_deg: Positive | None = Field(
        default=None, description="the greatest speed of a joint in degrees per second"
    )


class Workspace(Section):
    """The box in which the centre of the load may be."""

    lower: Point = Field(default=(-3.5, -3.5, 0.2), description="the lowest corner [x, y, z] in m")
    upper: Point = Field(default=(3.5, 3.5, 5.5), description="the highest corner [x, y, z] in m")


class Ground(Section):
    """A horizontal plane that load, cables and arms keep off; columns of robots stand on it."""

    height: Number = Field(description="the z of the ground in m")


class Task(Section):
    """What is to be done."""

    start: Point = Field(description="the first position [x, y, z] of the load in m")
    goal: Point = Field(description="the last position [x, y, z] of the load in m")
    duration: Positive = Field(default=40.0, description="the time for the motion in s")


class Robot(Section):
    """A towing robot and the nominal end of its cable."""

    base: Point = Field(description="the foot [x, y, z] of the column in m")
    links: Lengths = Field(description="the lengths of the column and of the two links in m")
    end: Point = Field(description="the upper end [x, y, z] of the cable in m")
    link_radius: Positive = Field(default=0.08, description="the radius of the links in m")
    column_radius: Positive = Field(default=0.12, description="the radius of the column in m")


class Box(Section):
    """An upright box turned about the vertical axis."""

    name: str = Field(default="", description="a name in quotes")
    kind: Literal["box"] = "box"
    center: Point = Field(description="the centre [x, y, z] in m")
    size: Lengths = Field(description="the full size [x, y, z] in m")
    yaw_deg: Number = Field(default=0.0, description="the angle about the vertical axis in degrees")


class Cylinder(Section):
    """A vertical cylinder."""

    name: str = Field(default="", description="a name in quotes")
    kind: Literal["cylinder"] = "cylinder"
    center: Point = Field(description="the centre [x, y, z] in m")
    radius: Positive = Field(description="the radius in m")
    height: Positive = Field(description="the full height in m")


class Sphere(Section):
    """A sphere."""

    name: str = Field(default="", description="a name in quotes")
    kind: Literal["sphere"] = "sphere"
    center: Point = Field(description="the centre [x, y, z] in m")
    radius: Positive = Field(description="the radius in m")


class Mesh(Section):
    """A mesh file, placed by the centre of its bounding box."""

    name: str = Field(default="", description="a name in quotes")
    kind: Literal["mesh"] = "mesh"
    center: Point = Field(description="the centre [x, y, z] of the bounding box in m")
    scale: Positive = Field(
        default=1.0, description="the factor from the unit of the file to metres"
    )
    yaw_deg: Number = Field(default=0.0, description="the angle about the vertical axis in degrees")
    shape: Literal["box", "hull", "pieces"] = Field(
        default="box",
        description='what stands for the mesh, its bounding "box", its convex "hull", or convex '
        '"pieces"',
    )
    pieces: int | None = Field(
        default=None, ge=1, le=256, description='the most convex pieces with shape = "pieces"'
    )
    file: str = Field(description="the path of a mesh file, relative to the scenario file")

    @field_validator("pieces")
    @classmethod
    def _of_use(cls, pieces: int | None, info: Any) -> int | None:
        if pieces is not None and info.data.get("shape", "pieces") != "pieces":
            remedy = 'give shape = "pieces", or leave it out'
            raise RefusalError(f'has no use with shape = "{info.data["shape"]}"', remedy)
        return pieces

    @field_validator("file")
    @classmethod
    def _resolved(cls, file: str, info: Any) -> str:
        path = anchored(file, info)
        with mesh_of_use():
            bounding_box(path)
            if info.data.get("shape") == "pieces":
                require_divisible(path, info.data.get("pieces") or PIECES)
        return path

    @property
    def path(self) -> Path:
        """The file, absolute."""
        return Path(self.file)

    @property
    def size(self) -> tuple[float, float, float]:
        """Full size of its bounding box (m)."""
        x, y, z = bounding_box(self.path, self.scale).tolist()
        return x, y, z

    @property
    def bodies(self) -> tuple[Polytope, ...]:
        """What stands for it where that is no box: convex bodies about its centre, not turned."""
        match self.shape:
            case "hull":
                return (hull(self.path, self.scale),)
            case "pieces":
                return pieces_of(self.path, self.scale, self.pieces or PIECES)
        return ()


def _three_or_more(robots: tuple[Robot, ...]) -> tuple[Robot, ...]:
    if len(robots) < 3:
        raise ValueError(f"has only {len(robots)} of at least three entries")
    return robots


Robots = Annotated[tuple[Robot, ...], AfterValidator(_three_or_more)]
Obstacle = Annotated[Box | Cylinder | Sphere | Mesh, Field(discriminator="kind")]


GroundChoice = Annotated[
    Annotated[Literal["none"], Tag("none")] | Annotated[Ground, Tag("table")],
    Discriminator(lambda given: "none" if isinstance(given, str) else "table"),
]


class Fitness(Section):
    """The coefficients of Eq. 21."""

    weights: Weights = Field(
        default=(1.0, 1.0, 1.0, 1.0, 1.0, 1.0), description="six weights, of the terms f1 to f6"
    )
    kappa: NonNegative = Field(default=1000.0, description="the penalty per collision or violation")


class Statement(Section):
    """What a scenario file states, table by table."""

    name: str = Field(min_length=1, description="a name in quotes")
    drive: Drive = Field(
        default="cable", description='the drive mode, "cable", "end", "base" or "hybrid"'
    )
    payload: Payload = Field(
        description="a [payload] table with mass and radius and height, or size, or file"
    )
    limits: Limits = Field(default=Limits(), description="a [limits] table")
    workspace: Workspace = Field(default=Workspace(), description="a [workspace] table")
    ground: GroundChoice | None = Field(
        default=None,
        description='a [ground] table with its height, or "none"; without it the ground is at the '
        "lowest base",
    )
    task: Task = Field(description="a [task] table with start and goal")
    fitness: Fitness = Field(default=Fitness(), description="a [fitness] table")
    robots: Robots = Field(
        description="one [[robots]] table with base, links and end per robot, three or more"
    )
    obstacles: tuple[Obstacle, ...] = Field(
        default=(),
        description="one [[obstacles]] table per box, cylinder, sphere or mesh, with its kind",
    )

    @property
    def ground_height(self) -> float | None:
        """The z of the ground (m); None where there is no ground."""
        if self.ground is None:
            return min(robot.base[2] for robot in self.robots)
        return self.ground.height if isinstance(self.ground, Ground) else None
