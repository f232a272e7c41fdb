"""A concave mesh as convex pieces: approximate convex decomposition by CoACD (Wei et al., 2022).

CoACD cuts a closed mesh until what the hulls of its parts add is small, and puts the hulls back
together while they may be; a part that is convex already is its own piece. CoACD's pieces leave
slits, about 1e-4 of the size, where it cut; ours are larger by the first of `GROWN` with which it
is proved that they hold the surface: every triangle is divided until each part has its corners in
one piece, which is convex and so holds all of it. The same mesh gives the same pieces, which are
kept for the next time (`jaxsusp cache`).
"""

import functools
import hashlib
import importlib
import importlib.metadata
import os
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

import numpy as np
from scipy.spatial import ConvexHull, QhullError

from jaxsusp._cache import cache_folder, code_digest, drop_oldest, used
from jaxsusp._files import atomic_path
from jaxsusp.geometry.meshes import EXPORT, MeshError, Surface, surface
from jaxsusp.geometry.polytopes import Polytope, hull_of

PIECES = 16
"""Most pieces where nothing is said."""

FACES = 32
"""Most faces of a piece, before its edges are bevelled."""

TRIANGLES = 200_000
"""Most triangles that are divided into pieces: more take minutes."""

GROWN = (0.0, 0.001, 0.002, 0.005, 0.01, 0.02)
"""Shares of its size by which the pieces of a part are larger on every side: the first that will
do."""

CONCAVITY = 0.05
"""CoACD's threshold: how far a hull may be off its part, as it measures that."""

MISSING = 'shape = "pieces" asks for the package coacd, which is not installed'
INSTALL = 'pip install ".[pieces]" in a copy of the repository'

_HALVINGS = 12  # of the sides of a triangle
_SEED = 0
_TOUCH = 1e-7  # of the size
_AS_CONVEX = 1e-6  # of a hull's volume


def require_divisible(path: str | Path, pieces: int) -> None:
    """Refuse a mesh that has no inside, or is too large to be divided, or has nothing to divide it.

    Raises:
        MeshError: with what was found and what to do.
    """
    found, instead = surface(path), 'or give shape = "hull"'
    if len(found.faces) > TRIANGLES:
        raise MeshError(
            f"{path} has {len(found.faces):,} triangles, more than {TRIANGLES:,} that are divided "
            "into pieces",
            f"reduce them in the program that it comes from, {instead}",
        )
    if edges := found.open_edges:
        raise MeshError(
            f"{path} is not closed, {edges} of its edges have a triangle on one side alone, so it "
            "has no inside to be divided",
            f"close it in the program that it comes from, {instead}",
        )
    if not (parts := len(_parts(found))):
        raise MeshError(f"{path} has no inside: each of its triangles is but a line", EXPORT)
    if parts > pieces:
        raise MeshError(
            f"{path} has {parts} separate parts and pieces = {pieces}",
            f"allow at least one per part, {instead}",
        )
    if not _version():
        raise MeshError(MISSING, f"{INSTALL}, {instead}")


def pieces_of(path: str | Path, scale: float = 1.0, pieces: int = PIECES) -> tuple[Polytope, ...]:
    """Convex pieces that hold a closed mesh, about the centre of its bounding box (m).

    Args:
        path: a mesh file.
        scale: factor from the file's unit to metres.
        pieces: the most that there may be.

    Raises:
        MeshError: as `require_divisible`, or without the package `coacd`.
    """
    stat = os.stat(path)
    found = _pieces(str(path), pieces, stat.st_mtime_ns, stat.st_size)
    return tuple(body.scaled(scale) for body in found)


