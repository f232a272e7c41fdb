"""What is said of a plan in sentences: its verdict, and how good, fast, calm and followed it is."""

from collections.abc import Sequence

from jaxsusp.planning.choices import SHORTEST, TAUT
from jaxsusp.planning.motion.bounds import Bound, bounds
from jaxsusp.planning.motion.demands import covered
from jaxsusp.planning.plan import Plan
from jaxsusp.report.render import significant
from jaxsusp.verify.simulation import TENSION, TRACKING

SEARCHED_FOR = {"fitness", "algorithm", "way", "attempts"}
"""Settings of plans that were searched for."""


def summary(plan: Plan, best: float | None = None) -> list[str]:
    """All that is said of a plan: the verdict with its reasons, then a sentence each.

    Args:
        plan: any plan; what its settings do not hold is left out.
        best: the best known fitness of the same task and ends, if there is one.
    """
    said = [verdict(plan.feasible, plan.reasons, plan.scenario.name)]
    if plan.feasible and plan.settings.keys() >= SEARCHED_FOR:
        said.append(how_good(plan, best))
    said += [how_fast(plan), how_limited(plan), how_calm(plan), how_followed(plan)]
    return [each for each in said if each]


def verdict(feasible: bool, reasons: Sequence[str], name: str) -> str:
    """One sentence, or one and a list."""
    if feasible:
        return f"{name}: the plan is feasible and certified clear at every instant."
    lines = "\n".join(f"  - {reason}" for reason in reasons)
    return f"{name}: the plan is infeasible:\n{lines}"


def how_good(plan: Plan, best: float | None) -> str:
    """One sentence about a plan that was searched for: its fitness, its way, and how it was found.

    Args:
        plan: with the settings that the planner keeps.
        best: the best known fitness of the same task and ends, if there is one.
    """
    said, fitness = plan.settings, plan.settings["fitness"]
    beside = ""
    if best is not None:
        gap = fitness / best - 1
        beside = f" ({100 * abs(gap):.1f} % {'above' if gap >= 0 else 'below'} the best known)"
    found = f"found by {said['algorithm']}"
    if said["way"] == TAUT:
        found = "the rounded taut way"
        if said["algorithm"] != TAUT:
            found += f", than which {said['algorithm']} found nothing better"
    attempts = said["attempts"]
    return (
        f"Fitness {fitness:.2f}{beside}, path {plan.law.path.length:.2f} m, {found} in {attempts} "
        f"attempt{'s' if attempts > 1 else ''}."
    )


def how_fast(plan: Plan) -> str:
    """One sentence about the duration, with the least one where that is known."""
    took = plan.law.duration
    if not (plan.feasible and plan.settings.get("duration") == SHORTEST):
        return f"Driven in {took:.4g} s."
    said = f"Driven in {took:.2f} s instead of the {plan.scenario.task.duration:g} s of the task"
    least = plan.settings.get("least_time")
    if least is None:
        return f"{said}, with the minimum-jerk law."
    return (
        f"{said}, {took / least:.2f} times the {least:.2f} s below which no law would do on this "
        "path, whatever its jerk."
    )


def how_limited(plan: Plan) -> str:
    """The limits with which a shortest law was made; "" of others."""
    if not (plan.feasible and is_paced(plan)):
        return ""
    return f"Limits of its law: {'; '.join(each.words for each in paced_by(plan))}."


def is_paced(plan: Plan) -> bool:
    """Whether a plan's law was chosen by limits that are known at every instant."""
    return plan.settings.get("duration") == SHORTEST and covered(plan.scenario)


def paced_by(plan: Plan) -> tuple[Bound, ...]:
    """The limits with which the law of such a plan was made."""
    return bounds(plan.scenario, had_to_follow(plan))


def had_to_follow(plan: Plan) -> bool:
    """Whether a shortest law was made so that a swinging load follows; old plans: was played."""
    return bool(plan.settings.get("has_to_follow", was_played(plan)))


def was_played(plan: Plan) -> bool:
    """Whether it was played in simulation when it was planned."""
    return bool(plan.settings.get("simulated", False))


def how_calm(plan: Plan) -> str:
    """One sentence about a law that was shaped; "" of others."""
    period = plan.settings.get("swing_period_s")
    if period is None:
        return ""
    return (
        f"Shaped over one swing of {significant(period, 2)} s, so that the load does not swing on "
        "at the goal."
    )


def how_followed(plan: Plan) -> str:
    """One sentence about the simulation, or that there was none."""
    if not was_played(plan):
        if plan.feasible:
            return "Not played: whether a swinging load follows, `jaxsusp verify` tells."
        return "Not played: only plans that keep their limits are."
    off, tension = (plan.settings.get(name) for name in ("tracking_error_m", "tension_error"))
    if off is None or tension is None:  # of an older version
        return "Played in simulation."
    allowed = plan.scenario.units.number(TRACKING, "m")
    return (
        f"Played in simulation: a swinging load stays within {significant(1e3 * off, 2)} mm of the "
        f"plan (allowed are {1e3 * allowed:.4g} mm), its tensions within "
        f"{significant(100 * tension, 2)} % (allowed are {100 * TENSION:.4g} %)."
    )
