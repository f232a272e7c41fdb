"""Meshes from files: what they are, and the convex bodies that stand for them.

A file gives way to its bounding box, the paper's surround box, to its convex hull, or to convex
pieces (`geometry.pieces`).
"""

import functools
import os
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from scipy.spatial import QhullError

from jaxsusp._types import Float, Int
from jaxsusp.geometry.polytopes import FACES, Polytope, hull_of


class MeshError(ValueError):
    """A file that does not give a usable mesh: what is wrong with it, and what to do if known."""

    def __init__(self, problem: str, remedy: str = ""):
        super().__init__(problem, remedy)
        self.problem = problem
        self.remedy = remedy

    def __str__(self) -> str:
        return "; ".join(filter(None, (self.problem, self.remedy)))


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
    def signed_volume(self) -> float:
        """What a closed surface encloses; negative where its triangles look inwards."""
        a, b, c = (self.vertices - self.middle)[self.faces].transpose(1, 0, 2)
        return float((a * np.cross(b, c)).sum() / 6)

    @property
    def volume(self) -> float:
        """What a closed surface encloses, whichever way its triangles look."""
        return abs(self.signed_volume)

    @property
    def turned(self) -> "Surface":
        """The same triangles, looking the other way."""
        return Surface(self.vertices, self.faces[:, ::-1])

    @property
    def overlaps(self) -> bool:
        """Whether a closed surface is seen to go around some place twice, or the wrong way.

        It is looked for along `LINES` upright lines, so a small place may go unseen. The volume of
        such a surface counts that place twice, or takes it away.
        """
        size = self.extents
        if not size.all():
            return False
        corners = ((self.vertices - self.lower) / size)[self.faces]  # (faces, 3, 3)
        x, y = corners[..., 0], corners[..., 1]
        left, right, front, back = x.min(axis=1), x.max(axis=1), y.min(axis=1), y.max(axis=1)
        turns = {0}
        for place in np.arange(1, LINES + 1)[:, None] * _SCATTER % 1:
            near = (left <= place[0]) & (right >= place[0])
            near = near & (front <= place[1]) & (back >= place[1])
            turns |= _turns(corners[near], place)
        return max(turns) - min(turns) > 1


def _turns(corners: np.ndarray, place: np.ndarray) -> set[int]:
    """How often a surface goes around the stretches of an upright line between its triangles."""
    flat = corners[..., :2] - place
    after = np.roll(flat, -1, axis=1)
    areas = flat[..., 0] * after[..., 1] - flat[..., 1] * after[..., 0]  # of (line, corner, next)
    met = (areas > 0).all(axis=1) | (areas < 0).all(axis=1)
    areas, whole = areas[met], areas[met].sum(axis=1)
    across = np.roll(areas, -1, axis=1) / whole[:, None]  # a corner's weight: the edge across
    heights = (across * corners[met][..., 2]).sum(axis=1)
    order = np.argsort(heights)
    apart = np.diff(heights[order], append=np.inf) > _APART
    turns = -np.cumsum(np.sign(whole[order]).astype(int))
    return set(turns[apart].tolist())


def surface(path: str | Path) -> Surface:
    """The triangles of a mesh file; the last few files are remembered while they do not change.

    Raises:
        MeshError: the file is missing, unreadable, empty, holds non-finite coordinates or is but
            one point.
    """
    if os.path.isdir(path):
        raise MeshError(f"{path} is a folder", "give a mesh file in it")
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
        MeshError: as for `surface`.
    """
    return scale * surface(path).extents


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

LINES = 200
"""Upright lines along which a surface is looked at for places that it goes around twice."""

FORMATS = "STL, OBJ, PLY, OFF or glTF"
"""What is read as installed."""

EXPORT = f"export it anew as {FORMATS}"

_PACKAGES = {
    ".3mf": ["networkx", "lxml"],
    ".3dxml": ["networkx", "lxml"],
    ".dae": ["pycollada"],
    ".zae": ["pycollada"],
    ".step": ["cascadio"],
    ".stp": ["cascadio"],
}
"""Packages that trimesh's reader of a format asks for."""

_GUESSES = "charset_normalizer"
_APART = 1e-5  # of the height; what is nearer is a wall that two parts share, but for rounding
_FARTHEST = 1e100  # of a coordinate: the cube of what is farther may leave float64
_SCATTER = np.array([0.7548776662466927, 0.5698402909980532])  # of points spread evenly in a square


@functools.lru_cache(maxsize=16)
def _hull(path: str, faces: int, *_: int) -> Polytope:
    found = surface(path)
    try:
        return hull_of(found.vertices - found.middle, faces)
    except QhullError as error:
        raise MeshError(f"{path} has no convex hull that can be computed") from error


@functools.lru_cache(maxsize=4)
def _surface(path: str, *_: int) -> Surface:
    mesh = _load(path)
    vertices = np.asarray(mesh.vertices, np.float64).reshape(-1, 3)
    faces = np.asarray(mesh.faces, np.int64).reshape(-1, 3)
    if not len(faces):
        raise MeshError(f"{path} holds no mesh")
    if faces.min() < 0 or faces.max() >= len(vertices):
        raise MeshError(f"{path} has triangles whose corners are not in it", EXPORT)
    if not (np.abs(vertices) <= _FARTHEST).all():  # or any is nan
        raise MeshError(f"{path} has coordinates that are not finite numbers", EXPORT)
    used = np.zeros(len(vertices), bool)
    used[faces] = True
    found = Surface(vertices[used], (np.cumsum(used) - 1)[faces])
    if not found.extents.any():
        raise MeshError(f"{path} is but one point: all corners of its triangles are there", EXPORT)
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
        raise _unreadable(path, error) from error


def _unreadable(path: str, error: Exception) -> MeshError:
    """What a reader's own words mean to the person whose file it is."""
    suffix, begun = Path(path).suffix, f"{path} cannot be read as a mesh"
    missing = isinstance(error, ImportError) and (
        _PACKAGES.get(suffix.lower()) or [_package_of(error)]
    )
    if isinstance(error, NotImplementedError):
        kind = f"{suffix} is no format that is read" if suffix else "its name has no suffix"
        return MeshError(f"{begun}: {kind}", f"give a file of {FORMATS}, with its suffix")
    if missing and missing != [_GUESSES]:
        asked = f"{suffix} asks for {'packages' if len(missing) > 1 else 'a package'} more"
        return MeshError(
            f"{begun}: {asked}", f"pip install {' '.join(missing)}, or export it as {FORMATS}"
        )
    if missing:  # it was to guess how the text is encoded
        reason = "in another format, or text that is not UTF-8"
    else:
        said = (str(error).splitlines() or [type(error).__name__])[0].rstrip(".!")
        reason = f'or in another format (its reader said "{said}")'
    return MeshError(f"{begun}: as {suffix} it is damaged, {reason}", EXPORT)


def _package_of(error: ImportError) -> str:
    """The package that a reader lacks; one of trimesh's says only how to install it."""
    return (error.name or str(error).split()[-1].strip("`'")).partition(".")[0]