@functools.lru_cache(maxsize=16)
def _pieces(path: str, pieces: int, *_: int) -> tuple[Polytope, ...]:
    require_divisible(path, pieces)
    whole = surface(path)
    parts, file = _parts(whole), _kept_at(whole, pieces)
    found = _kept(file, parts, pieces) if file else None
    if found is None:
        made = _made(parts, pieces)
        if (found := _bodies(parts, made)) is None:
            raise MeshError(
                f"the pieces that were found for {path} leave parts of it out",
                'give shape = "hull"',
            )
        if file:
            _keep(file, made)
    return tuple(body.placed(-whole.middle, 0.0) for body in found)


Corners = list[list[np.ndarray]]
"""Corners of every piece of every part."""


def _kept_at(whole: Surface, pieces: int) -> Path | None:
    digest = hashlib.sha256(whole.vertices.tobytes() + whole.faces.tobytes())
    digest.update(f"{pieces} {_version()} {code_digest('geometry')}".encode())
    folder = cache_folder("pieces")
    return folder / f"{digest.hexdigest()[:32]}.npz" if folder else None


def _kept(file: Path, parts: list[Surface], pieces: int) -> list[Polytope] | None:
    """What was made before; None where nothing is kept, or what is no such pieces."""
    if not file.is_file():
        return None
    # Whatever is in a damaged file, and however its reader fails: pieces are made anew.
    with suppress(Exception), open(file, "rb") as stream, np.load(stream) as kept:
        counts, *corners = [kept[f"arr_{i}"] for i in range(len(kept.files))]
        fit = counts.shape == (len(parts),) and counts.min() > 0
        fit = fit and counts.sum() == len(corners) <= pieces
        if fit and all(_are_corners(each) for each in corners):
            ends = np.cumsum(counts)
            rows = [corners[end - count : end] for end, count in zip(ends, counts, strict=True)]
            used(file)
            return _bodies(parts, rows)
    return None


def _are_corners(found: np.ndarray) -> bool:
    plain = found.dtype == np.float64 and found.ndim == 2 and found.shape[1] == 3
    return bool(plain and len(found) and np.isfinite(found).all())


def _keep(file: Path, made: Corners) -> None:
    with suppress(OSError):  # a full or read-only disk costs time next time only
        file.parent.mkdir(parents=True, exist_ok=True)
        arrays = [np.array([len(part) for part in made]), *(c for part in made for c in part)]
        with atomic_path(file) as scratch, open(scratch, "wb") as stream:
            np.savez(stream, *arrays)
        drop_oldest(file.parent)


def _made(parts: list[Surface], pieces: int) -> Corners:
    """Divide every part; where that gives too many in all, again with fewer each."""
    most = [pieces - len(parts) + 1] * len(parts)
    found = [_divided(part, many) for part, many in zip(parts, most, strict=True)]
    counts = [len(each) for each in found]
    if sum(counts) <= pieces:
        return found
    fewer = list(counts)
    while sum(fewer) > pieces:
        fewer[int(np.argmax(fewer))] -= 1
    return [
        each if few == count else _divided(part, few)
        for part, each, few, count in zip(parts, found, fewer, counts, strict=True)
    ]


def _divided(part: Surface, most: int) -> list[np.ndarray]:
    if _is_convex(part):
        return [part.vertices]
    coacd = _coacd()
    coacd.set_log_level("error")
    size, middle = float(part.extents.max()), part.middle
    mesh = coacd.Mesh((part.vertices - middle) / size, part.faces.astype(np.int32))
    with _one_thread(coacd):
        found = coacd.run_coacd(
            mesh, threshold=CONCAVITY, max_convex_hull=most, preprocess_mode="off", seed=_SEED
        )
    ordered = sorted((np.unique(corners, axis=0) for corners, _ in found), key=lambda c: c.tolist())
    return [middle + size * corners for corners in ordered]


@contextmanager
def _one_thread(coacd: Any) -> Iterator[None]:
    """Threads would draw from CoACD's one random generator in any order."""
    openmp: Any = getattr(coacd, "_lib", None)
    known = hasattr(openmp, "omp_set_num_threads") and hasattr(openmp, "omp_get_max_threads")
    before = openmp.omp_get_max_threads() if known else 0
    if known:
        openmp.omp_set_num_threads(1)
    try:
        yield
    finally:
        if known:
            openmp.omp_set_num_threads(before)


