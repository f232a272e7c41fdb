"""What was measured as tables: for the terminal, and as Markdown for people and for the site."""

from pathlib import Path
from statistics import median
from typing import Any

import pandas as pd

from jaxsusp._files import write_text
from jaxsusp.report.render import Column, evaluations, significant, to_markdown

KEPT = Path(__file__).parents[1] / "data" / "peers.json"
"""What the page of the site is written from."""

PAGE = Path(__file__).parents[2] / "docs" / "howto" / "peers.md"
BEGIN, END = "<!-- measured: written by benchmarks/peers -->\n", "<!-- end of measured -->\n"

SINGLE = "¹"


def frames(numbers: dict[str, Any]) -> list[pd.DataFrame]:
    """A table per scenario; ours stands above the peers that are measured beside it."""
    return [_frame(name, rows, numbers) for name, rows in numbers["scenarios"].items()]


def _frame(scenario: str, rows: list[dict[str, Any]], numbers: dict[str, Any]) -> pd.DataFrame:
    lines = []
    for beside in dict.fromkeys(row["beside"] for row in rows):
        peers = [row for row in rows if row["beside"] == beside]
        lines.append(_line(beside, _ours([row["ours"] for row in peers]), numbers))
        for row in peers:
            label = f"{row['library']}:{row['name']}{SINGLE if row['single'] else ''}"
            ratios = {"ratio": row["ratio"], "per": row["ratio_per_evaluation"]}
            lines.append(_line(label, row["peer"], numbers) | ratios)
    frame = pd.DataFrame(lines)
    ours = frame["ratio"].isna()
    frame.attrs = {
        "title": f"{scenario}: ours, and others beside it",
        "caption": caption(numbers),
        "columns": _COLUMNS,
        "bold": {(row, "optimiser") for row in frame.index[ours]},
    }
    return frame


def _ours(measured: list[dict[str, Any]]) -> dict[str, Any]:
    """Ours as it was measured beside several: they differ in time alone."""
    times = {name: median(each[name] for each in measured) for name in ("seconds", "microseconds")}
    return measured[0] | times


def _line(label: str, found: dict[str, Any], numbers: dict[str, Any]) -> dict[str, Any]:
    return {
        "optimiser": label,
        "seconds": found["seconds"],
        "ratio": float("nan"),
        "microseconds": found["microseconds"],
        "per": float("nan"),
        "evaluations": found["evaluations"],
        "best": found["best"],
        "mean": found["mean"],
        "clear": found["clear"],
        "runs": numbers["settings"]["runs"],
    }


def _times(ratio: float) -> str:
    return "" if ratio != ratio else f"{significant(ratio, 2)} ×"


def _short(number: float) -> str:
    return significant(number, 3)


_COLUMNS = {
    "optimiser": Column("optimiser"),
    "seconds": Column("seconds", _short),
    "ratio": Column("ratio", _times),
    "microseconds": Column("µs/eval.", _short),
    "per": Column("ratio/eval.", _times),
    "evaluations": Column("evals/run", evaluations),
    "best": Column("best", significant),
    "mean": Column("mean", significant),
}


def caption(numbers: dict[str, Any]) -> str:
    """How it was measured, in words."""
    chosen, machine = numbers["settings"], numbers["machine"]
    versions = ", ".join(f"{name} {each}" for name, each in numbers["versions"].items())
    cores = "one core" if machine["cores"] == 1 else f"{machine['cores']} cores"
    others = (
        f" Other work was on the machine (load {machine['load']:.1f}, {machine['there']} cores)."
        if machine["load"] > 0.5
        else ""
    )
    time = "the processor's" if machine["cores"] == 1 else "those on the wall"
    return (
        f"{chosen['runs']} runs of {chosen['iterations']} iterations of {chosen['population']} "
        f"candidates on {cores} ({machine['processor']}), after compilation. Seconds are {time}, "
        f"the median of {chosen['repeats']} turns, each of ours and then the peer; the ratio is "
        f"that of the peer's to ours, the median of the turns' own.{others} Ours and evosax make "
        "all runs at once; the others, in NumPy or C++, make one after the other, as they are "
        "used, and call our compiled fitness for every population; those marked "
        f"{SINGLE} can only ask for one candidate at a time. Best and mean of the runs are our "
        "fitness in float64, evaluations are counted by us, and a run is clear if nothing touches "
        f"and no limit is violated. {versions}."
    )


def markdown(numbers: dict[str, Any]) -> str:
    """All tables, with the caption below each."""
    parts = [f"### {frame.attrs['title']}\n\n{to_markdown(frame)}" for frame in frames(numbers)]
    return "\n".join(parts)


def page(numbers: dict[str, Any], text: str) -> str:
    """The page of the site with these numbers in place of those it has."""
    before, _, rest = text.partition(BEGIN)
    return f"{before}{BEGIN}\n{markdown(numbers)}\n{END}{rest.partition(END)[2]}"


def write_page(numbers: dict[str, Any]) -> None:
    """Write the numbers into the page of the site."""
    write_text(PAGE, page(numbers, PAGE.read_text(encoding="utf-8")))
