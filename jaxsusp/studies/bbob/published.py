"""Running times that were published: those that COCO's postprocessing ships as its reference.

`cocopp` has them for the target 1e-8 as a pickle of plain NumPy arrays, from the workshops of 2009
and 2010; none are part of this package.
"""

import gzip
import importlib.util
import pickle
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pandas as pd

from jaxsusp._types import Float
from jaxsusp.report.render import Column, evaluations, percent
from jaxsusp.studies.bbob.suite import FUNCTIONS

FILE = "pprldistrever_1e-8.pickle.gz"
"""Name of the file in the package `cocopp`."""

CHOSEN = ("BIPOP-CMA-ES", "IPOP-CMA-ES", "DE-F-AUC", "DEuniform", "PSO", "GA", "RANDOMSEARCH")
"""Of the 54 that have all functions, the ones that ours are set beside."""


class Times(NamedTuple):
    """Runs of a published algorithm on one function."""

    solved: Float[np.ndarray, "runs"]  # evaluations until 1e-8; NaN: never
    ended: Float[np.ndarray, "runs"]  # evaluations of the whole run

    @property
    def expected(self) -> float:
        """Expected running time of restarts until one run solves the function; +inf if none did."""
        there = np.isfinite(self.solved)
        spent = np.where(there, self.solved, self.ended).sum()
        return float(spent / there.sum()) if there.any() else np.inf


Published = dict[tuple[str, int, int], Times]
"""Runs by algorithm, dimension and function."""


def published() -> Published:
    """Published runs by algorithm, dimension and function; none where `cocopp` is not installed."""
    found = importlib.util.find_spec("cocopp")
    if found is None or found.origin is None:
        return {}
    with gzip.open(Path(found.origin).with_name(FILE)) as file:
        known = pickle.load(file, encoding="latin1")
    return {
        (algorithm, dim, function): _times(*known[algorithm][function][dim])
        for algorithm in CHOSEN
        for function in known[algorithm]
        if function <= len(FUNCTIONS)  # from 101 on they are noisy
        for dim in known[algorithm][function]
    }


def beside(times: pd.DataFrame, known: Published, dim: int, target: float = 1e-8) -> pd.DataFrame:
    """Expected running times over D of every function, of ours and of published algorithms.

    Args:
        times: ours, of `summary.running_times`.
        known: published ones; they are known for the target 1e-8 alone.
        dim: which dimension.
        target: which target.
    """
    asked = (times["dimension"] == dim) & (times["target"] == target)
    here = times.loc[asked].to_dict("records")
    rows = []
    for function in sorted({each["function"] for each in here}):
        row: dict[str, Any] = {"function": f"f{function} {FUNCTIONS[function - 1].__name__}"}
        for each in here:
            if each["function"] == function:
                spent = each["evaluations"] / each["reached"] if each["reached"] else np.inf
                row[each["algorithm"]] = spent / dim
        if target == 1e-8:
            names = dict.fromkeys(name for name, where, _ in known if where == dim)
            row |= {f"{name}*": known[name, dim, function].expected / dim for name in names}
        rows.append(row)
    frame = pd.DataFrame(rows)
    frame["function"] = frame["function"].str.replace("_", " ")
    columns = {name: Column(name, evaluations) for name in frame.columns[1:]}
    frame.attrs = {"columns": columns, "caption": CAPTION.format(target=target, dim=dim)}
    return frame


def solved(times: pd.DataFrame, known: Published, budget: int) -> pd.DataFrame:
    """Share of all runs that reached 1e-8 within a budget, by algorithm and dimension.

    Args:
        times: ours, of `summary.running_times`, made with that budget; NaN where not all functions
            were run.
        known: published ones; what they did beyond the budget does not count here.
        budget: evaluations of a run over D.
    """
    rows: dict[str, dict[str, float]] = {}
    dims = sorted({*times["dimension"].tolist()})
    last = times.loc[times["target"] == times["target"].min()].to_dict("records")
    for name, dim in dict.fromkeys((each["algorithm"], each["dimension"]) for each in last):
        here = [each for each in last if (each["algorithm"], each["dimension"]) == (name, dim)]
        reached, runs = (sum(each[column] for each in here) for column in ("reached", "runs"))
        whole = len(here) == len(FUNCTIONS)
        rows.setdefault(name, {})[f"D = {dim}"] = reached / runs if whole else np.nan
    for name, dim in dict.fromkeys((name, dim) for name, dim, _ in known if dim in dims):
        runs = [known[name, dim, number].solved for number in range(1, len(FUNCTIONS) + 1)]
        share = (np.concatenate(runs) <= budget * dim).mean()
        rows.setdefault(f"{name}*", {})[f"D = {dim}"] = float(share)
    frame = pd.DataFrame([{"algorithm": name, **row} for name, row in rows.items()])
    columns = {name: Column(name, percent) for name in frame.columns[1:]}
    frame.attrs = {"columns": columns, "caption": SHARES.format(budget=budget)}
    return frame


CAPTION = (
    "Expected running time to f_opt + {target:g}, in evaluations over D = {dim} (∞: no run got "
    "there). * published."
)

SHARES = "Runs within 1e-8 of f_opt after {budget:,} D evaluations, on all functions. * published."


def _times(row: np.ndarray, ended: np.ndarray) -> Times:
    """The row begins with the target; it is -inf where no run reached it."""
    solved = row[1:] if np.isfinite(row[0]) else np.full(len(ended), np.nan)
    return Times(solved, ended)
