"""The load of a scenario file, the base of its tables, and how a table names a mesh file."""

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import (
    BaseModel,
    ConfigDict,
    Discriminator,
    Field,
    Tag,
    field_validator,
    model_validator,
)

from jaxsusp.geometry.meshes import MeshError, body_of
from jaxsusp.geometry.polytopes import Polytope
from jaxsusp.scenario.messages import RefusalError
from jaxsusp.scenario.quantities import LARGEST, Lengths, Number, Point, Positive

Attachments = Annotated[
    Annotated[Literal["hook"], Tag("hook")] | Annotated[tuple[Point, ...], Tag("list")],
    Discriminator(lambda given: "hook" if isinstance(given, str) else "list"),
]


class Section(BaseModel):
    """A table of the file. The description of a field is the remedy an error names."""

    model_config = ConfigDict(frozen=True, extra="forbid", validate_default=True)


def anchored(file: Any, info: Any) -> str:
    """A path, from the scenario's folder on, so that it survives a copy elsewhere."""
    # `info` is a pydantic ValidationInfo, a protocol that no run-time checker can check.
    if not file:
        raise RefusalError("is empty")
    return os.path.abspath(os.path.join((info.context or {}).get("folder", ""), file))


@contextmanager
def mesh_of_use() -> Iterator[None]:
    """Tell of a mesh file that is no good in the words of a table's field."""
    try:
        yield
    except MeshError as error:
        raise RefusalError(f"cannot be used ({error.problem})", error.remedy) from error


class Payload(Section):
    """The load: an upright cylinder, a box or a mesh's hull, positioned by its centre."""

    mass: Positive = Field(description="the mass in kg")
    radius: Positive = Field(description="the radius in m, of a cylinder; else left out")
    height: Positive = Field(description="the height in m, of a cylinder; else left out")
    size: Lengths | None = Field(
        default=None, description="the full size [x, y, z] in m of a load that is a box"
    )
    file: str | None = Field(
        default=None,
        description="the path of a mesh file, relative to the scenario file: the load is its hull",
    )
    scale: Positive | None = Field(
        default=None, description="the factor from the unit of that file to metres"
    )
    yaw_deg: Number | None = Field(
        default=None, description="the angle in degrees of box or mesh about the vertical axis"
    )
    attachments: Attachments = Field(
        default="hook", description='"hook", or one [x, y, z] in m from the centre per cable'
    )
    center_of_mass: Point = Field(
        default=(0.0, 0.0, 0.0), description="the offset [x, y, z] in m from the centre"
    )

    @model_validator(mode="before")
    @classmethod
    def _with_cylinder_around(cls, given: Any, info: Any) -> Any:
        """A box or a mesh states the upright cylinder around itself, for all that asks for one.

        What is wrong with the size or the file itself, their own fields say.
        """
        if not isinstance(given, dict):
            return given
        size, file = given.get("size"), given.get("file")
        if size is None and file is None:
            alone = [key for key in ("scale", "yaw_deg") if given.get(key) is not None]
            if alone:
                wrong = f"states {' and '.join(alone)}, and no size or file to go with"
                raise RefusalError(wrong, "leave that out, or give size or file")
            return given
        if size is not None and file is not None:
            raise RefusalError("states size and file", "leave one of them out")
        given = dict(given)
        if file is not None and given.get("scale") is None:
            given["scale"] = 1.0
        try:
            path = None if file is None else anchored(file, info)
            with np.errstate(all="ignore"):
                body = body_of(size, path, 1.0, 0.0).scaled(float(given.get("scale") or 1.0))
            radius = float(np.hypot(*body.corners[:, :2].T).max())
            cylinder = {"radius": radius, "height": 2 * float(body.corners[:, 2].max())}
        except (TypeError, ValueError, RuntimeError):  # the last one, of qhull
            cylinder = {}
        for key in ("radius", "height"):
            own = cylinder.get(key, np.nan)
            own = min(own, LARGEST) if own > 0 else 1.0
            stated = given.setdefault(key, own)
            if cylinder and isinstance(stated, float | int) and abs(stated - own) > 1e-6 * own:
                wrong = f"states {key}, which a load with size or file has by itself"
                raise RefusalError(wrong, "leave it out")
        return given

    @field_validator("file")
    @classmethod
    def _resolved(cls, file: str | None, info: Any) -> str | None:
        if file is None:
            return None
        path = anchored(file, info)
        with mesh_of_use():
            body_of(None, path, 1.0, 0.0)
        return path

    @property
    def words(self) -> str:
        """Its shape and size in a few words."""
        if self.size is not None:
            return f"box of {' × '.join(f'{side:g}' for side in self.size)} m"
        size = f"{self.radius:g} × {self.height:g} m"
        return size if self.file is None else f"hull of {Path(self.file).name} in {size}"

    @property
    def body(self) -> Polytope | None:
        """The load about its centre, turned by its yaw; None: it is an upright cylinder."""
        if self.size is None and self.file is None:
            return None
        return body_of(self.size, self.file, self.scale, self.yaw_deg or 0.0)
