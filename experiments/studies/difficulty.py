"""What makes a task hard: many obstacles, many robots, or a narrow passage?"""

import json
import multiprocessing
import time
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pandas as pd
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

import jaxsusp as js
from experiments.artefacts import Artefacts
from experiments.contents import Page, Work
from jaxsusp._files import write_text
from jaxsusp.freespace.cells.passage import passage_width
from jaxsusp.optim import devices
from jaxsusp.report.comparison.gaps import clear_fitness, clear_runs, evaluations_to
from jaxsusp.report.comparison.logistic import fitted, resampled, share_interval
from jaxsusp.report.drawing.style import (
    INK,
    Style,
    label,
    line_sample,
    log_axis,
    picture,
    quiet,
    styles,
)
from jaxsusp.report.render import Column, above, evaluations, significant

TITLE = "What makes a task hard"
PRINTED = ""
DIFFERS = (
    "Random scenes, blocked and proved to be solvable, in which one thing is changed at a time: "
    "the number of obstacles, the number of robots, the width of the narrowest passage. How often "
    "is a plan found, how often do the paper's algorithms end clear, and what does it cost?"
)
MADE = READ = ("difficulty",)
MINUTES = 12.0


class Level(NamedTuple):
    """Scenes of one kind, a seed each."""

    obstacles: int = 12
    robots: int = 3
    narrowest: float = 0.2  # m, of `jaxsusp.passage`
    widest: float = 0.4


class Settings(NamedTuple):
    """One sweep after the other about the level that all of them share, and the comparison."""

    base: Level = Level()
    obstacles: tuple[int, ...] = (6, 25, 50)
    robots: tuple[int, ...] = (5, 8)
    passages: tuple[tuple[float, float], ...] = ((0.03, 0.1), (0.1, 0.2), (0.4, 0.8))
    scenes: int = 4  # of a level, on which algorithms are compared …
    planned: int = 1  # … and of these so many are planned as well
    fewer: tuple[tuple[int, int], ...] = ()  # (obstacles, scenes) where scenes take long to draw
    algorithms: tuple[str, ...] = ("pso", "sdbo")
    runs: int = 10
    iterations: int = 200
    population: int = 30
    processes: int = 1

    def levels(self) -> list[Level]:
        """All of them, that of the base first."""
        return [
            self.base,
            *(self.base._replace(obstacles=count) for count in self.obstacles),
            *(self.base._replace(robots=count) for count in self.robots),
            *(self.base._replace(narrowest=low, widest=high) for low, high in self.passages),
        ]

    def draws(self) -> list[tuple[Level, int]]:
        """Level and seed of every scene."""
        fewer = dict(self.fewer)
        return [
            (level, seed)
            for level in self.levels()
            for seed in range(min(self.scenes, fewer.get(level.obstacles, self.scenes)))
        ]


FULL = Settings()
MINIATURE = Settings(Level(6), (), (), ((0.4, 0.8),), 2, 1, (), ("pso",), 2, 20)


def make(settings: Settings, work: Work) -> None:
    """Draw the scenes, compare on all of them in the whole workspace, and plan some."""
    scenes = drawn(settings, work)
    tasks = [js.load_scenario(row["file"]) for row in scenes]
    ds = js.compare(
        tasks, settings.algorithms, settings.runs, settings.iterations, settings.population,
        search="box", output=work.folder / "comparison", resume=True,
    )  # fmt: skip
    plans = [
        planned(task, work) if row["seed"] < settings.planned else {}
        for row, task in zip(scenes, tasks, strict=True)
    ]
    frame = pd.DataFrame([row | plan for row, plan in zip(scenes, plans, strict=True)])
    work.artefacts.keep("difficulty", beside(frame.drop(columns="file"), ds), settings)


def drawn(settings: Settings, work: Work) -> list[dict]:
    """What is known of every scene before it is planned, in the order of `draws`."""
    folder = Path(work.folder) / "scenes"
    folder.mkdir(parents=True, exist_ok=True)
    asked = [(level, seed, folder) for level, seed in settings.draws()]
    if settings.processes == 1:
        return [drawn_scene(each) for each in asked]
    spawned = multiprocessing.get_context("spawn")
    with spawned.Pool(settings.processes, devices.configure) as pool:
        rows = []
        for row in pool.imap(drawn_scene, asked):
            work.told(f"drew {row['scenario']}: {row['width']:.3f} m wide")
            rows.append(row)
        return rows


