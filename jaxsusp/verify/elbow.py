"""Elbows of arms whose ends move, on the host: where they are, and how fast they can go.

An end that runs on a spline takes its elbow along a curve that is no polynomial, so the proofs of
the certificate need a bound of its speed that holds over a whole interval.
"""

import numpy as np

from jaxsusp._types import Bool, Float


def elbow(
    shoulder: Float[np.ndarray, "*#times cables xyz"],
    links: Float[np.ndarray, "cables joints"],
    ends: Float[np.ndarray, "times cables xyz"],
    up: Bool[np.ndarray, "cables"],
) -> Float[np.ndarray, "times cables xyz"]:
    """The joint between the two links (m): `mechanics.arm.elbow` of the inverse kinematics.

    An end out of reach gives the stretched or folded arm that points at it.
    """
    way = ends - shoulder
    level = np.hypot(way[..., 0], way[..., 1])
    distance = np.hypot(level, way[..., 2])
    _, a2, a3 = links.T
    bend = np.clip((distance**2 - a2**2 - a3**2) / (2 * a2 * a3), -1, 1)
    sine = np.where(up, 1, -1) * np.sqrt(1 - bend**2)
    polar = np.arctan2(level, way[..., 2]) - np.arctan2(a3 * sine, a2 + a3 * bend)
    heading = np.arctan2(way[..., 1], way[..., 0])
    out = np.sin(polar)
    direction = np.stack([out * np.cos(heading), out * np.sin(heading), np.cos(polar)], axis=-1)
    return shoulder + a2[:, None] * direction


def elbow_speed(
    shoulder: Float[np.ndarray, "*#times cables xyz"],
    links: Float[np.ndarray, "cables joints"],
    ends: Float[np.ndarray, "times cables xyz"],
    moved: Float[np.ndarray, "times cables"],
    speed: Float[np.ndarray, "times cables"],
) -> Float[np.ndarray, "times cables"]:
    """Upper bound of an elbow's speed while its end stays within a distance of a place.

    With D the end's distance from the shoulder and r its horizontal part, the upper link turns
    about the vertical by at most |v|/r, and in its own plane by at most |v|/D plus the rate of the
    angle β between link and line of sight, cos β = (a2² + D² - a3²)/(2 a2 D). Infinite where the
    arm could get stretched, folded, or over its own axis.

    Args:
        shoulder: top of the column (m).
        links: a1, a2, a3 (m).
        ends: where the end is (m).
        moved: how far from there it can be (m).
        speed: how fast it is at most.
    """
    way = ends - shoulder
    level = np.hypot(way[..., 0], way[..., 1]) - moved
    distance = np.linalg.norm(way, axis=-1)
    _, a2, a3 = links.T
    low, high = distance - moved, distance + moved
    fine = (low > np.abs(a2 - a3)) & (high < a2 + a3) & (low > 0) & (level > 0)
    low, high = np.where(fine, low, 1), np.where(fine, high, 1)
    # Both are monotone, or convex and positive, in D: greatest in size at an end of the interval.
    cosine = [(a2**2 + d**2 - a3**2) / (2 * a2 * d) for d in (low, high)]
    rate = [np.abs(1 - (a2**2 - a3**2) / d**2) / (2 * a2) for d in (low, high)]
    sine = np.sqrt(np.maximum(1 - np.square(cosine).max(axis=0), 1e-300))
    turn = 1 / low + 1 / np.where(fine, level, 1) + np.max(rate, axis=0) / sine
    return np.where(fine, a2 * speed * turn, np.inf)
