"""Which setting decides what a search finds: Sobol indices of its results."""

import itertools
import warnings
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

import jax
import numpy as np
import pandas as pd
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from scipy.stats import rankdata, spearmanr

import jaxsusp as js
from experiments.artefacts import Artefacts
from experiments.contents import Page, Work
from experiments.words import bulleted, listed
from jaxsusp._files import atomic_path
from jaxsusp.comparison.bestknown import best_known
from jaxsusp.optim.registry import algorithm as algorithm_of
from jaxsusp.report.drawing.style import INK, QUIET, picture, quiet
from jaxsusp.report.render import Column, two_decimals
from jaxsusp.studies.settings import Found, run_settings

TITLE = "Which settings matter"
PRINTED = ""
DIFFERS = (
    "The paper sets population, waypoints, samples, weights and κ once. How much of the variance "
    "of what a search finds is due to each of them, alone and together with the others, and how "
    "much to luck?"
)
MADE = READ = ("sensitivity",)
MINUTES = 6.0

WEIGHTS = ("w1", "w2", "w3", "w4", "w5")
FACTORS = ("population", "waypoints", "samples", *WEIGHTS, "kappa", "luck")
TERMS = ("f1", "f2", "f3", "f4", "f5")
RULER = 5, 40
"""Waypoints of the best known fitness, and samples at which all trajectories are measured."""


class Settings(NamedTuple):
    """Levels of what a compiled program is for; weights and κ go from 1/spread to spread times."""

    scenario: str = "scenario-5"
    algorithm: str = "pso"
    populations: tuple[int, ...] = (15, 30, 60)
    waypoints: tuple[int, ...] = (3, 5, 8)
    samples: tuple[int, ...] = (20, 40, 80)
    spread: float = 10.0
    base: int = 32  # N of the design: (factors + 2) N settings are run
    runs: int = 4  # of every setting
    iterations: int = 200
    together: int = 16  # settings in a batch
    seed: int = 0

    @property
    def levels(self) -> tuple[tuple[int, ...], ...]:
        """Of the first three factors."""
        return self.populations, self.waypoints, self.samples


FULL = Settings()
MINIATURE = Settings("scenario-1", "pso", (30,), (5,), (40,), 10.0, 2, 2, 20)


def problem_of(settings: Settings) -> dict:
    """The design's factors in SALib's words, each uniform in [0, 1)."""
    return {"num_vars": len(FACTORS), "names": [*FACTORS], "bounds": [[0.0, 1.0]] * len(FACTORS)}


def design(settings: Settings) -> pd.DataFrame:
    """Saltelli's design: a row per setting, columns as the searches understand them."""
    from SALib.sample import sobol as sampler

    rows = sampler.sample(
        problem_of(settings), settings.base, calc_second_order=False, seed=settings.seed
    )
    unit = pd.DataFrame(rows, columns=FACTORS)
    frame = pd.DataFrame(index=unit.index)
    for name, levels in zip(FACTORS, settings.levels, strict=False):
        frame[name] = np.array(levels)[(unit[name] * len(levels)).astype(int)]
    spread = settings.spread ** (2 * unit[[*WEIGHTS, "kappa"]] - 1)
    frame[[*WEIGHTS]] = spread[[*WEIGHTS]]
    frame["kappa"] = 1000 * spread["kappa"]
    frame["luck"] = (unit["luck"] * 2**20).astype(int)  # which runs of the algorithm these are
    return frame


def make(settings: Settings, work: Work) -> None:
    """Run the design, shape by shape."""
    frame, task = design(settings), js.load_scenario(settings.scenario)
    Path(work.folder).mkdir(parents=True, exist_ok=True)
    rows = {}
    shapes = list(itertools.product(*settings.levels))
    for number, shape in enumerate(shapes, 1):
        part = frame[(frame[[*FACTORS[:3]]] == [*shape]).all(axis=1)]
        if part.empty:
            continue
        kept = Path(work.folder) / f"{'-'.join(map(str, shape))}.csv"
        if not kept.exists():
            work.told(f"shape {number}/{len(shapes)}: {len(part)} settings {shape}")
            found = pd.concat(measured(task, settings, shape, part))
            with atomic_path(kept) as scratch:
                found.to_csv(scratch, index_label="row")
        rows |= pd.read_csv(kept, index_col="row").to_dict("index")
    found = frame.join(pd.DataFrame.from_dict(rows, orient="index").sort_index())
    work.artefacts.keep("sensitivity", found.round(6), settings)


