"""A concave mesh as convex pieces: approximate convex decomposition by CoACD (Wei et al., 2022).

CoACD cuts a closed mesh until what the hulls of its parts add is small, and puts the hulls back
together while they may be. Its pieces leave slits, about 1e-4 of the size, where it cut; ours are
larger by the first of `GROWN` with which it is proved that they hold the surface: every triangle is
divided until each part has its corners in one piece, which is convex and so holds all of it. The
same mesh gives the same pieces, which are kept for the next time (`jaxsusp cache`).
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

from jaxsusp._cache import cache_folder, code_digest, drop_oldest, used
from jaxsusp._files import atomic_path
from jaxsusp.geometry.meshes import MeshError, Surface, surface
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

_HALVINGS = 12  # of the sides of a triangle
_SEED = 0
MISSING = (
    'shape = "pieces" asks for the package coacd, which is not installed: '
    'pip install "jaxsusp[pieces]"'
)
_TOUCH = 1e-7  # of the size


def require_divisible(path: str | Path, pieces: int) -> None:
    """Refuse a mesh that has no inside, or is too large to be divided, or has nothing to divide it.

    Raises:
        MeshError: with what was found and what to do.
    """
    found, instead = surface(path), 'or give shape = "hull"'
    if len(found.faces) > TRIANGLES:
        raise MeshError(
            f"{path} has {len(found.faces):,} triangles, more than {TRIANGLES:,} that are divided "
            f"into pieces; reduce them in the program that it comes from, {instead}"
        )
    if edges := found.open_edges:
        raise MeshError(
            f"{path} is not closed, {edges} of its edges have a triangle on one side alone, so it "
            f"has no inside to be divided; close it in the program that it comes from, {instead}"
        )
    if (parts := len(_parts(found))) > pieces:
        raise MeshError(
            f"{path} has {parts} separate parts and pieces = {pieces}; allow at least one per "
            f"part, {instead}"
        )
    if not _version():
        raise MeshError(f"{MISSING}, {instead}")


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
    found: list[Polytope] = []
    for part, corners in zip(_parts(whole), _kept_or_made(whole, pieces), strict=True):
        size = float(part.extents.max())
        found += _holding(path, part, [hull_of(each, FACES) for each in corners], size)
    return tuple(body.placed(-whole.middle, 0.0) for body in found)


def _kept_or_made(whole: Surface, pieces: int) -> list[list[np.ndarray]]:
    """Corners of every piece of every part, from the cache or by CoACD."""
    digest = hashlib.sha256(whole.vertices.tobytes() + whole.faces.tobytes())
    digest.update(f"{pieces} {_version()} {code_digest('geometry')}".encode())
    folder = cache_folder("pieces")
    file = folder / f"{digest.hexdigest()[:32]}.npz" if folder else None
    if file and file.is_file():
        with suppress(OSError, ValueError, KeyError), np.load(file) as kept:
            found = [kept[f"arr_{i}"] for i in range(len(kept.files))]
            counts, rest = found[0], iter(found[1:])
            used(file)
            return [[next(rest) for _ in range(count)] for count in counts.tolist()]
    made = _made(_parts(whole), pieces)
    if file:
        with suppress(OSError):  # a full or read-only disk costs time next time only
            file.parent.mkdir(parents=True, exist_ok=True)
            arrays = [np.array([len(part) for part in made]), *(c for part in made for c in part)]
            with atomic_path(file) as scratch, open(scratch, "wb") as stream:
                np.savez(stream, *arrays)
            drop_oldest(file.parent)
    return made


def _made(parts: list[Surface], pieces: int) -> list[list[np.ndarray]]:
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


def _holding(path: str, part: Surface, bodies: list[Polytope], size: float) -> list[Polytope]:
    """Bodies larger by a little, of which it is proved that they hold a surface."""
    for share in GROWN:
        larger = [body.larger(share * size) for body in bodies] if share else bodies
        if held_by(larger, part.vertices[part.faces], _TOUCH * size):
            return larger
    raise MeshError(f'the pieces that were found for {path} leave parts of it out; give "hull"')


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
    """Connected parts of a surface."""
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
            found.append(Surface(merged.vertices[there], index.reshape(-1, 3)))
    return found


def _version() -> str:
    with suppress(importlib.metadata.PackageNotFoundError):
        return importlib.metadata.version("coacd")
    return ""


def _coacd() -> Any:
    try:
        return importlib.import_module("coacd")
    except ImportError as error:
        raise MeshError(MISSING) from error