def drawn_scene(asked: tuple[Level, int, Path]) -> dict:
    """Draw a scene; what is kept stays."""
    level, seed, folder = asked
    kept = folder / f"{'-'.join(map(str, level))}-{seed}.json"
    if kept.exists():
        return json.loads(kept.read_text(encoding="utf-8"))
    clock = time.perf_counter()
    task = js.random_scenario(
        seed, level.obstacles, robots=level.robots, passage=(level.narrowest, level.widest)
    )
    row = {
        "scenario": task.name, **level._asdict(), "seed": seed, "width": passage_width(task),
        "seconds_draw": time.perf_counter() - clock, "file": str(folder / f"{task.name}.toml"),
    }  # fmt: skip
    write_text(row["file"], task.to_toml())
    write_text(kept, json.dumps(row))
    return row


def planned(task: js.Scenario, work: Work) -> dict:
    """How planning it went, a second time: programs are compiled and the space is mapped."""
    kept = Path(work.folder) / "plans" / f"{task.name}.json"
    if kept.exists():
        return json.loads(kept.read_text(encoding="utf-8"))
    kept.parent.mkdir(parents=True, exist_ok=True)
    clock = time.perf_counter()
    js.free_space(task)
    mapped = time.perf_counter() - clock
    js.plan(task)
    clock = time.perf_counter()
    plan = js.plan(task)
    seconds = time.perf_counter() - clock
    row = {
        "seconds_space": mapped, "seconds_plan": seconds, "feasible": plan.feasible,
        "attempts": plan.settings["attempts"], "runs_made": plan.settings["runs_made"],
        "fitness": plan.settings["fitness"],
        "clearance": plan.clearance, "reasons": "; ".join(plan.reasons), **taut(task),
    }  # fmt: skip
    write_text(kept, json.dumps(row))
    work.told(f"planned {task.name}: {'feasible' if plan.feasible else row['reasons']}")
    return row


def taut(task: js.Scenario) -> dict:
    """The plan that is there without any search."""
    try:
        plan = js.plan(task, "taut", simulate=False)
    except js.InputError:
        return {"taut": np.nan, "taut_feasible": False}
    return {"taut": plan.settings["fitness"], "taut_feasible": plan.feasible}


def beside(frame: pd.DataFrame, ds: xr.Dataset) -> pd.DataFrame:
    """The scenes with clear runs, fitness and evaluations until clear of every algorithm."""
    clear, needed = clear_runs(ds), evaluations_to(ds, clear_fitness(ds))
    for name in ds["algorithm"].values.tolist():
        of = {"algorithm": name, "scenario": frame["scenario"].tolist()}
        frame[f"{name}_clear"] = clear.sel(of).sum("run").values
        frame[f"{name}_runs"] = ds.sizes["run"]
        frame[f"{name}_fitness"] = ds["fitness"].where(clear).sel(of).median("run").values
        frame[f"{name}_evaluations"] = ds["evaluations"].sel(of).values
        frame[f"{name}_spent"] = (
            needed.where(needed < np.inf, ds["evaluations"]).sel(of).sum("run").values
        )
    return frame


def draw(artefacts: Artefacts) -> Page:
    """Shares and costs by level, and a logistic curve by width."""
    frame = artefacts.frame("difficulty")
    names = frame.attrs["settings"]["algorithms"]
    figures = {
        "difficulty": clear_figure(frame, names),
        "difficulty-cost": cost_figure(frame, names),
    }
    tables = {"difficulty": level_table(frame, names), "difficulty-odds": odds_table(frame, names)}
    return Page(figures, tables, findings(frame, names))


_LEVEL = ["obstacles", "robots", "narrowest", "widest"]


def levels(frame: pd.DataFrame, names: list[str]) -> pd.DataFrame:
    """A row per level: runs that end clear, what one takes, plans, times."""
    rows = []
    for level, part in frame.groupby(_LEVEL, sort=True):
        row = dict(zip(_LEVEL, level, strict=True))
        row |= {"scenes": len(part), "width": part["width"].median()}
        for name in names:
            clear = int(part[f"{name}_clear"].sum())
            row |= {
                f"{name}_clear": clear,
                f"{name}_runs": int(part[f"{name}_runs"].sum()),
                f"{name}_ert": part[f"{name}_spent"].sum() / clear if clear else np.inf,
            }
        tried = part[part["feasible"].notna()]
        row |= {
            "feasible": int((tried["feasible"] == True).sum()),  # noqa: E712
            "tried": len(tried),
            "below_taut": 100 * (1 - tried["fitness"] / tried["taut"]).median(),
            "seconds_space": tried["seconds_space"].median(),
            "seconds_plan": tried["seconds_plan"].median(),
        }
        rows.append(row)
    return pd.DataFrame(rows)


