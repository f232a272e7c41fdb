"""What becomes of time and memory when there is more to do, or more to do it with?"""

import hashlib
import json
import math
import os
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pandas as pd

import jaxsusp as js
from experiments.artefacts import Artefacts
from experiments.contents import Page, Work
from experiments.studies.scaling_figures import memory_figure, time_figure
from experiments.studies.scaling_fit import Law, fitted, surely_above, tenfold
from experiments.studies.scaling_point import Point, measured
from experiments.words import bulleted, listed
from jaxsusp._files import write_text
from jaxsusp.optim.devices import cores
from jaxsusp.report.render import Column, duration, significant

TITLE = "How it scales"
PRINTED = ""
DIFFERS = (
    "Ten times the runs, candidates, waypoints, samples or obstacles, two devices, workers: what "
    "does it cost in time and memory, where does a curve bend, and why?"
)
MADE = READ = ("scaling",)
MINUTES = 8.0

LIMIT = 11.0
"""What ten times the work may cost, in times the time; beyond it a reason is looked for."""

MIB = 2**20


class Settings(NamedTuple):
    """Sizes along every axis; what is not named stays as in `Point`."""

    runs: tuple[int, ...] = (1, 10, 100, 1000, 10_000)
    chunked: tuple[int, ...] = (1000, 10_000)
    chunk: int = 250
    population: tuple[int, ...] = (10, 30, 100, 300, 1000)
    waypoints: tuple[int, ...] = (2, 5, 10, 20, 40)
    samples: tuple[int, ...] = (20, 40, 80, 160, 320)
    obstacles: tuple[int, ...] = (6, 25, 50, 100, 200)
    devices: tuple[int, ...] = (1, 2)
    workers: tuple[int, ...] = (0, 1, 2)
    many: int = 2000  # runs where devices and workers are compared
    iterations: int = 10
    repeats: int = 5

    def points(self) -> list[tuple[str, int, dict[str, Any]]]:
        """Axis, size on it, and what a point is made of."""
        chunk = {"chunk": self.chunk}
        many = {"runs": self.many, **chunk}
        return [
            *(("runs", n, {"runs": n}) for n in self.runs),
            *(("runs in chunks", n, {"runs": n, **chunk}) for n in self.chunked),
            *(("population", n, {"population": n}) for n in self.population),
            *(("waypoints", n, {"waypoints": n}) for n in self.waypoints),
            *(("samples", n, {"samples": n}) for n in self.samples),
            *(("obstacles", n, {"obstacles": n}) for n in self.obstacles),
            *(("devices", n, {"devices": n, **many}) for n in self.devices),
            *(("workers", n, {"workers": n, **many}) for n in self.workers),
        ]


FULL = Settings()
MINIATURE = Settings(
    (1, 10), (), 250, (10, 20), (), (), (6,), (1,), (), many=10, iterations=3, repeats=2
)


def make(settings: Settings, work: Work) -> None:
    """A process for every point, one after the other; what is finished is kept."""
    folder = Path(work.folder)
    folder.mkdir(parents=True, exist_ok=True)
    machine = cores(), last_cache(), round(os.getloadavg()[0], 1)
    rows, points = [], settings.points()
    for number, (axis, size, parts) in enumerate(points, 1):
        work.told(f"  {number} of {len(points)}: {axis} {size}")
        rows.append(row_of(axis, size, parts, settings, folder))
    work.artefacts.keep("scaling", pd.DataFrame(rows), Kept(*settings, *machine))


class Kept(NamedTuple):
    """What is kept with the data: the settings, and what of the machine explains curves."""

    runs: tuple[int, ...]
    chunked: tuple[int, ...]
    chunk: int
    population: tuple[int, ...]
    waypoints: tuple[int, ...]
    samples: tuple[int, ...]
    obstacles: tuple[int, ...]
    devices: tuple[int, ...]
    workers: tuple[int, ...]
    many: int
    iterations: int
    repeats: int
    cores: int
    cache: int  # bytes of the last level, 0 where it is not known
    load: float  # of the machine before it began


