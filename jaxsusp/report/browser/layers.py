"""Convex bodies as triangles and edges: regions of free space and shadows of cables."""

from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np
from scipy.spatial import ConvexHull

from jaxsusp.freespace.polyhedra import Body, HalfSpaces, Points, corners_of, nearest_point
from jaxsusp.freespace.space import FreeSpace
from jaxsusp.report.browser.packing import packed

_INSIDE = 1e-5
"""Own units of length that a body's middle has to be from every face to be worth drawing."""


def region_layer(space: FreeSpace) -> dict[str, Any]:
    """The polytopes of a free space in own units, with the shortest polyline through them."""
    regions = [corners_of(region.polytope, region.ellipsoid.d) for region in space.regions]
    return {
        **_shape(regions),
        "count": len(regions),
        "route": packed(space.polyline) if space.connected else None,
        "told": _told(space),
    }


def body_layers(bodies: Sequence[Body], room: HalfSpaces) -> dict[str, Any]:
    """What keeps the load out, by whom: the load itself, and each cable.

    Args:
        bodies: of a scenario in own units, named as `freespace.bodies` names them.
        room: what of them is drawn.
    """
    found: dict[str, list[Points]] = {}
    for body in bodies:
        who = body.name.rpartition("(")[2].rstrip(")")
        corners = _within(body.faces, room)
        if corners is not None:
            found.setdefault(who, []).append(corners)
    return {who: _shape(parts) for who, parts in sorted(found.items())}


def triangles_of(corners: Points) -> dict[str, Any]:
    """Triangles of a convex body by its corners, counter-clockwise from outside."""
    return _shape([corners])["triangles"]


def _told(space: FreeSpace) -> str:
    parts = f"{len(space.d)} regions cover {100 * space.coverage:.1f} % of the free space"
    return parts if space.connected else f"{parts}. {space.reason}"


def _within(faces: HalfSpaces, room: HalfSpaces) -> Points | None:
    """Corners of the part of a body in a room; None where there is next to nothing."""
    both = faces & room
    middle = (room.b[:3] - room.b[3:]) / 2
    inside = nearest_point(HalfSpaces(both.A, both.b - _INSIDE), middle).point
    return None if inside is None else corners_of(both, inside)


def _shape(bodies: Iterable[Points]) -> dict[str, Any]:
    """Triangles (n, 3, 3), counter-clockwise from outside, and edges (m, 2, 3) of convex bodies.

    Qhull cuts faces into triangles: an edge is where two of them do not lie in one plane.
    """
    triangles, edges = [np.empty((0, 3, 3))], [np.empty((0, 2, 3))]
    for corners in bodies:
        hull = ConvexHull(corners)
        normals = hull.equations[:, :3]
        found = corners[hull.simplices]
        across = np.cross(found[:, 1] - found[:, 0], found[:, 2] - found[:, 0])
        inward = (across * normals).sum(axis=1) < 0
        found[inward] = found[inward, ::-1]
        triangles.append(found)
        for away in range(3):  # neighbour k is behind the edge that corner k is not on
            behind = hull.neighbors[:, away]
            bent = (normals * normals[behind]).sum(axis=1) < 1 - 1e-9
            once = bent & (np.arange(len(behind)) < behind)
            edges.append(corners[np.delete(hull.simplices, away, axis=1)[once]])
    return {
        "triangles": packed(np.concatenate(triangles)),
        "edges": packed(np.concatenate(edges)),
    }
