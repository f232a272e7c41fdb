"""What is it worth that waypoints are kept in the free space?"""

import json
import time

import numpy as np
import pandas as pd
import xarray as xr
from matplotlib.figure import Figure

import jaxsusp as js
from experiments.artefacts import Artefacts
from experiments.changes import Change, clear_change, fitness_change, found_nothing
from experiments.contents import Page, Work
from experiments.ends import ends, telling
from experiments.studies import budgets
from experiments.words import between, listed, signed
from jaxsusp.comparison.workunit import Unit, stack_scenarios
from jaxsusp.errors import require
from jaxsusp.optim.registry import algorithm
from jaxsusp.problem.choices import SEARCHES
from jaxsusp.report.comparison.gaps import clear_runs, gaps
from jaxsusp.report.drawing.intervals import Estimates, Look, rows_of_intervals
from jaxsusp.report.drawing.style import label, legend, panels, picture
from jaxsusp.report.render import Column, above, duration, significant

TITLE = "What the free space is worth"
PRINTED = ""
DIFFERS = (
    "The paper keeps waypoints in the ellipsoids of the free space. What is that worth for each "
    "algorithm, beside the polytopes around them and beside the whole workspace, and what does it "
    "cost?"
)
MADE = READ = ("spaces",)
MINUTES = 4.0


FULL, MINIATURE = budgets.FULL, budgets.MINIATURE
"""What is compared with data made for budgets has their settings."""


def make(settings: budgets.Settings, work: Work) -> None:
    """The paper's rule; the others are there, in what was made for other pages."""
    there = {
        "free-space": same(
            settings, work.artefacts.dataset("budgets"), "budgets", budget="iterations"
        ),
        "box": same(settings, work.artefacts.dataset("origin_tasks"), "origin_tasks", distance=0.0),
        "ellipsoid": js.compare(
            **settings._asdict(),
            search="ellipsoid",
            output=work.folder / "ellipsoid",
            resume=True,
            progress=telling(work.told, "ellipsoid"),
        ),
    }
    found = ends({search: there[search] for search in SEARCHES}, "search", settings)
    work.artefacts.keep("spaces", found.assign(timed(settings, work)))


def same(settings: budgets.Settings, ds: xr.Dataset, name: str, **part: object) -> xr.Dataset:
    """A part of what was made for another page.

    Raises:
        InputError: it was made with other settings.
    """
    made = json.loads(ds.attrs["settings"])
    for key, value in json.loads(json.dumps(settings._asdict())).items():
        require(
            made[key] == value,
            f"spaces: {key} is {value}, and {made[key]} in {name}; make both with the same",
        )
    return ds.sel(part).drop_vars([*part])


def timed(settings: budgets.Settings, work: Work) -> dict[str, xr.Variable]:
    """Seconds of a run's share of its batch, and of every free space, nothing taken from a cache.

    The quickest of several parts of a run counts: whatever else the machine does can only delay.
    """
    scenes = [*map(js.load_scenario, settings.scenarios)]
    runs = np.zeros((len(SEARCHES), len(settings.algorithms)))
    sizes = settings.iterations, settings.population
    for i, search in enumerate(SEARCHES):
        room = settings.iterations * (budgets.ROOM if search == "free-space" else 1)
        (group,) = stack_scenarios(scenes, 5, 40, search)
        for j, name in enumerate(settings.algorithms):
            work.told(f"  timing {name} in {search}")
            unit = Unit.plan(group, algorithm(name), *sizes, "iterations")._replace(asked=room)
            iteration = unit.time_iteration(settings.seed, settings.runs)
            runs[i, j] = iteration * settings.iterations / (settings.runs * len(scenes))
    spaces = []
    for scene in scenes:
        clock = time.perf_counter()
        js.free_space(scene, cache=False)
        spaces.append(time.perf_counter() - clock)
    return {
        "seconds": xr.Variable(("search", "algorithm"), runs, {"units": "s"}),
        "seconds_space": xr.Variable("scenario", np.array(spaces), {"units": "s"}),
    }


def draw(artefacts: Artefacts) -> Page:
    """What the rules change for every algorithm, and what they cost."""
    ds = artefacts.dataset("spaces")
    changes = changes_of(ds)
    return Page(
        {"spaces": figure(changes)},
        {"spaces": table(ds, changes), "spaces-time": time_table(ds)},
        findings(ds, changes),
    )


Changes = dict[tuple[str, str], tuple[Change, Change]]
"""Of fitness and clear runs, by search rule and algorithm, against the box."""


def changes_of(ds: xr.Dataset) -> Changes:
    """What the free space changes, as polytopes and as ellipsoids."""
    found = {}
    for search in SEARCHES[:2]:
        for name in ds["algorithm"].values.tolist():
            box, there = (ds.sel(algorithm=name, search=each) for each in ("box", search))
            found[search, name] = fitness_change(box, there), clear_change(box, there)
    return found


def figure(changes: Changes) -> Figure:
    """Both rules against the box, a row per algorithm."""
    names = list(dict.fromkeys(name for _, name in changes))
    looks = {
        "free-space": Look("polytopes", "#0072B2", "o"),
        "ellipsoid": Look("ellipsoids", "#C43C00", "D", filled=False),
    }
    drawing = picture(7.09, 0.8 + 0.32 * (len(names) + 1))
    axes = panels(drawing, 2, sharey=True)
    headings = ("change of fitness (%)\n← better", "change of clear runs (points)\n→ better")
    for panel, which, heading in zip(axes, (0, 1), headings, strict=True):
        series = [
            Estimates(look, *np.array([changes[search, name][which] for name in names]).T)
            for search, look in looks.items()
        ]
        rows_of_intervals(panel, [*map(label, names)], series)
        panel.set_xlabel(heading, fontsize=8.0)
    legend(drawing, [look.sample for look in looks.values()], size=8.0)
    drawing.set_label(
        "What changes where waypoints are kept in the free space, its polytopes or the ellipsoids "
        "in them, rather than anywhere in the box; lines: 95 % intervals over runs."
    )
    return drawing


