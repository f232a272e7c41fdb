"""Position, velocity, acceleration and jerk of the four algorithms' best."""

from typing import Any

import numpy as np
import pandas as pd

from experiments.artefacts import Artefacts
from experiments.contents import Page
from jaxsusp.report.comparison import paper
from jaxsusp.report.comparison.best import best_plan
from jaxsusp.report.comparison.printed import INSTANTS, motions
from jaxsusp.report.render import Column, significant

TITLE = "The motion of the load"
PRINTED = "Fig. 8"
DIFFERS = (
    "The paper does not say by which law the load runs along its path. Ours starts and ends at "
    "rest, with a path whose curvature has no jumps, so that the jerk is finite everywhere."
)
MADE = ()
READ = ("comparison",)
MINUTES = 0.0
FULL = MINIATURE = None
SCENARIO = "scenario-1"


def draw(artefacts: Artefacts) -> Page:
    """Twelve panels, and the greatest values."""
    ds = paper.of_the_paper(artefacts.comparison("comparison", scenario=[SCENARIO]))
    found = {name: best_plan(ds, SCENARIO, name) for name in ds["algorithm"].values.tolist()}
    plans = {name: plan for name, plan in found.items() if plan is not None}
    figure = motions({name: plan.law for name, plan in plans.items()})
    figure.set_label(
        f"{SCENARIO}: position, velocity, acceleration and jerk of the best run of each algorithm."
    )
    rows = []
    for name, plan in plans.items():
        motion = plan.at(np.linspace(0, plan.law.duration, INSTANTS))
        greatest = [np.linalg.norm(each, axis=1).max() for each in motion[1:]]
        along = np.abs(motion.acceleration).max(axis=0)
        rows.append((name, *greatest, *along))
    frame: Any = pd.DataFrame(rows, columns=["algorithm", "v", "a", "j", "ax", "ay", "az"])
    frame.attrs["title"] = "Greatest speed, acceleration and jerk"
    frame.attrs["columns"] = {
        "v": Column("speed (m/s)"),
        "a": Column("acceleration (m/s²)"),
        "j": Column("jerk (m/s³)"),
    } | {f"a{axis}": Column(f"|a| along {axis} (m/s²)") for axis in "xyz"}
    frame.attrs["bold"] = frozenset(
        (int(frame[name].idxmin()), name) for name in frame.columns[1:] if len(frame) > 1
    )
    frame.attrs["caption"] = f"{SCENARIO}, the best run of each algorithm, over the whole time."
    return Page({"motion": figure}, {"motion": frame}, findings(frame, paper.lacking(ds)))


def findings(frame, lacking: str) -> str:
    """Whether SDBO is the gentlest, as the paper says of its own."""
    order = frame.sort_values("a")["algorithm"].str.upper().tolist()
    first = (
        f"By greatest acceleration the order is {', '.join(order)} "
        f"({significant(frame['a'].min(), 3)} to {significant(frame['a'].max(), 3)} m/s²)."
    )
    if "SDBO" not in order:
        return f"{first} {lacking}".strip()
    sdbo = frame.set_index("algorithm").loc["sdbo"]
    least = [axis for axis in "xyz" if sdbo[f"a{axis}"] <= frame[f"a{axis}"].min()]
    where = (
        "in every direction" if len(least) == 3
        else f"along {' and '.join(least)} only" if least else "in no direction"
    )  # fmt: skip
    same = order == ["SDBO", "PSO", "GA", "DBO"]
    return (
        f"{first} The paper has SDBO, PSO, GA, DBO, {'as here' if same else 'which differs'}, and "
        "says that SDBO accelerates least in almost all directions; here it does so "
        f"{where}. {lacking}"
    ).strip()