def _is_convex(part: Surface) -> bool:
    """Whether a part fills its hull, or is flat, so that its corners are its one piece."""
    unit = (part.vertices - part.middle) / part.extents.max()
    try:
        hull = ConvexHull(unit)
    except QhullError:
        return True
    own = Surface(unit, part.faces).volume
    return abs(hull.volume - own) <= _AS_CONVEX * hull.volume


def _bodies(parts: list[Surface], corners: Corners) -> list[Polytope] | None:
    """Pieces of all parts; None where there is no proof that they hold them."""
    found: list[Polytope] = []
    for part, each in zip(parts, corners, strict=True):
        size = float(part.extents.max())
        held = _holding(part, [hull_of(piece, FACES) for piece in each], size)
        if held is None:
            return None
        found += held
    return found


def _holding(part: Surface, bodies: list[Polytope], size: float) -> list[Polytope] | None:
    """Bodies larger by a little, of which it is proved that they hold a surface."""
    for share in GROWN:
        larger = [body.larger(share * size) for body in bodies] if share else bodies
        if held_by(larger, part.vertices[part.faces], _TOUCH * size):
            return larger
    return None


def held_by(bodies: list[Polytope], triangles: np.ndarray, beyond: float = 0.0) -> bool:
    """Whether it is proved that bodies hold all of some triangles (n, 3, 3).

    Args:
        bodies: convex ones.
        triangles: in their unit.
        beyond: what may stand out, for rounding.
    """
    for _ in range(_HALVINGS):
        whole = np.zeros(len(triangles), bool)
        for body in bodies:
            room = (body.offsets - triangles @ body.normals.T).min(axis=2)
            whole |= (room >= -beyond).all(axis=1)
        triangles = triangles[~whole]
        if not len(triangles):
            return True
        a, b, c = triangles.transpose(1, 0, 2)
        ab, bc, ca = (a + b) / 2, (b + c) / 2, (c + a) / 2
        quarters = ((a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca))
        triangles = np.concatenate([np.stack(each, axis=1) for each in quarters])
        if len(triangles) > 1_000_000:
            return False
    return False


def _parts(whole: Surface) -> list[Surface]:
    """Connected parts of a surface, with triangles that look outwards.

    A part that is turned inside out is turned back: CoACD would make shards of it. The wall of a
    cavity is one such part, so that the cavity is filled, which is on the safe side.
    """
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    merged = whole.merged
    one, other = merged.faces[:, [0, 1]].ravel(), merged.faces[:, [1, 2]].ravel()
    count = len(merged.vertices)
    links = coo_array((np.ones(len(one), bool), (one, other)), shape=(count, count))
    number, label = connected_components(links, directed=False)
    found = []
    for part in range(number):
        faces = merged.faces[label[merged.faces[:, 0]] == part]
        if len(faces):
            there, index = np.unique(faces, return_inverse=True)
            own = Surface(merged.vertices[there], _once(index.reshape(-1, 3)))
            found.append(own if own.signed_volume >= 0 else own.turned)
    return found


def _once(faces: np.ndarray) -> np.ndarray:
    """Triangles of a part that is in the file several times over, once each: CoACD hangs on it."""
    first = faces.argmin(axis=1)[:, None]
    same = np.take_along_axis(faces, (first + np.arange(3)) % 3, axis=1)
    found, counts = np.unique(same, axis=0, return_counts=True)
    return found if counts.min() == counts.max() > 1 else faces


def _version() -> str:
    with suppress(importlib.metadata.PackageNotFoundError):
        return importlib.metadata.version("coacd")
    return ""


def _coacd() -> Any:
    try:
        return importlib.import_module("coacd")
    except ImportError as error:
        raise MeshError(MISSING, INSTALL) from error
