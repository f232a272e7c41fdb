"""Meshes from files: what they are, and the convex bodies that stand for them.

A file gives way to its bounding box, the paper's surround box, to its convex hull, or to convex
pieces (`geometry.pieces`).
"""

import functools
import os
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from jaxsusp._types import Float, Int
from jaxsusp.geometry.polytopes import FACES, Polytope, hull_of


class MeshError(ValueError):
    """A file that does not give a usable mesh."""


class Surface(NamedTuple):
    """The triangles of a file, all of its parts together, in the file's unit."""

    vertices: Float[np.ndarray, "vertices xyz"]  # in an STL file, three for every triangle
    faces: Int[np.ndarray, "faces corners=3"]

    @property
    def lower(self) -> np.ndarray:
        """The lowest corner of the bounding box."""
        return self.vertices.min(axis=0)

    @property
    def extents(self) -> np.ndarray:
        """Full size of the bounding box; zero where the mesh is flat."""
        return np.ptp(self.vertices, axis=0)

    @property
    def middle(self) -> np.ndarray:
        """The centre of the bounding box."""
        return self.lower + self.extents / 2

    @property
    def merged(self) -> "Surface":
        """The same triangles, corners at one place taken as one, none of them twice in one."""
        places, index = np.unique(self.vertices, axis=0, return_inverse=True)
        faces = index.reshape(-1)[self.faces]
        proper = (faces != np.roll(faces, 1, axis=1)).all(axis=1)
        return Surface(places, faces[proper])

    @property
    def open_edges(self) -> int:
        """Edges that triangles do not go along as often in the one sense as in the other."""
        merged = self.merged
        edges = merged.faces[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2)
        key = edges.min(axis=1) * len(merged.vertices) + edges.max(axis=1)
        _, of = np.unique(key, return_inverse=True)
        turns = np.bincount(of, np.where(edges[:, 0] < edges[:, 1], 1.0, -1.0))
        return int((turns != 0).sum())

    @property
    def volume(self) -> float:
        """What a closed surface encloses."""
        a, b, c = (self.vertices - self.middle)[self.faces].transpose(1, 0, 2)
        return float(abs((a * np.cross(b, c)).sum()) / 6)


def surface(path: str | Path) -> Surface:
    """The triangles of a mesh file; the last few files are remembered while they do not change.

    Raises:
        MeshError: the file is missing, unreadable, empty or holds non-finite coordinates.
    """
    if not os.path.isfile(path):
        raise MeshError(f"there is no file {path}")
    stat = os.stat(path)
    return _surface(str(path), stat.st_mtime_ns, stat.st_size)


def bounding_box(path: str | Path, scale: float = 1.0) -> np.ndarray:
    """Full extents of a mesh along its own axes, every part of the file taken together.

    Args:
        path: a file in any format trimesh reads (STL, OBJ, PLY, OFF, glTF, …).
        scale: factor from the file's unit to metres.

    Returns:
        Full extents (3,) in m, float64; a flat mesh has a zero among them.

    Raises:
        MeshError: the file is missing, unreadable, empty or holds non-finite coordinates.
    """
    with np.errstate(all="ignore"):
        extents = scale * surface(path).extents
    if not np.isfinite(extents).all():
        raise MeshError(f"{path} has coordinates that are not finite numbers")
    return extents


def hull(path: str | Path, scale: float = 1.0, faces: int = FACES) -> Polytope:
    """The convex hull of a mesh about the centre of its bounding box (m), see `polytopes.hull_of`.

    Raises:
        MeshError: as for `bounding_box`.
    """
    bounding_box(path, scale)
    stat = os.stat(path)
    return _hull(str(path), faces, stat.st_mtime_ns, stat.st_size).scaled(scale)


def body_of(size: Any, file: str | None, scale: float | None, yaw_deg: float) -> Polytope:
    """A load: a box of a full size, or the hull of a mesh, about its bounding box's middle (m).

    Args:
        size: of the box; None: there is a file.
        file: a mesh file.
        scale: factor from the file's unit to metres; None: 1.
        yaw_deg: angle about the vertical axis.

    Raises:
        MeshError: as for `bounding_box`.
    """
    if size is not None:
        corners = np.stack(np.meshgrid(*[[-0.5, 0.5]] * 3), axis=-1).reshape(-1, 3)
        found = hull_of(corners * np.array(size, np.float64))
    else:
        found = hull(str(file), 1.0 if scale is None else scale, LOAD_FACES)
    return found.placed((0.0, 0.0, 0.0), yaw_deg)


LOAD_FACES = 24
"""Most faces of a load that is a mesh's hull."""


@functools.lru_cache(maxsize=16)
def _hull(path: str, faces: int, *_: int) -> Polytope:
    found = surface(path)
    return hull_of(found.vertices - found.middle, faces)


@functools.lru_cache(maxsize=4)
def _surface(path: str, *_: int) -> Surface:
    mesh = _load(path)
    vertices = np.asarray(mesh.vertices, np.float64).reshape(-1, 3)
    faces = np.asarray(mesh.faces, np.int64).reshape(-1, 3)
    if not len(faces):
        raise MeshError(f"{path} holds no mesh")
    if not np.isfinite(vertices).all():
        raise MeshError(f"{path} has coordinates that are not finite numbers")
    used = np.zeros(len(vertices), bool)
    used[faces] = True
    found = Surface(vertices[used], (np.cumsum(used) - 1)[faces])
    for array in found:
        array.setflags(write=False)
    return found


def _load(path: str) -> Any:
    import trimesh  # takes a while to import, and most scenarios hold no mesh

    try:
        # Unprocessed: clean-up would drop vertices that are not finite without a word.
        scene = trimesh.load_scene(path, process=False)
        if scene.bounds is None:
            raise MeshError(f"{path} holds no mesh")
        return scene.to_mesh()
    except MeshError:
        raise
    except Exception as error:  # each format's parser fails in its own way
        reason = (str(error).splitlines() or [type(error).__name__])[0]
        raise MeshError(f"{path} cannot be read as a mesh: {reason}") from error
