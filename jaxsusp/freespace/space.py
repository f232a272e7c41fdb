"""The free space of a scenario as frozen arrays, and as a file."""

import json
import os
from dataclasses import dataclass, field, fields, replace
from itertools import pairwise
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import xarray as xr
from jaxtyping import Bool, Float, Int

from jaxsusp._files import write_netcdf
from jaxsusp._showing import Shown
from jaxsusp.errors import InputError
from jaxsusp.freespace.ellipsoid import Ellipsoid
from jaxsusp.freespace.graph import center
from jaxsusp.freespace.iris import Region
from jaxsusp.freespace.polyhedra import HalfSpaces, Points, volume
from jaxsusp.freespace.polylines import length
from jaxsusp.scenario.ownunits import UNCHANGED, Frame

FORMAT = 4
"""Version of the file's layout."""

_DIMS: dict[str, tuple[str, ...]] = {
    "A": ("region", "face", "axis"),
    "b": ("region", "face"),
    "C": ("region", "axis", "unit"),
    "d": ("region", "axis"),
    "adjacency": ("region", "other"),
    "route": ("step",),
    "polyline": ("point", "axis"),
}


class Route(NamedTuple):
    """A locally shortest way."""

    polyline: Points  # from start to goal, m
    regions: tuple[int, ...]  # that hold it, in order
    length: float  # m
    bends: tuple[str, ...]  # round or past what it goes, and on which side

    def stated(self, frame: Frame) -> "Route":
        """The same way with numbers as a frame makes them."""
        return self._replace(
            polyline=frame.place(self.polyline), length=frame.number(self.length, "m")
        )