def table(ds: xr.Dataset, changes: Changes) -> pd.DataFrame:
    """A row per algorithm and rule."""
    rows = []
    for name in ds["algorithm"].values.tolist():
        for search in SEARCHES:
            part = ds.sel(algorithm=name, search=search)
            nothing = Change(np.nan, np.nan, np.nan)
            fitness, clear = changes.get((search, name), (nothing, nothing))
            rows.append(
                {
                    "algorithm": name,
                    "search": search,
                    "gap": 100 * float(gaps(part).median()),
                    "clear": int(clear_runs(part).sum()),
                    "runs": int(part["fitness"].size),
                    "fitness": fitness.middle,
                    "fitness_low": fitness.low,
                    "fitness_high": fitness.high,
                    "points": clear.middle,
                    "points_low": clear.low,
                    "points_high": clear.high,
                }
            )
    frame = pd.DataFrame(rows)

    def change(value: float) -> str:
        return signed(value) if np.isfinite(value) else "–"

    frame.attrs["title"] = "What the free space changes"
    frame.attrs["columns"] = {
        "gap": Column("median gap (%)", above),
        "fitness": Column("fitness (%)", change),
        "fitness_low": Column("from", change),
        "fitness_high": Column("to", change),
        "points": Column("clear runs (points)", change),
        "points_low": Column("from", change),
        "points_high": Column("to", change),
    }
    frame.attrs["caption"] = (
        f"{int(ds['iterations'][0, 0])} iterations. Median over all runs of the gap to the best "
        "known fitness; change against the box of the "
        "geometric mean of the fitness and of the share of clear runs, with 95 % intervals of a "
        f"bootstrap over the {ds.sizes['run']} runs of every scenario."
    )
    return frame


def time_table(ds: xr.Dataset) -> pd.DataFrame:
    """What a run takes, without and with the free space, and from how many runs on it is little."""
    space = float(ds["seconds_space"].mean())
    seconds = ds["seconds"].to_pandas().T
    frame = pd.DataFrame({"algorithm": seconds.index})
    for search in SEARCHES:
        frame[search] = seconds[search].to_numpy()
    frame["with"] = frame["free-space"] + space
    frame["runs"] = np.ceil(space / frame["free-space"]).astype(int)
    frame.attrs["title"] = "What it costs"
    frame.attrs["columns"] = {
        **{search: Column(f"a run, {search}", duration) for search in SEARCHES},
        "with": Column("one run and its free space", duration),
        "runs": Column("runs that take as long as the free space"),
    }
    frame.attrs["caption"] = (
        "A run's share of a batch of all runs on all scenarios, compilation not included; a free "
        f"space takes {significant(space, 2)} s in the mean of the scenarios, once, and is kept. "
        "Measured while the machine had other work: orders of magnitude, no more."
    )
    return frame


def alike(ds: xr.Dataset) -> list[str]:
    """Algorithms whose runs all end the same in ellipsoids as in polytopes."""
    one, other = (ds["fitness"].sel(search=each) for each in SEARCHES[:2])
    same = (one == other).all(("scenario", "run"))
    return [name for name in ds["algorithm"].values.tolist() if same.sel(algorithm=name)]


def findings(ds: xr.Dataset, changes: Changes) -> str:
    """For whom the free space is worth it, whether the paper's rule is as good, and the price."""
    names = ds["algorithm"].values.tolist()
    said = []
    same = alike(ds)
    for search, told in (("free-space", "polytopes"), ("ellipsoid", "ellipsoids")):
        groups: dict[int, list[str]] = {-1: [], 1: [], 0: []}
        for name in names:
            if search == "ellipsoid" and name in same:
                continue
            change = changes[search, name][0]
            text = f"{label(name)} ({signed(change.middle)} %, {between(*change[1:])})"
            groups[change.sure].append(text if change.sure else label(name))
        words = {-1: "lower the fitness of", 1: "raise that of", 0: "leave it open for"}
        parts = [f"{words[key]} {listed(found)}" for key, found in groups.items() if found]
        said.append(f"Against the box, the {told} of the free space {'; they '.join(parts)}.")
    if same:
        said.append(
            f"Every run of {listed([*map(label, same)])} is the very same in ellipsoids as "
            "in polytopes: it does not depend on this choice, and is left out of the sentence on "
            "ellipsoids."
        )
    more = {
        search: sum(changes[search, name][1].sure > 0 for name in names)
        for search in ("free-space", "ellipsoid")
    }
    counts = {search: int(clear_runs(ds.sel(search=search)).sum()) for search in SEARCHES}
    runs = int(ds.sel(search="box")["fitness"].size)
    said.append(
        f"Of {runs} runs of all algorithms {counts['box']} are clear in the box, "
        f"{counts['free-space']} in the polytopes and {counts['ellipsoid']} in the ellipsoids; by "
        f"itself the gain is sure for {more['free-space']} and {more['ellipsoid']} of "
        f"{len(names)} algorithms."
    )
    space = float(ds["seconds_space"].mean())
    said.append(
        f"The free space itself takes {significant(space, 2)} s once, about as long as "
        f"{time_table(ds)['runs'].median():.0f} runs in a batch (median of the algorithms). Times "
        "were measured while the machine had other work: whether a run in the free space takes "
        "longer than one in the box they do not tell."
    )
    said.append(found_nothing(ds))
    return " ".join(said).strip()