def measured(task, settings: Settings, shape, part: pd.DataFrame) -> Iterator[pd.DataFrame]:
    """What the runs of settings of one shape found, a batch after the other."""
    population, waypoints, samples = shape
    problem = js.Problem.from_scenario(task, waypoints, samples, dtype=np.float32)
    for first in range(0, len(part), settings.together):
        batch = part.iloc[first : first + settings.together]
        filled = batch.iloc[np.resize(np.arange(len(batch)), settings.together)]  # one program
        runs = filled["luck"].to_numpy()[:, None] * settings.runs + np.arange(settings.runs)
        found = run_settings(
            problem, algorithm_of(settings.algorithm), filled[[*WEIGHTS, "kappa"]].to_numpy(),
            runs, settings.iterations, population, settings.seed,
        )  # fmt: skip
        yield described(task, problem, found, filled).iloc[: len(batch)]


def described(task, problem: js.Problem, found: Found, batch: pd.DataFrame) -> pd.DataFrame:
    """Terms of the best run of every setting by one ruler, and how many runs are clear."""
    with jax.enable_x64(True):
        own = _terms(problem.fitness, found.x.astype(np.float64))
        ruler = js.Problem.from_scenario(task, *RULER, search="box").fitness
        measured = _terms(ruler, found.x.astype(np.float64))
    faults = np.asarray(own.collisions + own.violations)
    rows, best = np.arange(len(batch)), found.fitness.argmin(axis=1)
    smooth = np.stack([np.asarray(term) for term in measured[:5]], axis=-1)[rows, best]
    frame = pd.DataFrame(smooth, columns=TERMS, index=batch.index)
    frame["clear"] = (faults == 0).mean(axis=1)
    default = smooth @ np.array(task.fitness.weights[:5])
    default += task.fitness.weights[5] * task.fitness.kappa * faults[rows, best]
    known = best_known(task, *RULER)
    frame["excess"] = default / known if known else np.nan
    return frame


@jax.jit
def _terms(fitness, x):
    """Of decision vectors (settings, runs, D)."""
    flat = fitness.terms(x.reshape(-1, x.shape[-1]).T)
    return jax.tree.map(lambda leaf: leaf.reshape(x.shape[:-1]), flat)


OUTPUTS = {
    "f1": "length f₁",
    "f2": "height f₂",
    "f3": "cables f₃",
    "f4": "tension rate f₄",
    "f5": "curvature f₅",
    "excess": "excess",
    "clear": "clear runs",
}
SAID = {
    "population": "population", "waypoints": "waypoints", "samples": "samples", "w1": "w₁",
    "w2": "w₂", "w3": "w₃", "w4": "w₄", "w5": "w₅", "kappa": "κ", "luck": "luck",
}  # fmt: skip


def draw(artefacts: Artefacts) -> Page:
    """First and total indices of every result, with intervals."""
    frame = artefacts.frame("sensitivity")
    settings = Settings(**frame.attrs["settings"])
    found = indices(frame, settings)
    figures = {"sensitivity": picture_of(found)}
    tables = {
        "sensitivity-total": matrix(found, "total", "Total indices", "alone or with others"),
        "sensitivity-first": matrix(found, "first", "First-order indices", "alone"),
    }
    return Page(figures, tables, findings(frame, found, settings))