def last_cache() -> int:
    """Bytes of the largest cache that a core has."""
    sizes = [0]
    for file in Path("/sys/devices/system/cpu/cpu0/cache").glob("index*/size"):
        text = file.read_text(encoding="utf-8").strip()
        sizes.append(int(text.rstrip("KM")) * {"K": 2**10, "M": 2**20}.get(text[-1], 1))
    return max(sizes)


def row_of(
    axis: str, size: int, parts: dict[str, Any], settings: Settings, folder: Path
) -> dict[str, Any]:
    """Measure a point."""
    parts = {"iterations": settings.iterations, "repeats": settings.repeats, **parts}
    count = parts.pop("obstacles", 0)
    scene = drawn(count, folder) if count else js.load_scenario(Point().scenario)
    if count:
        parts["scenario"] = str(folder / f"{count}.toml")
    point = Point(**{"devices": cores(), **parts})
    found = found_of(point, folder)
    return {
        "axis": axis, "size": size, "devices": point.devices, "obstacles": len(scene.obstacles),
        **found,
    }  # fmt: skip


def drawn(count: int, folder: Path) -> js.Scenario:
    """A random scene of so many obstacles, drawn once."""
    file = folder / f"{count}.toml"
    if not file.exists():
        write_text(file, js.random_scenario(0, count).to_toml())
    return js.load_scenario(file)


def found_of(point: Point, folder: Path) -> dict[str, Any]:
    """What is measured of a point: once, however many axes it is on."""
    text = repr(point._replace(scenario=Path(point.scenario).stem))
    file = folder / f"{hashlib.sha256(text.encode()).hexdigest()[:16]}.json"
    if not file.exists():
        write_text(file, json.dumps(measured(point)))
    return json.loads(file.read_text(encoding="utf-8"))


def draw(artefacts: Artefacts) -> Page:
    """Curves with their exponents, and a table of them."""
    frame = artefacts.frame("scaling")
    laws = {axis: laws_of(part) for axis, part in curves(frame).items()}
    figures = {
        "scaling": time_figure(curves(frame), {axis: law[0] for axis, law in laws.items()}, frame),
        "scaling-memory": memory_figure(
            curves(frame), {axis: law[1] for axis, law in laws.items()}
        ),
    }
    tables = {"scaling": law_table(frame, laws)}
    if len(hands := hands_table(frame)):
        tables["scaling-hands"] = hands
    return Page(figures, tables, findings(frame, laws))


def curves(frame: pd.DataFrame) -> dict[str, pd.DataFrame]:
    """The points of every axis of work."""
    found = {}
    for axis, part in frame.groupby("axis", sort=False):
        if axis not in ("devices", "workers") and len(part) > 1:
            found[str(axis)] = part.sort_values("size").reset_index(drop=True)
    return found


def laws_of(part: pd.DataFrame) -> tuple[Law, Law]:
    """Of time and of memory."""
    return fitted(part["size"], part["seconds"]), fitted(part["size"], part["memory"])


