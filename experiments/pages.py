"""Pages of the site, pictures and tables of a page, all from data that is kept."""

import re
import time
from pathlib import Path

import pandas as pd
from matplotlib.figure import Figure

from experiments.artefacts import Artefacts
from experiments.contents import NAMES, Module, Page, making, module
from jaxsusp._files import atomic_path, write_text
from jaxsusp.report.drawing.style import save
from jaxsusp.report.latex import to_latex
from jaxsusp.report.render import Column, to_csv, to_markdown

SITE = Path(__file__).parents[1] / "docs" / "results"
"""Where pages are kept, with their pictures: what people read on the site."""

MORE = Path("results") / "figures"
"""Where the same pictures go as PDF and the tables as CSV and LaTeX, for papers."""


def stem(name: str) -> str:
    """The file of a page: "studies.ablation" → "ablation"."""
    return name.rpartition(".")[2].replace("_", "-")


def text_of(name: str, found: Module, page: Page) -> str:
    """A page of the site as Markdown."""
    printed = f"**{found.PRINTED} of the paper.** " if found.PRINTED else ""
    parts = [f"# {found.TITLE}", printed + found.DIFFERS, page.findings]
    parts += [
        f"![{said(figure)}](images/{each}.png)\n\n*{said(figure)}*"
        for each, figure in page.figures.items()
    ]
    tables = page.tables.values()
    shown = [f"## {frame.attrs['title']}\n\n{to_markdown(frame)}" for frame in tables]
    parts += [page.body] if page.body else shown
    parts.append(commands(name, found))
    return "\n\n".join(part.strip() for part in parts if part) + "\n"


def said(figure: Figure) -> str:
    """The caption that a figure carries as its label."""
    return str(figure.get_label())


def commands(name: str, found: Module) -> str:
    """The commands behind a page's numbers."""
    lines = []
    if found.MINUTES:
        lines.append(
            f"Made by `python -m experiments make {name}` in about {found.MINUTES:g} minutes on "
            "two cores."
        )
    elif source := making(found.READ):
        lines.append(f"Its data are made by {source} on two cores.")
    lines.append(f"Drawn by `python -m experiments draw {name}`.")
    return " ".join(lines)


def write(name: str, artefacts: Artefacts, site: Path = SITE, more: Path = MORE) -> list[Path]:
    """Draw a page and write all that belongs to it.

    Args:
        name: of a module.
        artefacts: the data that is kept.
        site: a folder for the page and its pictures.
        more: a folder for PDF, CSV and LaTeX.

    Returns:
        The files written.
    """
    found = module(name)
    page = found.draw(artefacts)
    (site / "images").mkdir(parents=True, exist_ok=True)
    more.mkdir(parents=True, exist_ok=True)
    files = [site / f"{stem(name)}.md"]
    write_text(files[0], text_of(name, found, page))
    for each, figure in page.figures.items():
        files += [site / "images" / f"{each}.png", more / f"{each}.pdf"]
        save(figure, files[-2])
        with atomic_path(files[-1]) as scratch:
            figure.savefig(scratch, format="pdf", metadata={"CreationDate": None})
    for each, frame in page.tables.items():
        files += [more / f"{each}.csv", more / f"{each}.tex", more / f"{each}.md"]
        to_csv(frame, files[-3])
        write_text(files[-2], to_latex(frame, f"tab:{each}"))
        write_text(files[-1], to_markdown(frame))
    return files


def table_of_contents() -> pd.DataFrame:
    """What there is: page, where the paper has it, how it differs, command, minutes."""
    rows = []
    for name in NAMES:
        found = module(name)
        rows.append(
            {
                "page": f"[{found.TITLE}]({stem(name)}.md)",
                "in the paper": found.PRINTED or "–",
                "what differs, or is asked": found.DIFFERS,
                "command": f"`python -m experiments make {name}`" if found.MINUTES else "–",
                "minutes": found.MINUTES,
            }
        )
    frame = pd.DataFrame(rows)
    frame.attrs["columns"] = {"minutes": Column("minutes", "{:g}".format)}
    return frame


def write_index(site: Path = SITE) -> Path:
    """The page that lists all others."""
    total = sum(module(name).MINUTES for name in NAMES)
    toctree = "\n".join(["```{toctree}", ":hidden:", "", *map(stem, NAMES), "```"])
    text = f"""# Results

The paper's tables and figures from our own results, and studies of what is true. `make figures`
draws all of it from data that is kept in `experiments/data`; `make studies` makes those data anew,
in about {total:.0f} minutes on two cores. Every number on these pages is recomputed from the data
by the tests.

{to_markdown(table_of_contents())}
{toctree}
"""
    path = site / "index.md"
    write_text(path, text)
    return path


def drawn(names, artefacts: Artefacts, told) -> None:
    """Write pages and say how long each took."""
    for name in names:
        clock, before = time.perf_counter(), shown(SITE / f"{stem(name)}.md")
        files = write(name, artefacts)
        told(f"{name}: {len(files)} files, {time.perf_counter() - clock:.1f} s")
        if gone := [each for each in before if each not in shown(files[0])]:
            told(f"  which leaves out what the page had before: {', '.join(gone)}")
    write_index()
    told(f"pages and their pictures are in {SITE}; PDF, CSV, LaTeX and Markdown are in {MORE}")


def shown(page: Path) -> list[str]:
    """Headings of tables and files of pictures on a page; none where it is not there."""
    text = page.read_text(encoding="utf-8") if page.exists() else ""
    return re.findall(r"^(?:## |!\[.*\]\()(.*?)\)?$", text, re.MULTILINE)