def level_table(frame: pd.DataFrame, names: list[str]) -> pd.DataFrame:
    """The levels for people."""
    table = levels(frame, names)
    table.insert(
        2, "passage", [f"{a:g}–{b:g}" for a, b in table[["narrowest", "widest"]].to_numpy()]
    )
    table = table.drop(columns=["narrowest", "widest", "width"])
    table.attrs["title"] = "By level"
    table.attrs["columns"] = {
        "passage": Column("passage (m)"),
        "feasible": Column("planned", out_of="tried"),
        "below_taut": Column("plan below taut (%)", above),
        "seconds_space": Column("mapping (s)", lambda value: significant(value, 2)),
        "seconds_plan": Column("planning (s)", lambda value: significant(value, 2)),
    }
    for name in names:
        table.attrs["columns"] |= {
            f"{name}_clear": Column(f"{label(name)} clear", out_of=f"{name}_runs"),
            f"{name}_ert": Column(f"{label(name)} ERT clear", evaluations),
        }
    table.attrs["caption"] = (
        "Passage: range of the width of the narrowest place, `js.passage`. Clear: runs without any "
        "collision or violation, waypoints anywhere in the workspace. ERT: fitness evaluations of "
        "all runs until a first clear trajectory, or to their end, over the runs that end clear. "
        "Planned: scenes of those tried of which `js.plan` returns a certified and simulated plan; "
        "medians of the time for its free space and for the plan, and of how far its fitness is "
        "below that of the taut way, on a machine that was busy with other work."
    )
    return table


def columns_of(frame: pd.DataFrame) -> np.ndarray:
    """Doublings of obstacles, robots, doublings of the width."""
    return np.column_stack(
        [np.log2(frame["obstacles"]), frame["robots"].astype(float), np.log2(frame["width"])]
    )


_STEPS = ("twice the obstacles", "one robot more", "twice the width")


def odds_table(frame: pd.DataFrame, names: list[str]) -> pd.DataFrame:
    """By which factor the odds of a clear run change."""
    rows = []
    for name in names:
        data = (
            columns_of(frame),
            *(frame[f"{name}_{each}"].to_numpy(float) for each in ("clear", "runs")),
        )
        best, curves = fitted(*data), resampled(*data)
        low, high = np.quantile([curve.slopes for curve in curves], [0.025, 0.975], axis=0)
        for i, step in enumerate(_STEPS):
            rows.append((name, step, *np.exp([best.slopes[i], low[i], high[i]])))
    table = pd.DataFrame(rows, columns=["algorithm", "step", "factor", "low", "high"])
    table.attrs["title"] = "Odds of a clear run"
    table.attrs["columns"] = {
        "factor": Column("odds times", lambda value: significant(value, 2)),
        "low": Column("from", lambda value: significant(value, 2)),
        "high": Column("to", lambda value: significant(value, 2)),
    }
    table.attrs["caption"] = (
        "Logistic curve of the share of clear runs by the logarithm of the obstacles, the robots "
        "and the logarithm of the width together; 95 % intervals from drawing whole scenes anew."
    )
    return table


def sweeps(frame: pd.DataFrame) -> dict[str, pd.DataFrame]:
    """The scenes of every sweep, those of the base in all of them."""
    base = Level(*frame.attrs["settings"]["base"])
    same = {name: frame[name] == getattr(base, name) for name in _LEVEL}
    return {
        "obstacles": frame[same["robots"] & same["narrowest"]],
        "robots": frame[same["obstacles"] & same["narrowest"]],
        "width": frame[same["obstacles"] & same["robots"]],
    }


_AXES = {"obstacles": "obstacles", "robots": "robots", "width": "narrowest passage (m)"}