def law_table(frame: pd.DataFrame, laws: dict[str, tuple[Law, Law]]) -> pd.DataFrame:
    """A row per axis."""
    rows = []
    for axis, part in curves(frame).items():
        time, memory = laws[axis]
        rows.append(
            {
                "axis": axis,
                "range": f"{part['size'].min():,} to {part['size'].max():,}",
                "first": part["seconds"].iloc[0],
                "last": part["seconds"].iloc[-1],
                "time": interval(time),
                "bend": bend(part, time),
                "worst": tenfold(part["size"], part["seconds"]).max(),
                "least_memory": part["memory"].min() / MIB,
                "most_memory": part["memory"].max() / MIB,
                "memory": interval(memory),
            }
        )
    table = pd.DataFrame(rows)
    table.attrs["title"] = "Exponents"
    table.attrs["columns"] = {
        "axis": Column("more"),
        "range": Column("from, to"),
        "first": Column("least takes", duration),
        "last": Column("most takes", duration),
        "time": Column("exponent of time"),
        "bend": Column("bends at"),
        "worst": Column("ten times costs at most", lambda times: f"{times:.1f} ×"),
        "least_memory": Column("memory, least (MiB)", "{:.0f}".format),
        "most_memory": Column("most (MiB)", "{:.0f}".format),
        "memory": Column("exponent of memory"),
    }
    settings = frame.attrs["settings"]
    table.attrs["caption"] = (
        f"PSO on scenario 5 (obstacles: random scenes), {settings['iterations']} iterations of "
        f"{Point().runs} runs with {Point().population} candidates, where not said otherwise; "
        f"medians of up to {settings['repeats']} calls in a process of its own, compiled before. "
        "Exponents: fixed part + factor × sizeᵖ by least squares of logarithms, the fixed part "
        "only where an F test asks for it, with 95 % intervals. It bends where the fixed part is "
        "half. Memory is all of the process at its greatest while it computes. "
        f"{settings['cores']} cores, load of the machine before it began: {settings['load']:.1f}"
        + (", too much for times to be worth anything." if busy(settings) else ".")
    )
    return table


def busy(settings: dict[str, Any]) -> bool:
    """Whether the machine had other work when this was measured."""
    return settings["load"] > settings["cores"] / 2


def interval(law: Law) -> str:
    """An exponent with its interval."""
    if not law.grows:
        return "does not grow"
    if not math.isfinite(law.low):  # two points leave nothing to judge by
        return f"{law.exponent:.2f}"
    return f"{law.exponent:.2f} ({law.low:.2f} to {law.high:.2f})"


def bend(part: pd.DataFrame, law: Law) -> str:
    """Where the fixed part ends, if that is among the sizes."""
    inside = part["size"].min() <= law.bend <= part["size"].max()
    return f"{significant(law.bend, 2)}" if inside else "–"


def hands_table(frame: pd.DataFrame) -> pd.DataFrame:
    """Devices and workers."""
    rows = []
    for axis in ("devices", "workers"):
        part = frame[frame["axis"] == axis]
        for _, row in part.iterrows():
            first = row["size"] == part["size"].iloc[0]
            rows.append(
                {
                    "who": said(axis, int(row["size"])),
                    "seconds": row["seconds"],
                    "times": part["seconds"].iloc[0] / row["seconds"],
                    "least": 1.0 if first else part["least"].iloc[0] / row["most"],
                    "most": 1.0 if first else part["most"].iloc[0] / row["least"],
                }
            )
    table = pd.DataFrame(rows)
    table.attrs["title"] = "Devices and workers"
    table.attrs["columns"] = {
        "who": Column("computed by"),
        "seconds": Column("time", duration),
        "times": Column("times as fast", "{:.2f}".format),
        "least": Column("from", "{:.2f}".format),
        "most": Column("to", "{:.2f}".format),
    }
    settings = frame.attrs["settings"]
    table.attrs["caption"] = (
        f"{settings['many']} runs in chunks of {settings['chunk']}, {settings['cores']} cores. "
        "Devices: the searches alone; workers: a whole comparison, which evaluates again in double "
        "precision and puts together, by processes that are there already and share the cores. "
        "Each beside the first of its kind, from the slowest of one to the quickest of the other."
    )
    return table


def said(axis: str, size: int) -> str:
    """Who computes, in words."""
    if axis == "workers" and size == 0:
        return "comparison, this process"
    word = axis[:-1] if size == 1 else axis
    return f"{size} {word}"


