"""The constraint report: all of Eq. 22 with numbers, on the real curve of a plan."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from jaxsusp._types import Float
from jaxsusp.mechanics.statics import GRAVITY
from jaxsusp.problem.constraints import WORKSPACE_TOLERANCE
from jaxsusp.scenario.ownunits import PAYLOAD, Frame
from jaxsusp.scenario.scenario import Scenario
from jaxsusp.scenario.world import attachments_of
from jaxsusp.suspension.cableloads import Loads, cable_loads
from jaxsusp.suspension.rigging import Rigging
from jaxsusp.trajectory.timelaw import Motion
from jaxsusp.verify.certificate import ROUNDING, TOLERANCE, Certificate
from jaxsusp.verify.limits.proof import Bound, Line, prove
from jaxsusp.verify.limits.quantities import quantity_of, stays

INSTANTS = 2001
"""Times at which everything but the distances is computed: every 20 ms of a 40 s plan."""

STRETCH = 1e-3
"""m by which a length (or a base's height) that its drive mode keeps may change between the
points of a path: what a cable of 1e5 N/m stretches under 100 N."""

JOINT_SPEED = 90.0
"""Degrees per second that joints of moving arms may turn with where `limits.joint_speed_deg` says
nothing. Ours: the paper gives no number, and heavy arms are hardly faster."""

TURN = "turn of the load from level"
"""Name of the check that a level load is near its equilibrium."""

RATIO = "tension ratio C_t"
"""Name of the check of least to greatest tension, which is never above 1 by what it is."""


class Check(NamedTuple):
    """One line of the report."""

    name: str
    value: float
    low: float  # -inf where there is no lower limit
    high: float
    unit: str
    time: float | None  # s, when the value occurs; None where it does not depend on time
    about: str  # which body, cable or robot; "" for the whole system
    slack: float = 0.0  # how far beyond a limit rounding may be
    proved: bool = False  # that the limit is kept at every instant, not only where it was looked at
    bound: float | None = None  # what the value is proved never to go beyond

    def stated(self, frame: Frame) -> "Check":
        """The same line with numbers as a frame makes them."""
        numbers = ["value", "low", "high", "slack", *["bound"] * (self.bound is not None)]
        changed = {name: frame.number(getattr(self, name), self.unit) for name in numbers}
        time = None if self.time is None else frame.number(self.time, "s")
        return self._replace(**changed, time=time)

    @property
    def margin(self) -> float:
        """Distance to the nearer limit; negative where it is broken, NaN where nothing is known."""
        return float(np.minimum(self.value - self.low, self.high - self.value))

    @property
    def ok(self) -> bool:
        """Whether the limit is kept (NaN is not)."""
        return self.margin >= -self.slack

    @property
    def kept(self) -> str:
        """Whether the limit is kept, and how that is known."""
        if not self.ok:
            return "broken"
        return "proved" if self.proved else "sampled"

    @property
    def limit(self) -> str:
        """The limit in words."""
        if np.isinf(self.low):
            return f"at most {self.high:.5g} {self.unit}".rstrip()
        if np.isinf(self.high):
            return f"at least {self.low:.5g} {self.unit}".rstrip()
        return f"{self.low:.5g} to {self.high:.5g} {self.unit}".rstrip()

    @property
    def reason(self) -> str:
        """What is wrong, as a sentence."""
        about = f" of {self.about}" if self.about else ""
        when = "" if self.time is None else f" at {self.time:.2f} s"
        value = f"{self.value:.5g} {self.unit}".rstrip()
        return f"{self.name}{about} is {value}{when}, allowed is {self.limit}"


def sampled_report(
    rigging: Rigging, certificate: Certificate, times: Float[np.ndarray, "times"] | None = None
) -> tuple[Check, ...]:
    """Every limit of Eq. 22 on the real curve at given times (s), by default `INSTANTS` of them.

    Tensions are those with inertia; they must keep T_lo and T_hi, and their peak is compared with
    the ultimate tension T_lim = k_a T_hi as well. At a hook the posture is level by plan; what is
    reported is the tilt at which a hanging load would ride the planned acceleration. With separate
    attachments it is the equilibrium posture, which has to exist, to be near level, and stable.
    Only distances are proved.

    Args:
        rigging: the system along its path.
        certificate: distances.
        times: when to look.
    """
    scenario, law = rigging.scenario, rigging.law
    times = np.linspace(0, law.duration, INSTANTS) if times is None else times
    motion, ends = law.at(times), rigging.ends_at(law.parameter(times))
    loads = cable_loads(scenario, motion.position, motion.acceleration, ends)
    limits = scenario.limits
    low, high = limits.tension
    ultimate = limits.safety_factor * high
    balance = _ratio(loads.tensions.min(axis=1), loads.tensions.max(axis=1))
    inf = np.inf
    checks = [
        *_posture(scenario, loads, motion, ends, times),
        *_distances(certificate),
        _of_cable("length", loads.lengths, times, min, limits.cable_length[0], inf, "m"),
        _of_cable("length", loads.lengths, times, max, -inf, limits.cable_length[1], "m"),
        *_kept(rigging, loads.lengths, ends, times),
        _of_cable("tension", loads.tensions, times, min, low, inf, "N"),
        _of_cable("tension", loads.tensions, times, max, -inf, high, "N"),
        _of_cable("ultimate tension T_lim", loads.tensions, times, max, -inf, ultimate, "N"),
        extreme(RATIO, balance, times, min, 0.0, 1.0, "")._replace(slack=-1e-12),
        extreme("stability factor S_c", loads.stability, times, min, limits.stability, inf, ""),
        *_inside(scenario, motion.position, times),
        *_task(scenario, motion.position, times),
        *_robots(rigging, ends, times),
    ]
    return tuple(checks)


def with_proofs(rigging: Rigging, checks: Sequence[Check]) -> tuple[Check, ...]:
    """Lines with a proof that they are kept at every instant, where there is one.

    A line that gets worse between the instants that were looked at has the value and the time then.

    Args:
        rigging: the system along its path, in own units.
        checks: lines of a report; those of which `limits.quantities` knows nothing stay as they
            are.
    """
    lines: list[Line] = []
    of: list[int] = []
    for index, check in enumerate(checks):
        quantity = quantity_of(rigging, check.name, check.about)
        if quantity is None or not check.ok:
            continue
        sides = [(1.0, check.low), (-1.0, check.high)]
        for sign, limit in sides[:1] if check.name == RATIO else sides:
            if np.isfinite(limit):
                lines.append(Line(quantity, sign, limit, check.slack, check.value))
                of.append(index)
    found: dict[int, list[Bound]] = {}
    for index, bound in zip(of, prove(rigging, lines), strict=True):
        found.setdefault(index, []).append(bound)
    known: list[Check] = []
    for index, check in enumerate(checks):
        if index in found:
            known.append(_with(check, found[index], rigging.cables))
        elif check.ok and (stays(rigging, check.name) or check.name.startswith("distance off")):
            known.append(check._replace(proved=True, bound=check.value))  # nothing is between
        else:
            known.append(check)
    return tuple(known)


def _with(check: Check, sides: Sequence[Bound], cables: int) -> Check:
    """A line with what was found about its one or two sides."""
    for side in sides:
        if side.time is not None:
            of_cables = check.about.startswith("cable ")
            about = f"cable {side.column % cables + 1}" if of_cables else check.about
            worse = check._replace(value=side.worst, time=side.time, about=about)
            check = worse if worse.margin < check.margin else check
    if not (check.ok and all(side.proved for side in sides)):
        return check
    lower = check.value - check.low <= check.high - check.value  # the limit that is nearer
    bound = next((side.value for side in sides if (side.sign > 0) == lower), sides[0].value)
    return check._replace(proved=True, bound=bound)


def _posture(scenario: Scenario, loads: Loads, motion: Motion, ends, times) -> list[Check]:
    """How the load hangs."""
    position, acceleration = motion.position, motion.acceleration
    limit, inf = scenario.limits.posture_deg, np.inf
    if scenario.payload.attachments == "hook":
        sideways = np.linalg.norm(acceleration[:, :2], axis=1)
        tilt = np.rad2deg(np.arctan2(sideways, GRAVITY + acceleration[:, 2]))
        return [extreme("tilt of the load", tilt, times, max, -inf, limit, "°")]
    turn = np.where(loads.balanced, np.rad2deg(loads.turn), np.nan)
    missing = np.where(loads.balanced, 0.0, loads.missing)
    through = _cables_in_load(scenario, loads.posture, position, ends).astype(float)
    return [
        extreme(TURN, turn, times, max, -inf, limit, "°"),
        _of_cable("share of a cable in its load", through, times, max, -inf, 0.0, "")._replace(
            name="share of a cable in its load"
        ),
        extreme("moment that no tension balances", missing, times, max, -inf, 0.0, "N m"),
        extreme("stiffness of the equilibrium", loads.stiffness, times, min, 0.0, inf, "N/m"),
    ]


def _cables_in_load(scenario: Scenario, posture, position, ends) -> np.ndarray:
    """Share of every cable that is inside the load it carries, at every instant (times, K).

    Seen in the load's own frame, where it is an upright cylinder; a millimetre does not count.
    """
    payload, skin = scenario.payload, 1e-3
    radius, half = max(payload.radius - skin, 0.0), max(payload.height / 2 - skin, 0.0)
    start = np.broadcast_to(attachments_of(scenario), ends.shape)
    way = np.einsum("tji,tkj->tki", posture, ends - position[:, None]) - start
    with np.errstate(divide="ignore", invalid="ignore"):
        caps = (np.array([-half, half]) - start[..., 2:]) / way[..., 2:]
        a = (way[..., :2] ** 2).sum(axis=-1)
        b = (way[..., :2] * start[..., :2]).sum(axis=-1)
        c = (start[..., :2] ** 2).sum(axis=-1) - radius**2
        root = np.sqrt(b**2 - a * c)  # NaN: beside the cylinder
        inside = np.where(c < 0, np.inf, np.nan)  # of a cable that runs along the axis
        enter = np.where(a > 0, (-b - root) / a, -inside)
        leave = np.where(a > 0, (-b + root) / a, inside)
        low = np.maximum.reduce([caps.min(axis=-1), enter, np.zeros_like(a)])
        high = np.minimum.reduce([caps.max(axis=-1), leave, np.ones_like(a)])
    return np.nan_to_num(np.maximum(high - low, 0.0))


def _kept(rigging: Rigging, lengths: np.ndarray, ends: np.ndarray, times) -> list[Check]:
    """What a drive mode does not change: cable lengths, and the heights of bases."""
    scenario, inf = rigging.scenario, np.inf
    if scenario.drive not in ("end", "base"):
        return []
    given = np.array([robot.end for robot in scenario.robots])
    hung = attachments_of(scenario) + scenario.task.start
    change = np.abs(lengths - np.linalg.norm(given - hung, axis=1))
    checks = [_of_cable("change of length", change, times, max, -inf, STRETCH, "m")]
    if scenario.drive == "base":
        lifted = np.abs(rigging.bases_at(ends)[..., 2] - rigging.bases[:, 2])
        at, k = np.unravel_index(int(lifted.argmax()), lifted.shape)
        value, about = float(lifted[at, k]), f"robot {k + 1}"
        checks.append(
            Check("lift of a base", value, -inf, STRETCH, "m", float(times[at]), about, 1e-9)
        )
    return checks


def _distances(certificate: Certificate) -> list[Check]:
    """The clearances of the certificate; kinds of which there is no pair are left out."""
    checks = [
        Check(
            f"distance of {each.kind}", each.value, each.required, np.inf, "m", each.time,
            " and ".join(each.bodies), ROUNDING,
        )
        for each in certificate.clearances
        if each.bodies[0]
    ]  # fmt: skip
    return [
        check._replace(
            proved=True, bound=max(check.value - TOLERANCE, check.low - ROUNDING)
        )
        if check.ok and certificate.finished
        else check
        for check in checks
    ]  # fmt: skip


def slack(unit: str, most: float = np.inf) -> float:
    """How far beyond a limit rounding may be; a millionth at most of one of speed or tilt."""
    least = min(1e-9, 1e-6 * (most or np.inf))
    return {"m": ROUNDING, "N": 1e-6 * PAYLOAD * GRAVITY}.get(unit, least)


def extreme(name, values, times, which, low, high, unit, about="") -> Check:
    """The worst of a quantity over time; a NaN is the worst of all."""
    at, beyond = int(np.argmin(values) if which is min else np.argmax(values)), slack(unit, high)
    return Check(name, float(values[at]), low, high, unit, float(times[at]), about, beyond)


def _of_cable(name, values, times, which, low, high, unit) -> Check:
    """The worst of a quantity over time and cables."""
    flat = int(np.argmin(values) if which is min else np.argmax(values))
    at, k = np.unravel_index(flat, values.shape)
    word = "least" if which is min else "greatest"
    about = f"cable {k + 1}"
    return Check(f"{word} {name}" if "ultimate" not in name else name, float(values[at, k]),
                 low, high, unit, float(times[at]), about, slack(unit))  # fmt: skip


def _inside(scenario: Scenario, position: np.ndarray, times: np.ndarray) -> list[Check]:
    """How far inside its workspace the load's centre stays."""
    box = scenario.workspace
    inside = np.minimum(position - box.lower, box.upper - position)
    return [
        extreme(
            "inside the workspace", inside.min(axis=1), times, min,
            -WORKSPACE_TOLERANCE, np.inf, "m", "load",
        )
    ]  # fmt: skip


def _task(scenario: Scenario, position: np.ndarray, times: np.ndarray) -> list[Check]:
    """Whether the plan begins at the start and ends at the goal."""
    found, inf = [], np.inf
    for name, row, place in (("start", 0, scenario.task.start), ("goal", -1, scenario.task.goal)):
        off, when = float(np.linalg.norm(position[row] - place)), float(times[row])
        found.append(Check(f"distance off the {name}", off, -inf, 1e-6, "m", when, "load"))
    return found


def _robots(rigging: Rigging, ends: np.ndarray, times: np.ndarray) -> list[Check]:
    """Reach and joint angles of every robot, each where it is nearest to its limits."""
    checks, scenario = [], rigging.scenario
    joints = np.rad2deg(rigging.joints_at(ends))
    distance = np.linalg.norm(ends - rigging.shoulders_at(ends), axis=-1)
    near, far = np.abs(rigging.links[:, 1] - rigging.links[:, 2]), rigging.links[:, 1:].sum(axis=1)

    def worst(name, values, low, high, unit, k) -> Check:
        margin = np.minimum(values - low, high - values)
        at = int(margin.argmin())
        time = float(times[at]) if rigging.moves else None
        return Check(name, float(values[at]), low, high, unit, time, f"robot {k + 1}", slack(unit))

    for k in range(rigging.cables):
        checks.append(worst("reach", distance[:, k], float(near[k]), float(far[k]), "m", k))
    if rigging.moves and not rigging.rolls:
        speeds = np.abs(np.gradient(joints, times, axis=0)).max(axis=2)
        k, most = int(speeds.max(axis=0).argmax()), scenario.limits.joint_speed_deg or JOINT_SPEED
        about = f"robot {k + 1}"
        checks.append(extreme("joint speed", speeds[:, k], times, max, -np.inf, most, "°/s", about))
    limits = scenario.limits.joint_limits_deg
    if limits is not None:
        for k in range(rigging.cables):
            for i, (low, high) in enumerate(limits[k if len(limits) > 1 else 0]):
                checks.append(worst(f"joint angle φ{i + 1}", joints[:, k, i], low, high, "°", k))
    return checks


def _ratio(low: np.ndarray, high: np.ndarray) -> np.ndarray:
    return np.where(high > 0, low / np.where(high > 0, high, 1), 0.0)