def indices(frame: pd.DataFrame, settings: Settings) -> pd.DataFrame:
    """A row per result and factor: first and total index, half-widths, and which way it goes."""
    from SALib.analyze import sobol

    rows = []
    for output in OUTPUTS:
        values = frame[output].to_numpy(float)
        values = values if output == "clear" else rankdata(values)  # outliers rule nothing
        if not np.isfinite(values).all() or np.ptp(values) < 1e-12:
            rows += [(output, factor, *[np.nan] * 5) for factor in FACTORS]
            continue
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # of resamples in which nothing varies: NaN
            found = sobol.analyze(
                problem_of(settings), values, calc_second_order=False, num_resamples=1000,
                conf_level=0.95, seed=1,  # SALib takes 0 for none
            )  # fmt: skip
        for i, factor in enumerate(FACTORS):
            numbers = [found[key][i] for key in ("S1", "S1_conf", "ST", "ST_conf")]
            same = frame[factor].nunique() == 1
            way = np.nan if same else spearmanr(frame[factor], values).statistic
            rows.append((output, factor, *numbers, way))
    columns = ["output", "factor", "first", "first_half", "total", "total_half", "way"]
    return pd.DataFrame(rows, columns=columns)


def picture_of(found: pd.DataFrame) -> Figure:
    """A panel per result: factors below one another, both indices with their intervals."""
    figure = picture(7.09, 3.5)
    panels = figure.subplots(1, len(OUTPUTS), sharey=True, sharex=True)
    places = np.arange(len(FACTORS))[::-1]
    for axes, (output, said) in zip(panels, OUTPUTS.items(), strict=True):
        quiet(axes)
        axes.tick_params(labelsize=7)
        rows = found[found["output"] == output].set_index("factor").loc[[*FACTORS]]
        for index, up, color, marker, fill in (
            ("total", 0.17, "#0072B2", "s", "white"),
            ("first", -0.17, "#C43C00", "o", "#C43C00"),
        ):
            axes.errorbar(
                rows[index], places + up, xerr=rows[f"{index}_half"], fmt=marker, ms=4, mfc=fill,
                mec=color, ecolor=color, elinewidth=1.1, color=color,
            )  # fmt: skip
        axes.axvline(0, color=QUIET, lw=0.8)
        axes.set_title(said, fontsize=7.5, color=INK)
        axes.set_xlim(-0.35, 1.45)
        axes.set_xticks([0, 0.5, 1], ["0", "½", "1"])
    panels[0].set_yticks(places, [SAID[name] for name in FACTORS])
    panels[0].set_ylim(-0.6, len(FACTORS) - 0.4)
    figure.supxlabel("share of the variance", fontsize=8, color=INK)
    samples = [
        Line2D(
            [], [], color="#0072B2", marker="s", mfc="white", label="total: alone or with others"
        ),
        Line2D([], [], color="#C43C00", marker="o", label="first order: alone"),
    ]
    figure.legend(handles=samples, loc="outside upper center", ncols=2, frameon=False, fontsize=7.5)
    figure.set_label(
        "Sobol indices with 95 % bootstrap intervals (cut where they leave the panel) of the "
        "ranks of f₁ to f₅ and of the excess, the default fitness over the best known, of the best "
        "run of a setting, and of its share of clear runs. Luck is which runs these are."
    )
    return figure


def matrix(found: pd.DataFrame, index: str, title: str, said: str) -> pd.DataFrame:
    """Factors by results."""
    frame = found.pivot(index="factor", columns="output", values=index)
    half = found.pivot(index="factor", columns="output", values=f"{index}_half")
    frame, half = (each.loc[[*FACTORS], [*OUTPUTS]] for each in (frame, half))
    sure = [
        (row, output)
        for row, factor in enumerate(FACTORS)
        for output in OUTPUTS
        if frame.at[factor, output] > half.at[factor, output]
    ]
    frame = frame.rename(index=SAID).rename_axis("factor").reset_index()
    frame.attrs["title"] = title
    frame.attrs["columns"] = {
        output: Column(f"{said}", _written) for output, said in OUTPUTS.items()
    }
    frame.attrs["bold"] = frozenset(sure)
    frame.attrs["caption"] = (
        f"Share of the variance of a result that is due to a factor {said}; bold where it is "
        "above the half-width of its own 95 % bootstrap interval. Half-widths: "
        f"{two_decimals(half.stack().median())} in the median, "
        f"{two_decimals(half.max(axis=None))} at most."
    )
    return frame