def clear_figure(frame: pd.DataFrame, names: list[str]) -> Figure:
    """Share of clear runs by obstacles, robots and width."""
    figure, look = picture(7.09, 2.7), styles(names)
    panels = figure.subplots(1, 3, sharey=True)
    for axes, (what, part) in zip(panels, sweeps(frame).items(), strict=True):
        quiet(axes)
        axes.tick_params(labelsize=7.5)
        axes.set_xlabel(_AXES[what], fontsize=8)
        if what != "robots":
            axes.set_xscale("log")
        for number, name in enumerate(names):
            shift = 1.03 ** (2 * number - len(names) + 1) if what != "robots" else 1
            move = 0.06 * (2 * number - len(names) + 1) if what == "robots" else 0
            share = 100 * part[f"{name}_clear"] / part[f"{name}_runs"]
            style, x = look[name], part[what] * shift + move
            axes.plot(x, share, style.marker, color=style.color, ms=2.6, alpha=0.55, mew=0)
            if what == "width":
                _curve(axes, part, name, style)
            else:
                _pooled(axes, part, what, name, style, shift, move)
        _plain_ticks(axes, part, what)
    panels[0].set_ylim(-4, 104)
    panels[0].set_ylabel("runs that end clear (%)", fontsize=8)
    _legend(figure, look)
    figure.set_label(
        "Runs that end clear by the number of obstacles, of robots, and the width of the narrowest "
        "passage; small marks are scenes, large ones levels with Wilson's 95 % interval of their "
        "runs; on the right logistic curves with 95 % bands from drawing scenes anew."
    )
    return figure


def _pooled(
    axes: Axes, part: pd.DataFrame, what: str, name: str, style: Style, shift, move
) -> None:
    """Levels with Wilson's intervals."""
    sums = part.groupby(what)[[f"{name}_clear", f"{name}_runs"]].sum()
    counts = [(int(clear), int(runs)) for clear, runs in sums.to_numpy()]
    shares = np.array([100 * clear / runs for clear, runs in counts])
    bounds = 100 * np.array([share_interval(*count) for count in counts]).T
    errors = np.abs(bounds - shares)
    axes.errorbar(
        sums.index.to_numpy() * shift + move, shares, yerr=errors, fmt=style.marker, ls=style.dash,
        ms=5, lw=1, color=style.color, elinewidth=1,
    )  # fmt: skip


def _curve(axes: Axes, part: pd.DataFrame, name: str, style: Style) -> None:
    """The logistic curve by width alone, with its band."""
    data = _by_width(part, name)
    grid = np.geomspace(part["width"].min(), part["width"].max(), 80)
    rows = np.log2(grid)[:, None]
    shares = [100 * curve.share(rows) for curve in resampled(*data, resamples=400)]
    low, high = np.quantile(shares, [0.025, 0.975], axis=0)
    axes.fill_between(grid, low, high, color=style.color, alpha=0.15, lw=0)
    axes.plot(grid, 100 * fitted(*data).share(rows), style.dash, color=style.color, lw=1.4)


def _by_width(part: pd.DataFrame, name: str) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    clear, runs = (part[f"{name}_{each}"].to_numpy(float) for each in ("clear", "runs"))
    return np.log2(part["width"].to_numpy())[:, None], clear, runs


def cost_figure(frame: pd.DataFrame, names: list[str]) -> Figure:
    """What a clear run and a plan cost."""
    figure, look = picture(7.09, 2.7), styles(names)
    table = levels(frame, names)
    panels, parts = figure.subplots(1, 3), sweeps(table.assign().pipe(_with_settings, frame))
    for axes, what in zip(panels, ("obstacles", "width", "obstacles"), strict=True):
        quiet(axes)
        axes.tick_params(labelsize=7.5)
        axes.set_xlabel(_AXES[what], fontsize=8)
        axes.set_xscale("log")
        axes.set_yscale("log")
        _plain_ticks(axes, parts[what], what)
    for axes, what in zip(panels[:2], ("obstacles", "width"), strict=True):
        part = parts[what].sort_values(what)
        for name in names:
            style, ert = look[name], part[f"{name}_ert"].to_numpy()
            axes.plot(
                part[what], np.where(np.isfinite(ert), ert, np.nan), style.marker + style.dash,
                color=style.color, ms=5, lw=1,
            )  # fmt: skip
            for x in part[what][~np.isfinite(ert)]:
                axes.annotate(
                    "∞", (x, 1), xycoords=("data", "axes fraction"), color=style.color,
                    fontsize=9, ha="center", va="top",
                )  # fmt: skip
        axes.set_ylabel("evaluations to a clear run", fontsize=8)
        log_axis(axes.yaxis)
    part = parts["obstacles"].dropna(subset=["seconds_plan"]).sort_values("obstacles")
    for column, said, marker, dash in (
        ("seconds_space", "map the free space", "s", "--"),
        ("seconds_plan", "plan", "o", "-"),
    ):
        panels[2].plot(
            part["obstacles"], part[column], marker + dash, color=INK, ms=4, lw=1, label=said
        )
    panels[2].set_ylabel("time (s)", fontsize=8)
    panels[2].legend(frameon=False, fontsize=7.5)
    if len(part):
        log_axis(panels[2].yaxis)
    _legend(figure, look)
    figure.set_label(
        "Left and middle: expected fitness evaluations until a first clear trajectory, by "
        "obstacles and by the width of the narrowest passage (median of a level); ∞: no run ends "
        "clear. Right: seconds to map the free space and to plan in it, on a busy machine."
    )
    return figure


