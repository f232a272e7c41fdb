"""Effects of the ablation with their intervals, as tables, picture and words."""

import json
from itertools import combinations
from typing import Any

import numpy as np
import pandas as pd
import xarray as xr
from matplotlib.figure import Figure
from scipy.stats import rankdata

from experiments.changes import found_nothing
from experiments.words import between, bulleted, counted, listed, signed
from jaxsusp.report.drawing.intervals import Estimates, Look, rows_of_intervals
from jaxsusp.report.drawing.style import legend, panels, picture
from jaxsusp.report.render import Column, plain, significant, two_decimals
from jaxsusp.studies.ablation import VARIANTS, Switches
from jaxsusp.studies.factorial import effect
from jaxsusp.studies.resampling import crossed_interval, last, logarithm, mean_of

BUDGETS = ("iterations", "evaluations")
FACTORS = Switches._fields
SHORT = dict(zip(FACTORS, ("opposition", "sine-cosine", "pull", "stability"), strict=True))
EQUATIONS = dict(zip(FACTORS, ("Eq. 13", "Eq. 14–16", "Eq. 17", "Eq. 18, 19"), strict=True))
ALL = "all four"
PAIRS = [*combinations(range(len(FACTORS)), 2)]
SETS = {"six": "the six scenarios", "random": "random scenes"}
MEASURES = {"rank": "rank", "fitness": "fitness (%)", "clear": "clear runs (points)"}
"""What is compared. Rank: of the sixteen in a scene and run, 1 the best. Fitness: its logarithm,
told as the change in per cent. Clear: share of runs without collision and violation."""


def label(made: Switches) -> str:
    """What a variant is called: the improvements that are made."""
    names = [SHORT[name] for name, on in made._asdict().items() if on]
    return {0: "none", len(FACTORS): "all"}.get(len(names), " + ".join(names))


def measured(ds: xr.Dataset) -> dict[str, np.ndarray]:
    """The measures of one budget, each (scene, run, variant)."""
    ds = ds.sel(variant=[label(made) for made in VARIANTS])
    order = ("scenario", "run", "variant")
    fitness = ds["fitness"].transpose(*order).values
    faults = (ds["collisions"] + ds["violations"]).transpose(*order).values
    return {
        "rank": rankdata(last(fitness), axis=-1),
        "fitness": logarithm(fitness),
        "clear": 100.0 * (faults == 0),
    }


def effects_of(sets: dict[str, xr.Dataset]) -> pd.DataFrame:
    """Every effect with its 95 % interval, a row per set of scenes, budget and effect."""
    rows = []
    for name, ds in sets.items():
        for budget in BUDGETS:
            values = measured(ds.sel(budget=budget))
            for told, of in _effects():
                row: dict[str, Any] = {"scenes": name, "budget": budget, "effect": told}
                for measure, each in values.items():
                    cells = of(each)
                    low, high = crossed_interval(cells, scenes_vary=name == "random")
                    found = np.array([mean_of(cells), low, high])
                    found = 100 * np.expm1(found) if measure == "fitness" else found
                    keys = (measure, f"{measure}_low", f"{measure}_high")
                    row |= dict(zip(keys, found.tolist(), strict=True))
                rows.append(row)
    return pd.DataFrame(rows)


def _effects():
    """Names of all effects and how they are formed from (…, variant)."""
    count = len(FACTORS)
    for i, factor in enumerate(FACTORS):
        yield SHORT[factor], lambda y, i=i: effect(y, [i], count)
    yield ALL, lambda y: y[..., -1] - y[..., 0]
    for i, j in PAIRS:
        name = f"{SHORT[FACTORS[i]]} × {SHORT[FACTORS[j]]}"
        yield name, lambda y, i=i, j=j: effect(y, [i, j], count)


def main_table(found: pd.DataFrame, sets: dict[str, xr.Dataset]) -> pd.DataFrame:
    """What each improvement is worth by itself, and all of them together."""
    names = [*SHORT.values(), ALL]
    frame = _shown(found[found["effect"].isin(names)])
    cost = _cost(next(iter(sets.values())))
    frame.insert(3, "cost", [cost[each] for each in frame["effect"]])
    frame.attrs["columns"]["cost"] = Column("evaluations (%)", lambda share: signed(100 * share))
    equations = [f"{short} is {EQUATIONS[name]}" for name, short in SHORT.items()]
    frame.attrs["title"] = "What each improvement is worth"
    made = json.loads(next(iter(sets.values())).attrs["settings"])
    frame.attrs["caption"] = (
        f"{made['iterations']} iterations or as many evaluations as DBO needs for them, "
        f"{made['runs']} runs on each of the six scenarios, {made['runs_of_random']} on each "
        "random scene. Change when an improvement comes on, in the mean over all combinations of "
        "the other three "
        f"({ALL}: SDBO against DBO), and the 95 % interval of a bootstrap over runs and, for the "
        "random scenes, over scenes. Rank among the sixteen variants in one scene and run, 1 the "
        "best; fitness: change of its geometric mean in %; clear: change of the share of clear "
        "runs in percentage points; evaluations: what it costs at equal iterations. Below 0 is "
        f"better, of clear runs above 0. {listed(equations)}."
    )
    return frame


