"""Outcomes as plain values, for `--json`."""

from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from jaxsusp.planning.plan import Plan


def as_record(plan: "Plan", files: list[Path]) -> dict[str, Any]:
    """A plan's outcome as plain values for machines."""
    from jaxsusp.planning.document import plain

    return {
        "scenario": plan.scenario.name,
        "feasible": plan.feasible,
        "certified": plan.certificate.proved,
        "reasons": list(plan.reasons),
        "clearance_m": plain(plan.clearance),
        "ends_m": plan.ends.tolist(),
        "report": [
            {**plain(each._asdict()), "margin": plain(each.margin), "ok": each.ok}
            for each in plan.report
        ],
        "duration_s": plan.law.duration,
        "settings": plain(dict(plan.settings)),
        "files": [str(file) for file in files],
    }