def _with_settings(table: pd.DataFrame, frame: pd.DataFrame) -> pd.DataFrame:
    table.attrs["settings"] = frame.attrs["settings"]
    return table


def _plain_ticks(axes: Axes, part: pd.DataFrame, what: str) -> None:
    """The levels themselves; of widths, round numbers."""
    at = [0.03, 0.1, 0.2, 0.4, 0.8] if what == "width" else sorted(part[what].unique())
    axes.set_xticks(at, [f"{value:g}" for value in at])
    axes.minorticks_off()


def _legend(figure: Figure, look: dict[str, Style]) -> None:
    figure.legend(
        handles=[line_sample(style) for style in look.values()], loc="outside upper center",
        ncols=len(look), frameon=False, fontsize=7.5,
    )  # fmt: skip


def findings(frame: pd.DataFrame, names: list[str]) -> str:
    """What makes clear runs rarer, where the curve bends, and what plans come to."""
    odds = odds_table(frame, names).set_index(["algorithm", "step"])
    runs = frame.attrs["settings"]["runs"]
    said = [
        f"{len(frame)} scenes, {runs} runs of {frame.attrs['settings']['iterations']} iterations "
        "each, waypoints anywhere in the workspace."
    ]
    for name in names:
        clear, total = int(frame[f"{name}_clear"].sum()), int(frame[f"{name}_runs"].sum())
        parts = []
        for step in _STEPS:
            factor, low, high = odds.loc[(name, step)]
            if high < 1 or low > 1:
                text = "multiplies" if factor > 1 else "lowers"
                by = factor if factor > 1 else 1 / factor
                how = f"by {by:.1f}" if factor > 1 else f"to 1/{by:.1f}"
                parts.append(f"{step} {text} the odds of a clear run {how}")
            else:
                parts.append(f"{step} makes no difference that is told from none")
        bend = bend_of(sweeps(frame)["width"], name)
        said.append(
            f"{label(name)} ends clear in {clear} of {total} runs: {'; '.join(parts)}. {bend}"
        )
    tried = frame[frame["feasible"].notna()]
    if len(tried):
        good = int((tried["feasible"] == True).sum())  # noqa: E712
        low, high = share_interval(good, len(tried))
        gain = 100 * (1 - tried["fitness"] / tried["taut"])
        said.append(
            f"`js.plan`, which knows the free space, returns a certified plan in {good} of "
            f"{len(tried)} scenes (95 % interval {100 * low:.0f} to {100 * high:.0f} %), "
            f"{int((tried['attempts'] == 1).sum())} of them at the first attempt; its fitness is "
            f"{gain.median():.0f} % below that of the taut way in the median. Mapping the free "
            f"space takes {tried['seconds_space'].min():.1f} to "
            f"{tried['seconds_space'].max():.0f} s and planning "
            f"{tried['seconds_plan'].min():.1f} to {tried['seconds_plan'].max():.1f} s."
        )
    return " ".join(said)


def bend_of(part: pd.DataFrame, name: str) -> str:
    """The width at which half of the runs end clear, if it is among those drawn."""
    data = _by_width(part, name)
    slopes = [(curve.intercept, curve.slopes[0]) for curve in [fitted(*data), *resampled(*data)]]
    halves = np.array([2 ** (-a / b) if abs(b) > 1e-6 else np.nan for a, b in slopes])
    low, high = part["width"].min(), part["width"].max()
    if not (slopes[0][1] > 0 and low <= halves[0] <= high):
        return f"Its curve passes one half nowhere between {low:.2f} and {high:.2f} m of width."
    interval = np.nanquantile(halves[1:], [0.025, 0.975])
    return (
        f"Its curve passes one half at {halves[0]:.2f} m of width "
        f"(95 % interval {interval[0]:.2g} to {interval[1]:.2g} m)."
    )
