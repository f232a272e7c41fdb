"""Are limits that are proved kept, and are limits that are kept proved? Random motions tell.

python experiments/proofs.py --motions 1000

Every motion is looked at densely, at 20,001 instants. A limit that its worst value there keeps by a
little more than 1 % has to be proved; one that it breaks by a millionth must not be, whatever 2,001
instants say.
"""

import argparse
import time
from typing import NamedTuple

import numpy as np
from scipy.interpolate import BPoly, PPoly

import jaxsusp as js
from jaxsusp.optim.devices import configure
from jaxsusp.planning.waypoints import sample_path
from jaxsusp.suspension.rigging import Rigging, ends_beside
from jaxsusp.trajectory.smoothpath import SmoothPath
from jaxsusp.trajectory.timelaw import TimeLaw
from jaxsusp.verify.certificate import Certificate
from jaxsusp.verify.constraints import RATIO, Check, sampled_report
from jaxsusp.verify.limits.proof import Bound, Line, prove
from jaxsusp.verify.limits.quantities import quantity_of

SYSTEMS = ("scenario-1", "six-robots", "four-robots", "end-driven", "base-driven", "hybrid")
"""Systems that motions are drawn for, in turn: the first for every second one."""

DENSE = 20_001
SPARE, BROKEN = 0.0101, 1e-6
"""By how much of itself a limit is kept, or broken."""

SPARES = {"joint speed": 0.02, "greatest change of length": 0.1}
"""As SPARE, of speeds, which the report takes from differences, and of what is hardly above zero:
then a share of a millimetre."""

NO_DISTANCES = Certificate(True, (), (), 0)


class Outcome(NamedTuple):
    """What became of the limits of one motion."""

    kept: list[str]  # that have to be proved
    refused: list[str]  # of these, not proved
    between: list[str]  # of these, broken between the dense instants: found, and true
    broken: list[str]  # that must not be proved
    wrong: list[str]  # of these, proved


def random_motion(seed: int) -> Rigging:
    """A motion of one of the systems: waypoints, duration and time law are drawn."""
    rng = np.random.default_rng(seed)
    name = SYSTEMS[0] if seed % 2 else SYSTEMS[seed // 2 % len(SYSTEMS)]
    scenario = js.load_scenario(name).own
    task, box = scenario.task, scenario.workspace
    start, goal = np.array(task.start), np.array(task.goal)
    waypoints = start + np.linspace(0, 1, 7)[1:-1, None] * (goal - start)
    waypoints += rng.normal(size=(5, 3)) * rng.choice([0.1, 0.4, 1.0])
    path = sample_path(scenario, np.clip(waypoints, box.lower, box.upper), 40)
    duration = task.duration * rng.uniform(0.5, 2)
    curve = SmoothPath(path)
    law = TimeLaw(curve, _law(rng, curve.length, duration))
    return Rigging.of(scenario, law, ends_beside(scenario, path))


def _law(rng: np.random.Generator, length: float, duration: float) -> PPoly:
    """From rest to rest through one or two places at speeds of their own, never back."""
    while True:
        count = int(rng.integers(0, 3))
        share = np.linspace(0, 1, count + 2) + np.pad(rng.normal(size=count) * 0.05, 1)
        inner = [[x, rng.uniform(0.8, 1.6), 0.0] for x in share[1:-1]]
        law = PPoly.from_bernstein_basis(
            BPoly.from_derivatives(share, [[0.0, 0.0, 0.0], *inner, [1.0, 0.0, 0.0]])
        )
        if law(np.linspace(0, 1, 2001), nu=1).min() >= 0:
            powers = np.arange(len(law.c) - 1, -1, -1.0)[:, None]
            return PPoly(law.c * length / duration**powers, law.x * duration)


def outcome(rigging: Rigging) -> Outcome:
    """Limits put where they are just kept, and just broken."""
    known = {_key(each): each.value for each in sampled_report(rigging, NO_DISTANCES)}
    times = np.linspace(0, rigging.law.duration, DENSE)
    report = sampled_report(rigging, NO_DISTANCES, times)
    held = rigging.cables == 3 or all(each.ok for each in report if "tension" in each.name)
    lines, names = [], []
    for each in report:
        quantity = quantity_of(rigging, each.name, each.about)
        if quantity is None or not np.isfinite(each.value):
            continue
        if not held and ("tension" in each.name or "S_c" in each.name):
            continue  # what more than three cables carry is stated where they can hold the load
        # Of two limits the value is about the one that is nearer; C_t has no other.
        low = each.value - each.low <= each.high - each.value or each.name == RATIO
        sign = 1.0 if low else -1.0
        for room in (SPARES.get(each.name, SPARE), -BROKEN):
            limit = each.value - sign * room * max(abs(each.value), 1e-3)
            lines.append(Line(quantity, sign, limit, 0.0, known.get(_key(each), each.value)))
            names.append((room > 0, _key(each)))
    found = Outcome([], [], [], [], [])
    for (keeps, name), line, bound in zip(names, lines, prove(rigging, lines), strict=True):
        (found.kept if keeps else found.broken).append(name)
        if keeps and not bound.proved:
            (found.between if _breaks(rigging, line, name, bound) else found.refused).append(name)
        if not keeps and bound.proved:
            found.wrong.append(name)
    return found


def _breaks(rigging: Rigging, line: Line, name: str, bound: Bound) -> bool:
    """Whether a limit is broken where the proof says so, by what the report says around there."""
    if bound.time is None:
        return False
    times = np.clip(bound.time + np.linspace(-1e-3, 1e-3, 201), 0, rigging.law.duration)
    seen = {_key(each): each.value for each in sampled_report(rigging, NO_DISTANCES, times)}
    return line.sign * (seen[name] - line.limit) < 0


def _key(check: Check) -> str:
    """What tells a line from others: which cable is the worst may change."""
    of_one = check.name.startswith(("reach", "joint angle"))
    return f"{check.name} of {check.about}" if of_one else check.name


def main() -> None:
    """Print counts."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--motions", type=int, default=1000)
    parser.add_argument("--first", type=int, default=0, help="number of the first motion")
    asked = parser.parse_args()
    configure()
    counts, spent = np.zeros(5, int), 0.0
    for seed in range(asked.first, asked.first + asked.motions):
        rigging = random_motion(seed)
        begun = time.process_time()
        found = outcome(rigging)
        spent += time.process_time() - begun
        counts += [len(each) for each in found]
        for name in found.refused:
            print(f"motion {seed}: not proved: {name}", flush=True)
        for name in found.wrong:
            print(f"motion {seed}: WRONGLY PROVED: {name}", flush=True)
    kept, refused, between, broken, wrong = counts
    print(
        f"{asked.motions} motions: {kept} limits kept by {100 * SPARE:g} % at {DENSE} instants, "
        f"{between} of them found to be broken in between, {refused} not proved; {broken} limits "
        f"broken by {BROKEN:g}, {wrong} of them proved ({spent:.0f} s of a processor)"
    )


if __name__ == "__main__":
    main()
