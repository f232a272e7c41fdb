"""What planning and verifying cost, warm: scenario 1 with given and with placed ends."""

import time
from collections.abc import Callable

from rich.console import Console

import jaxsusp as js
from jaxsusp.planning.plan import Plan
from jaxsusp.planning.waypoints import plan_through
from jaxsusp.verify.certificate import certify
from jaxsusp.verify.simulation import simulate


def least(work: Callable[[int], object], repeats: int = 3) -> float:
    """Least time of several calls, each with another seed, after a first one that compiles."""
    work(0)
    times = []
    for seed in range(1, repeats + 1):
        clock = time.perf_counter()
        work(seed)
        times.append(time.perf_counter() - clock)
    return min(times)


def planning_rows(console: Console) -> dict[str, float]:
    """Measure and print; seconds by name."""
    scenario = js.load_scenario("scenario-1")
    plan: Plan = js.plan(scenario)
    targets = (
        ("plan_given_s", "a plan with given ends, certificate included", 1.0,
         lambda seed: js.plan(scenario, seed=seed)),
        ("plan_placed_s", "a plan with placed ends, certificate included", 5.0,
         lambda seed: js.plan(scenario, ends="placed", seed=seed)),
        ("check_s", "smoothing, limits and certificate of one candidate", None,
         lambda _: plan_through(scenario, plan.waypoints)),
        ("certificate_s", "the certificate alone", None,
         lambda _: certify(plan.rigging)),
        ("simulation_s", "simulation of 40 s", 2.0, lambda _: simulate(plan.rigging)),
    )  # fmt: skip
    found = {}
    console.print("", "planning scenario 1, warm:")
    for name, what, target, work in targets:
        found[name] = least(work)
        wanted = "" if target is None else f" (target {target:g})"
        console.print(f"{what}: {found[name]:.3f} s{wanted}")
    return found


def main() -> None:
    """Only these: `python -m benchmarks.planning`."""
    from jaxsusp.optim.devices import configure

    configure(keep=False)
    planning_rows(Console())


if __name__ == "__main__":
    main()
