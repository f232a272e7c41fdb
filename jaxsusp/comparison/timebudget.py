"""Equal time for all algorithms: what the slowest of them takes for the iterations asked for.

Time is measured once per algorithm, after compilation, on the first chunks of a run; from then on a
comparison counts iterations, so that it can be interrupted, resumed and extended. What was measured
travels with the dataset. Other machines, and other hours on this one, measure something else.
"""

from collections.abc import Callable, Sequence

import xarray as xr

from jaxsusp.comparison.dataset import Allotment, time_allotted
from jaxsusp.comparison.workunit import Unit


def allot(
    units: Sequence[Unit], finished: Sequence[xr.Dataset], timed: Callable[[Unit], float]
) -> tuple[list[Unit], Allotment]:
    """Units with as many iterations as the time allows, at least one.

    Args:
        units: all units with the iterations asked for, which the slowest algorithm keeps.
        finished: what is there of the comparison; its time and iterations stay as they are.
        timed: seconds of an iteration of one run of a unit on all its scenarios.
    """
    allotted: Allotment = {"seconds": 0.0, "iterations": {}}
    for ds in finished:
        known = time_allotted(ds)
        allotted["seconds"] = known["seconds"]
        allotted["iterations"] |= known["iterations"]
    pace: dict[str, float] = {}  # seconds of an iteration of one run on all scenarios
    for unit in units:
        name = unit.optimizer.name
        if name not in allotted["iterations"]:
            pace[name] = pace.get(name, 0.0) + timed(unit)
    if not finished:
        allotted["seconds"] = max(pace.values()) * units[0].iterations
    for name, seconds in pace.items():
        affordable = int(allotted["seconds"] / seconds * (1 + 1e-9))  # of itself all, not one less
        allotted["iterations"][name] = max(1, affordable)
    named = allotted["iterations"]
    return [each._replace(iterations=named[each.optimizer.name]) for each in units], allotted