def _written(index: float) -> str:
    return two_decimals(index).replace("-", "−")


def findings(frame: pd.DataFrame, found: pd.DataFrame, settings: Settings) -> str:
    """What decides which result, how much is luck, and how wide the intervals are."""
    said, luck = [], found[found["factor"] == "luck"].set_index("output")["total"]
    for output, name in OUTPUTS.items():
        rows = found[found["output"] == output].set_index("factor")
        if rows["total"].isna().all():
            said.append(f"{name}: does not vary.")
            continue
        most = rows["first"].drop("luck").idxmax()
        text = (
            f"{name}: most by {SAID[most]} alone ({interval(rows, most, 'first')}), "
            f"{'rising' if rows.at[most, 'way'] > 0 else 'falling'} with it"
            if rows.at[most, "first"] > rows.at[most, "first_half"]
            else f"{name}: no factor alone is told from nothing"
        )
        below = rows["total"] <= rows.at["luck", "total"]
        few = [SAID[each] for each in FACTORS if each != "luck" and not below[each]]
        text += f"; in total above luck: {', '.join(few)}" if few else "; in total none above luck"
        said.append(f"{text}.")
    halves = found[["first_half", "total_half"]]
    alone, total = map(two_decimals, halves.median())
    return bulleted(
        _answer(found, settings),
        f"{settings.algorithm.upper()} on {settings.scenario}, {settings.iterations} iterations, "
        f"{settings.runs} runs of each of {len(frame)} settings (Saltelli's design of base "
        f"{settings.base}); weights and κ from {1 / settings.spread:g} to {settings.spread:g} "
        "times their defaults, every trajectory measured by one ruler of "
        f"{RULER[1]} samples.",
        *(text[0].upper() + text[1:] for text in said),
        f"The intervals are wide: half-widths of {alone} (first) and {total} (total) in the "
        "median and of "
        f"{two_decimals(halves.max(axis=None))} at most. An index says something only where it is "
        f"above its own half-width (bold in the tables). {_beyond(found)}",
        "Which runs a setting is given is a "
        "factor of its own, luck; where a search hangs on every digit of its settings, so that "
        "each change is like another draw, every factor's total index holds that much of luck "
        f"as well, and only what is above it (point estimates) is the factor's own doing: luck's "
        f"is {two_decimals(luck.min())} to {two_decimals(luck.max())}.",
        "The share of clear runs is "
        f"{100 * frame['clear'].mean():.0f} % over all settings, the median excess "
        f"{100 * (frame['excess'].median() - 1):.0f} %.",
    )


def _answer(found: pd.DataFrame, settings: Settings) -> str:
    """For which of the results which factor alone decides most, as far as intervals tell."""
    where = f"For {settings.algorithm.upper()} on one scenario, {settings.scenario}, "
    rows = found[(found["factor"] != "luck") & (found["first"] > found["first_half"])]
    if rows.empty:
        return f"{where}no factor alone is told from nothing."
    most = rows.loc[rows.groupby("output", sort=False)["first"].idxmax()]
    told = [
        f"{SAID[factor]} for {listed([OUTPUTS[each] for each in part['output']])}"
        for factor, part in most.groupby("factor", sort=False)
    ]
    return f"{where}the factor that alone decides most is {listed(told)}."


def _beyond(found: pd.DataFrame) -> str:
    """Shares above the whole are no shares."""
    above = found[(found["first"] > 1) | (found["total"] > 1)]
    told = [f"{SAID[row.factor]} for {OUTPUTS[row.output]}" for row in above.itertuples()]
    return (
        f"An index above 1 ({listed(told)}) is an artefact of the estimate from so few settings, "
        "no share." if told else ""
    )  # fmt: skip


def interval(rows: pd.DataFrame, factor: str, index: str) -> str:
    """An index with its half-width: 0.45 ± 0.12."""
    return (
        f"{two_decimals(rows.at[factor, index])} ± {two_decimals(rows.at[factor, f'{index}_half'])}"
    )
