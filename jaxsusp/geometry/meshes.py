"""Mesh obstacles: a file gives way to its bounding box, the paper's surround box."""

import os
from pathlib import Path

import numpy as np


class MeshError(ValueError):
    """A file that does not give a usable mesh."""


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
    bounds = _load(path).bounds
    if bounds is None:
        raise MeshError(f"{path} holds no mesh")
    with np.errstate(all="ignore"):
        extents = scale * (np.asarray(bounds[1], np.float64) - bounds[0])
    if not np.isfinite(extents).all():
        raise MeshError(f"{path} has coordinates that are not finite numbers")
    return extents


def hull_points(path: str | Path, scale: float = 1.0) -> np.ndarray:
    """Vertices of a mesh about the centre of its bounding box (m), (vertices, 3).

    All of them, whose convex hull stands for the mesh; a flat mesh has none of its own.

    Raises:
        MeshError: as for `bounding_box`.
    """
    bounding_box(path, scale)
    scene = _load(path)
    vertices = np.asarray(scene.to_mesh().vertices, np.float64)
    return scale * (vertices - np.mean(scene.bounds, axis=0))


def _load(path: str | Path):
    import trimesh  # takes a while to import, and most scenarios hold no mesh

    if not os.path.isfile(path):
        raise MeshError(f"there is no file {path}")
    try:
        # Unprocessed: clean-up would drop vertices that are not finite without a word.
        return trimesh.load_scene(path, process=False)
    except Exception as error:  # each format's parser fails in its own way
        reason = (str(error).splitlines() or [type(error).__name__])[0]
        raise MeshError(f"{path} cannot be read as a mesh: {reason}") from error
