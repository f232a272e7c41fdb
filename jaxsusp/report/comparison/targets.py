"""Empirical distribution of running times: how many targets are reached after how much work."""

import numpy as np
import xarray as xr
from jaxtyping import Float
from matplotlib.figure import Figure

from jaxsusp.report.comparison.gaps import evaluations_to, runs_made
from jaxsusp.report.drawing.style import (
    INK,
    heading,
    legend,
    line_sample,
    log_axis,
    panels,
    picture,
    styles,
)

TARGETS = np.logspace(0, -3, 31)
"""Gaps above the best known fitness, 100 % to 0.1 %, ten per decade."""

AT_A_TIME = 2_000_000
"""Numbers that are compared at a time, those of all histories with each of some targets."""


def reached(ds: xr.Dataset, algorithm: str) -> tuple[Float[np.ndarray, "steps"], np.ndarray]:
    """Evaluations at which pairs of a run and a target are reached, and the share reached then.

    Runs on all scenarios whose best fitness is known count together, with `TARGETS`.

    Returns:
        Evaluations, rising, and shares of all pairs, in (0, 1]; empty where nothing is reached or
        known.
    """
    cell = ds.sel(algorithm=[algorithm])
    together = max(1, AT_A_TIME // cell["history"].size)
    needed = [
        evaluations_to(cell, (1 + xr.DataArray(some, dims="target")) * cell["best_known"])
        for some in np.split(TARGETS, range(together, len(TARGETS), together))
    ]
    pairs = np.concatenate([each.values.ravel() for each in needed])
    pairs = pairs[~np.isnan(pairs)]
    spent, count = np.unique(pairs[np.isfinite(pairs)], return_counts=True)
    return spent, count.cumsum() / max(len(pairs), 1)


def running_times(ds: xr.Dataset) -> Figure | None:
    """Share of all (scenario, run, target) that an algorithm has reached, against evaluations.

    The figure of COCO (Hansen et al. 2021) without its simulated restarts: a line ends, with the
    algorithm's marker, where its runs end.

    Returns:
        The figure; None where no best fitness is known.
    """
    if not (ds["best_known"] > 0).any():
        return None
    known = ds.sel(scenario=ds["best_known"] > 0)
    figure = picture(8.0, 5.2)
    (axes,) = panels(figure, 1)
    look = styles(ds["algorithm"].values.tolist())
    first, end = np.inf, known["evaluations"].max().item()
    for name, style in look.items():
        spent, share = reached(known, name)
        last = known["evaluations"].sel(algorithm=name).max().item()
        spent = np.concatenate([spent[:1], spent, [last]])  # up from 0, and level to the end
        share = np.concatenate([[0.0], share, share[-1:]])[: len(spent)]
        first = min(first, spent[0])
        axes.plot(
            spent, share, color=style.color, ls=style.dash, lw=1.8, label=style.label,
            drawstyle="steps-post", marker=style.marker, markersize=6, markevery=_spread(spent),
        )  # fmt: skip
    axes.set_xscale("log")
    axes.set_xlim(0.9 * first, 1.1 * end)
    log_axis(axes.xaxis)
    axes.set_ylim(-0.01, 1.01)
    axes.set_xlabel("fitness evaluations per run", fontsize=10, color=INK)
    axes.set_ylabel("share of runs and targets reached", fontsize=10, color=INK)
    scenarios = known.sizes["scenario"]
    heading(
        figure,
        f"Targets from 100 % to 0.1 % above the best known fitness: {scenarios} "
        f"scenario{'s' * (scenarios > 1)}, {runs_made(ds)}",
    )
    legend(figure, [line_sample(style) for style in look.values()])
    return figure


def _spread(spent: Float[np.ndarray, "steps"]) -> list[int]:
    """Points that carry a marker: some evenly along the logarithmic axis, and the last."""
    there = np.log(spent)
    places = np.linspace(there[0], there[-1], 8)
    return sorted({*np.searchsorted(there, places[1:-1]).tolist(), len(spent) - 1})