def pair_table(found: pd.DataFrame) -> pd.DataFrame:
    """By how much two of them change each other's effect."""
    frame = _shown(found[found["effect"].str.contains("×")])
    frame.attrs["title"] = "What two improvements change in each other"
    frame.attrs["caption"] = (
        "Effect of either where the other is on minus that where it is off, as above; in fitness, "
        "the ratio of the two changes. Above 0 in rank and fitness, below it in clear runs: "
        "together they are worth less than each by itself says."
    )
    return frame


def variant_table(sets: dict[str, xr.Dataset]) -> pd.DataFrame:
    """All sixteen variants."""
    rows = []
    for name, ds in sets.items():
        values = {budget: measured(ds.sel(budget=budget)) for budget in BUDGETS}
        for i, made in enumerate(VARIANTS):
            row: dict[str, Any] = {"scenes": SETS[name], "variant": label(made)}
            for budget, each in values.items():
                spent = ds["evaluations"].sel(budget=budget, variant=label(made)).values
                row |= {
                    f"{budget}_spent": int(spent.flat[0]),
                    f"{budget}_rank": each["rank"][..., i].mean(),
                    f"{budget}_fitness": np.exp(mean_of(each["fitness"][..., i])),
                    f"{budget}_clear": each["clear"][..., i].mean(),
                }
            rows.append(row)
    frame = pd.DataFrame(rows)
    looks = {
        "spent": ("evaluations", plain), "rank": ("rank", two_decimals),
        "fitness": ("fitness", significant), "clear": ("clear (%)", lambda x: f"{x:.0f}"),
    }  # fmt: skip
    frame.attrs["columns"] = {
        f"{budget}_{key}": Column(f"equal {budget}: {text}" if key == "spent" else text, write)
        for budget in BUDGETS
        for key, (text, write) in looks.items()
    }
    frame.attrs["title"] = "All variants"
    frame.attrs["caption"] = "Mean rank, geometric mean of the fitness and share of clear runs."
    return frame


def _cost(ds: xr.Dataset) -> dict[str, float]:
    """What improvements add to the evaluations of DBO at equal iterations, as shares."""
    spent = ds["evaluations"].sel(budget="iterations").isel(scenario=0)
    base = float(spent.sel(variant="none"))
    names = {**{short: short for short in SHORT.values()}, ALL: "all"}
    return {told: float(spent.sel(variant=name)) / base - 1 for told, name in names.items()}


def _shown(found: pd.DataFrame) -> pd.DataFrame:
    """Numbers for people: an estimate and its interval beside each other."""
    frame = found.reset_index(drop=True)
    frame["scenes"] = frame["scenes"].map(SETS)
    frame["budget"] = "equal " + frame["budget"]
    frame.attrs["columns"] = {
        name: Column(text, lambda value: signed(value, 2))
        for measure, heading in MEASURES.items()
        for name, text in (
            (measure, heading), (f"{measure}_low", "from"), (f"{measure}_high", "to"),
        )
    }  # fmt: skip
    return frame


def figure(found: pd.DataFrame) -> Figure:
    """Every improvement's effect on rank, fitness and clear runs."""
    names = [*SHORT.values(), ALL]
    drawing = picture(7.09, 3.4)
    axes = panels(drawing, len(MEASURES), sharey=True)
    looks = {
        ("six", "iterations"): Look("six scenarios, equal iterations", "#0072B2", "o"),
        ("six", "evaluations"): Look("equal evaluations", "#0072B2", "o", filled=False),
        ("random", "iterations"): Look("random scenes, equal iterations", "#C43C00", "D"),
        ("random", "evaluations"): Look("equal evaluations", "#C43C00", "D", filled=False),
    }
    indexed = found.set_index(["scenes", "budget", "effect"]).sort_index()
    there = [key for key in looks if key[0] in set(found["scenes"])]
    for panel, (measure, heading) in zip(axes, MEASURES.items(), strict=True):
        series = []
        for key in there:
            part = indexed.loc[key].loc[names]
            columns = (part[each].to_numpy() for each in _with_bounds(measure))
            series.append(Estimates(looks[key], *columns))
        rows_of_intervals(panel, names, series)
        better = "→ better" if measure == "clear" else "← better"
        panel.set_xlabel(f"change of {heading}\n{better}", fontsize=8.0)
    legend(drawing, [looks[key].sample for key in there], size=8.0, columns=2)
    drawing.set_label(
        "What changes when an improvement comes on, in the mean over all combinations of the "
        f"others, and, {ALL}, from DBO to SDBO; lines: 95 % intervals. Rank is among the sixteen "
        "variants, fitness the change of its geometric mean, clear runs in percentage points."
    )
    return drawing


def _with_bounds(measure: str) -> tuple[str, str, str]:
    return measure, f"{measure}_low", f"{measure}_high"


