"""The best run of an algorithm as a plan on the real curve."""

import json

import numpy as np
import xarray as xr

from jaxsusp.errors import InputError
from jaxsusp.planning.plan import Plan
from jaxsusp.planning.waypoints import plan_through
from jaxsusp.scenario.scenario import Scenario


def scenario_of(ds: xr.Dataset, name: str) -> Scenario:
    """A scenario from the file of it that a comparison holds.

    Raises:
        InputError: it holds none of that name.
    """
    texts = json.loads(ds.attrs.get("scenario_files", "{}"))
    if name not in texts:
        there = ", ".join(texts) or "none"
        raise InputError(f"scenario = {name!r}: the comparison holds {there}")
    return Scenario.from_toml(texts[name], f"{name}.toml")


def best_plan(ds: xr.Dataset, scenario: str, algorithm: str) -> Plan | None:
    """The run of least fitness laid on a smooth path, driven from rest to rest, and checked.

    A search knows only samples of its trajectory; the plan says what the real curve keeps. It goes
    through these samples: what an algorithm found is shown, not what a plan would make of it.

    Args:
        ds: a comparison.
        scenario: one of its scenarios.
        algorithm: one of its algorithms.

    Returns:
        The plan, feasible or with reasons; None where there is no such run.
    """
    runs = ds.sel(scenario=scenario, algorithm=algorithm)
    if not np.isfinite(runs["fitness"]).any():
        return None
    best = runs.isel(run=runs["fitness"].fillna(np.inf).argmin("run").item())
    waypoints = best["x"].values.reshape(-1, 3)
    return plan_through(
        scenario_of(ds, scenario), waypoints, samples=ds.sizes["sample"],
        settings={"algorithm": algorithm, "fitness": best["fitness"].item()}, smooth=False,
    )  # fmt: skip