@dataclass(frozen=True, eq=False)
class FreeSpace(Shown):
    """Convex regions of load positions in which the load and all cables are clear (Eq. 23).

    Where the ends of the cables move, for the load alone.

    Arrays are read-only. Polytopes {p : A p <= b} are padded with rows 0 p <= 1. Regions stay
    0.1 mm away from every warning area. `route` and `polyline` are empty and `bound` is infinite
    where no way from start to goal was found; `reason` then says so.
    """

    A: Float[np.ndarray, "regions faces 3"]
    b: Float[np.ndarray, "regions faces"]  # m
    C: Float[np.ndarray, "regions 3 3"]  # {C u + d : ‖u‖ <= 1}, m
    d: Float[np.ndarray, "regions 3"]  # m
    adjacency: Bool[np.ndarray, "regions regions"]  # which polytopes intersect
    route: Int[np.ndarray, " steps"]  # indices of regions from start to goal
    polyline: Float[np.ndarray, "points 3"]  # the shortest on the route, m
    bound: float  # no polyline through this sequence of regions is shorter, m
    coverage: float  # share of free positions that lie in a region, estimated by sampling
    reason: str = ""  # why there is no route
    details: dict[str, Any] = field(default_factory=dict)  # settings, counts, seconds
    bodies: tuple[HalfSpaces, ...] = ()  # what the regions keep clear of, in load positions
    body_names: tuple[str, ...] = ()
    routes: tuple[Route, ...] = ()  # distinct taut ways from start to goal, shortest first
    level: tuple[Points, ...] = ()  # ways near the start's height, not taut
    frame: Frame = UNCHANGED  # how numbers in the task's own units become these

    def __post_init__(self):
        for each in fields(self):
            if isinstance(value := getattr(self, each.name), np.ndarray):
                value.setflags(write=False)

    def __repr__(self) -> str:
        task = f"route of {self.length:.4g} m" if self.connected else "start and goal not connected"
        return f"<FreeSpace: {len(self.d)} regions cover {100 * self.coverage:.1f} %, {task}>"

    @property
    def connected(self) -> bool:
        """Whether a route from start to goal was found."""
        return len(self.route) > 0

    @property
    def length(self) -> float:
        """Length of the polyline (m); infinite without one."""
        return length(self.polyline) if self.connected else np.inf

    @property
    def centerline(self) -> Float[np.ndarray, "points 3"]:
        """The roomy way along the route, by the centres of its crossings (m)."""
        regions = [self.regions[i].polytope for i in self.route]
        middle = [center(one & two) for one, two in pairwise(regions)]
        return np.array([*self.polyline[:1], *middle, *self.polyline[-1:]]).reshape(-1, 3)

    @property
    def regions(self) -> list[Region]:
        """Polytopes without the padding, and ellipsoids."""
        real = np.abs(self.A).sum(axis=2) > 0
        return [
            Region(HalfSpaces(A[rows], b[rows]), Ellipsoid(C, d))
            for A, b, rows, C, d in zip(self.A, self.b, real, self.C, self.d, strict=True)
        ]

    @property
    def volumes(self) -> Float[np.ndarray, "regions 2"]:
        """Volumes (m³) of every polytope and of its ellipsoid."""
        return np.array(
            [(volume(r.polytope, r.ellipsoid.d), r.ellipsoid.volume) for r in self.regions]
        ).reshape(-1, 2)

    def contains(self, points: Float[np.ndarray, "*batch 3"]) -> Bool[np.ndarray, "*batch"]:
        """Which load positions (m) lie in a region."""
        points = np.asarray(points, np.float64)
        inside = np.zeros(points.shape[:-1], bool)
        for region in self.regions:
            rest = ~inside
            inside[rest] = region.polytope.excess(points[rest]) <= 0
        return inside

    @property
    def own(self) -> "FreeSpace":
        """The same space in the task's own units and frame."""
        return self if self.frame == UNCHANGED else self.stated(self.frame.inverse, UNCHANGED)

    def stated(self, frame: Frame, now: Frame | None = None) -> "FreeSpace":
        """The same space with numbers as a frame makes them; they then are in units of `now`."""
        if frame == UNCHANGED:
            return self

        def moved(A: np.ndarray, b: np.ndarray) -> np.ndarray:
            real = np.abs(A).sum(axis=-1) > 0  # others only fill up
            return np.where(real, frame.length * b + A @ np.array(frame.origin), b)

        return replace(
            self,
            b=moved(self.A, self.b),
            C=frame.number(self.C, "m"),
            d=frame.place(self.d),
            polyline=frame.place(self.polyline),
            bound=frame.number(self.bound, "m"),
            bodies=tuple(HalfSpaces(each.A, moved(each.A, each.b)) for each in self.bodies),
            routes=tuple(each.stated(frame) for each in self.routes),
            level=tuple(map(frame.place, self.level)),
            frame=frame if now is None else now,
        )

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write one NetCDF-4 file, atomically; `load_free_space` reads it back exactly.

        Raises:
            InputError: the place cannot be written.
        """
        write_netcdf(_to_dataset(self), path)


def assemble(regions: list[Region], **others: Any) -> FreeSpace:
    """A free space from regions, padded to a common number of half-spaces."""
    faces = max((len(region.polytope.b) for region in regions), default=0)
    A, b = np.zeros((len(regions), faces, 3)), np.ones((len(regions), faces))
    for i, region in enumerate(regions):
        A[i, : len(region.polytope.b)] = region.polytope.A
        b[i, : len(region.polytope.b)] = region.polytope.b
    return FreeSpace(
        A=A,
        b=b,
        C=np.array([_symmetric(region.ellipsoid.C) for region in regions]).reshape(-1, 3, 3),
        d=np.array([region.ellipsoid.d for region in regions]).reshape(-1, 3),
        **others,
    )


def load_free_space(path: str | os.PathLike[str]) -> FreeSpace:
    """Read what `FreeSpace.save` wrote, exactly as it was.

    Raises:
        InputError: the file is missing, damaged, or of another layout.
    """
    path, remedy = Path(path), "give a file that `jaxsusp freespace` wrote"
    if not path.is_file():
        raise InputError(f"{path}: no such file; {remedy}")
    try:
        with xr.open_dataset(path, engine="h5netcdf", phony_dims="access") as stored:
            return _from_dataset(stored.load())
    except Exception as error:  # a damaged file can raise anything
        raise InputError(f"{path}: is not a saved free space ({error}); {remedy}") from error


def _to_dataset(space: FreeSpace) -> xr.Dataset:
    variables = {name: (dims, getattr(space, name)) for name, dims in _DIMS.items()}
    faces = [np.column_stack([body.A, body.b]) for body in space.bodies]
    variables["body_faces"] = (("body_face", "entry"), np.concatenate([np.empty((0, 4)), *faces]))
    variables["body_sizes"] = (("body",), np.array([len(each) for each in faces], int))
    attributes = {
        "format": FORMAT,
        "bound": space.bound,
        "coverage": space.coverage,
        "reason": space.reason,
        "details": json.dumps(space.details),
        "body_names": json.dumps(space.body_names),
        "routes": json.dumps([[each.polyline.tolist(), *each[1:]] for each in space.routes]),
        "level": json.dumps([line.tolist() for line in space.level]),
        "frame": json.dumps(space.frame),
    }
    return xr.Dataset(variables, attrs=attributes)


def _from_dataset(ds: xr.Dataset) -> FreeSpace:
    if not 2 <= ds.attrs["format"] <= FORMAT:
        raise ValueError(f"its format is {ds.attrs['format']}, this version reads 2 to {FORMAT}")
    arrays: dict[str, Any] = {
        name: ds[name].transpose(*dims).values for name, dims in _DIMS.items()
    }
    for name in "AbCd":
        if not np.isfinite(arrays[name]).all():
            raise ValueError(f"{name} has numbers that are not finite")
    arrays |= _bodies(ds) | _ways(ds) if ds.attrs["format"] > 2 else {}
    return FreeSpace(
        **arrays,
        bound=float(ds.attrs["bound"]),
        coverage=float(ds.attrs["coverage"]),
        reason=str(ds.attrs["reason"]),
        details=json.loads(ds.attrs["details"]),
    )


def _bodies(ds: xr.Dataset) -> dict[str, Any]:
    """Bodies of several sizes from one table of faces."""
    tables = np.split(ds["body_faces"].values, np.cumsum(ds["body_sizes"].values)[:-1])
    bodies = tuple(HalfSpaces(table[:, :3], table[:, 3]) for table in tables if len(table))
    return {"bodies": bodies, "body_names": tuple(json.loads(ds.attrs["body_names"]))}


def _ways(ds: xr.Dataset) -> dict[str, Any]:
    found = (
        Route(np.array(line), tuple(regions), length, tuple(bends))
        for line, regions, length, bends in json.loads(ds.attrs["routes"])
    )
    level = (np.array(line) for line in json.loads(ds.attrs["level"]))
    length, mass, origin = json.loads(ds.attrs.get("frame", json.dumps(UNCHANGED)))
    frame = Frame(length, mass, tuple(origin))
    return {"routes": tuple(found), "level": tuple(level), "frame": frame}


def _symmetric(C: np.ndarray) -> np.ndarray:
    """The symmetric C ≥ 0 of Eq. 23 that describes the same ellipsoid: (C Cᵀ)^½."""
    axes, lengths, _ = np.linalg.svd(C)
    return (axes * lengths) @ axes.T