def findings(found: pd.DataFrame, sets: dict[str, xr.Dataset]) -> str:
    """What is so, by rank, in words."""
    said = []
    for name, ds in sets.items():
        where = f"On {SETS[name]}" if name == "six" else f"On {ds.sizes['scenario']} {SETS[name]}"
        for budget in BUDGETS:
            rows = found[(found["scenes"] == name) & (found["budget"] == budget)]
            rows = rows.set_index("effect")
            said.append(f"{where}, at equal {budget}, {_whole(rows)}; {_each(rows)}.")
    base = [*sets.values()][-1]
    extra = _cost(base)
    dear = [
        f"{name} ({signed(100 * extra[name])} %)" for name in SHORT.values() if extra[name] > 0.05
    ]
    return bulleted(
        _answer(found),
        *said,
        f"Evaluations at equal iterations are what {listed(dear)} cost.",
        _pairs(found),
        found_nothing(*sets.values()),
        "Intervals are 95 % each, not corrected for their number.",
    )


def _answer(found: pd.DataFrame) -> str:
    """Which improvements help, and which harm, by rank on all scenes and in both budgets."""
    verdicts = {
        name: {_verdict(row) for _, row in found[found["effect"] == name].iterrows()}
        for name in [*SHORT.values(), ALL]
    }
    words = {
        "helps": "what surely helps is", "makes it worse": "what surely makes it worse is",
        "open": "not told from nothing is",
    }  # fmt: skip
    whole = verdicts.pop(ALL)
    first = {
        "helps": "SDBO ranks before DBO", "makes it worse": "SDBO ranks behind DBO",
        "open": "SDBO's rank cannot be told from DBO's",
    }[whole.pop() if len(whole) == 1 else "open"]  # fmt: skip
    told = [
        f"{words[key]} {listed(names)}"
        for key in words
        if (names := [name for name, each in verdicts.items() if each == {key}])
    ]
    mixed = [name for name, each in verdicts.items() if len(each) > 1]
    told += [f"what differs between them is {listed(mixed)}"] if mixed else []
    return f"By rank, on all scenes and in both budgets, {first}; of its parts, {'; '.join(told)}."


def _verdict(row: pd.Series) -> str:
    """Whether an interval leaves a sign open."""
    if row["rank_low"] > 0:
        return "makes it worse"
    return "helps" if row["rank_high"] < 0 else "open"


def _whole(rows: pd.DataFrame) -> str:
    row = rows.loc[ALL]
    rank = f"{signed(row['rank'])} ({between(row['rank_low'], row['rank_high'])})"
    change = f"{signed(row['fitness'])} % ({between(row['fitness_low'], row['fitness_high'])})"
    clear = f"{signed(row['clear'])} points ({between(row['clear_low'], row['clear_high'])})"
    verdict = {
        "helps": "SDBO is better than DBO",
        "makes it worse": "SDBO is worse than DBO",
        "open": "SDBO cannot be told from DBO by its rank",
    }[_verdict(row)]
    alone = _by_rank_alone(row)
    return f"{verdict}{alone and f' {alone}'}: rank {rank}, fitness {change}, clear runs {clear}"


def _by_rank_alone(row: pd.Series) -> str:
    """Where only the rank tells, that it does."""
    if _verdict(row) == "open":
        return ""
    unsure = {
        what
        for what, measure in (("fitness", "fitness"), ("clear runs", "clear"))
        if row[f"{measure}_low"] <= 0 <= row[f"{measure}_high"]
    }
    told = [what for what in ("fitness", "clear runs") if what in unsure]
    if not told:
        return ""
    return f"by rank; {listed(told)} {'leave' if 'clear runs' in told else 'leaves'} it open"


def _each(rows: pd.DataFrame) -> str:
    groups: dict[str, list[str]] = {"helps": [], "makes it worse": [], "open": []}
    for name in SHORT.values():
        row = rows.loc[name]
        changes = f"{signed(row['rank'])} ranks, fitness {signed(row['fitness'])} %"
        alone = _by_rank_alone(row)
        groups[_verdict(row)].append(f"{name} ({changes}{alone and f': {alone}'})")
    words = {
        "helps": ("what helps is", ""),
        "makes it worse": ("what makes it worse is", ""),
        "open": ("not to be told from nothing:", ""),
    }
    parts = [f"{words[key][0]} {listed(names)}" for key, names in groups.items() if names]
    return ", ".join(parts)


def _pairs(found: pd.DataFrame) -> str:
    """How many pairs change each other, and the strongest of them."""
    pairs = found[found["effect"].str.contains("×")]
    sure = pairs[[_verdict(row) != "open" for _, row in pairs.iterrows()]]
    if not len(sure):
        return f"Of {counted(len(pairs), 'interaction')} of two none can be told from nothing."
    row = sure.loc[sure["rank"].abs().idxmax()]
    way = "less than" if row["rank"] > 0 else "more than"
    return (
        f"{len(sure)} of {counted(len(pairs), 'interaction')} of two can be told from nothing, "
        "each interval by itself; the "
        f"strongest is {row['effect']} on {SETS[row['scenes']]} at equal {row['budget']}, where "
        f"both together are worth {way} each by itself says ({signed(row['rank'])} ranks)."
    )