def findings(frame: pd.DataFrame, laws: dict[str, tuple[Law, Law]]) -> str:
    """Exponents, bends with their reasons, and what costs more than it should."""
    parts, settings = curves(frame), frame.attrs["settings"]
    over = [text for axis, part in parts.items() for text in dear(axis, part, settings["cache"])]
    answer = (
        "Ten times the work costs at most "
        f"{max(tenfold(p['size'], p['seconds']).max() for p in parts.values()):.1f} times the time."
        if not over
        else f"Ten times the work costs more than {LIMIT:g} times the time in "
        f"{len(over)} place{'s' * (len(over) != 1)}."
    )
    times = [f"{axis} {law.exponent:.2f}" for axis, (law, _) in laws.items() if law.grows]
    flat = [axis for axis, (law, _) in laws.items() if not law.grows]
    bends = [text for axis, part in parts.items() if (text := why(axis, part, laws[axis][0]))]
    grown = [
        f"{axis} {part['memory'].min() / MIB:.0f} to {part['memory'].max() / MIB:.0f} MiB"
        for axis, part in parts.items()
        if laws[axis][1].grows
    ]
    still = [axis for axis in parts if not laws[axis][1].grows]
    return bulleted(
        answer,
        f"Time grows with the exponents {listed(times)}"
        + (f"; it does not grow with {listed(flat)}." if flat else "."),
        *bends,
        *over,
        chunks(parts, settings["chunk"]),
        f"Memory grows with {listed(grown)}"
        + (f"; it stays within 20 % with {listed(still)}." if still else "."),
        hands(frame),
    )


def chunks(parts: dict[str, pd.DataFrame], chunk: int) -> str:
    """What the same runs cost chunk by chunk, as a comparison computes them."""
    if not {"runs", "runs in chunks"} <= parts.keys():
        return ""
    beside = parts["runs"].merge(parts["runs in chunks"], on="size", suffixes=("", "_cut"))
    if beside.empty:
        return ""
    most = beside.loc[beside["size"].idxmax()]
    return (
        f"{int(most['size']):,} runs in chunks of {chunk}, as a comparison computes them, take "
        f"{most['seconds_cut'] / most['seconds']:.2f} times as long as in one batch, and "
        f"{most['memory_cut'] / MIB:.0f} instead of {most['memory'] / MIB:.0f} MiB."
    )


def why(axis: str, part: pd.DataFrame, law: Law) -> str:
    """Where a curve bends, and the reason."""
    if bend(part, law) == "–":
        return ""
    share = law.fixed / part["seconds"].iloc[0]
    reason = (
        "what an iteration costs however few candidates there are, and vectors that are not filled"
        if axis in ("runs", "population")
        else "what every candidate costs whatever is along its way: the search's own work"
        if axis == "samples"
        else "what samples and cables cost, which waypoints add nothing to"
        if axis == "waypoints"
        else "what a call costs"
    )
    return (
        f"The curve of {axis} bends at {significant(law.bend, 2)}: below it a fixed part of "
        f"{duration(law.fixed)} ({100 * share:.0f} % of the least) is more than half: {reason}."
    )


def dear(axis: str, part: pd.DataFrame, cache: int) -> list[str]:
    """Where ten times the work surely costs more than it may, with what explains it."""
    costs = tenfold(part["size"], part["seconds"])
    sure = surely_above(part["size"], part["least"], part["most"], LIMIT)
    said = []
    for i in np.flatnonzero((costs > LIMIT) & sure):
        low, high = part["size"][i], part["size"][i + 1]
        used = [(part["memory"][j] - part["memory"].min()) for j in (i, i + 1)]
        if 0 < cache <= used[1]:
            reason = (
                f"arrays grow by {used[1] / MIB:.0f} MiB beyond those of the least, the last cache "
                f"holds {cache / MIB:.0f} MiB"
            )
        else:
            reason = "no reason was found"
        said.append(
            f"From {low:,} to {high:,} {axis} ten times the work would cost {costs[i]:.1f} times "
            f"the time: {reason}."
        )
    return said


def hands(frame: pd.DataFrame) -> str:
    """What more devices and workers are worth."""
    rows = hands_table(frame)
    if rows.empty:
        return ""
    told = [
        f"{row.who} {row.times:.2f} times as fast ({row.least:.2f} to {row.most:.2f})"
        for row in rows.itertuples()
        if row.times != 1
    ]
    return f"Beside the first of their kind: {listed(told)}." if told else ""
