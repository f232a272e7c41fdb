"""Many plans as one table: which of them stand, how good they are, and why the others do not."""

from collections.abc import Sequence
from typing import Any

import numpy as np
import pandas as pd

from jaxsusp.planning.many.kept import Planned
from jaxsusp.report.plan.words import was_played
from jaxsusp.report.render import Column, significant


def plans_table(planned: Sequence[Planned]) -> pd.DataFrame:
    """A row per scenario; below the table the reasons of those without a plan that stands."""
    frame = pd.DataFrame([_row(each) for each in planned])
    stand = sum(each.feasible for each in planned)
    frame.attrs["title"] = "Plans"
    frame.attrs["caption"] = f"{stand} of {len(planned)} feasible." + _not_played(planned)
    frame.attrs["columns"] = {
        "length": Column("path (m)", lambda value: significant(value, 3)),
        "fitness": Column("fitness", lambda value: significant(value, 4)),
        "clearance": Column("clearance (m)", lambda value: significant(value, 2)),
        "duration": Column("duration (s)", lambda value: significant(value, 3)),
        "seconds": Column("planned in (s)", lambda value: significant(value, 2)),
    }
    frame.attrs["bold"] = frozenset(
        (row, "plan") for row, each in enumerate(planned) if not each.feasible
    )
    return frame


def _not_played(planned: Sequence[Planned]) -> str:
    """How many plans stand as far as is known without simulation, in a sentence; "" where none."""
    plans = [each.plan for each in planned if each.plan is not None and each.feasible]
    count = sum(not was_played(plan) for plan in plans)
    if not count:
        return ""
    return f" Not played: {count}; whether a swinging load follows, `jaxsusp verify` tells."


def _row(each: Planned) -> dict[str, Any]:
    plan, nan = each.plan, np.nan
    verdict = "none" if plan is None else "feasible" if plan.feasible else "infeasible"
    return {
        "scenario": each.name,
        "plan": verdict,
        "played": "yes" if plan is not None and was_played(plan) else "no",
        "length": nan if plan is None else plan.law.path.length,
        "fitness": nan if plan is None else float(plan.settings.get("fitness", nan)),
        "clearance": nan if plan is None else plan.clearance,
        "duration": nan if plan is None else plan.law.duration,
        "seconds": each.seconds,
    }
