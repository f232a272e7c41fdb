"""Make and draw, see the package's documentation."""

import argparse
import hashlib
import shutil
import sys
from importlib.metadata import version
from pathlib import Path
from typing import Any

from experiments import pages
from experiments.artefacts import Artefacts
from experiments.contents import NAMES, Module, Work, making, module
from jaxsusp._cache import code_digest
from jaxsusp.comparison.dataset import DECISIVE
from jaxsusp.errors import InputError
from jaxsusp.optim import devices

PARTS = Path("results") / "studies"


def told(line: str) -> None:
    """A line for a person who waits."""
    print(line, file=sys.stderr, flush=True)


def make(names, resume: bool) -> None:
    """Run what needs runs, one after the other; what is finished stays when one is interrupted."""
    artefacts = Artefacts()
    for name in names if len(names) < len(NAMES) else ():
        if not module(name).MINUTES:
            source = making(module(name).READ)
            told(
                f"{name}: nothing to make" + (f"; its data are made by {source}" if source else "")
            )
    todo = [name for name in names if module(name).MINUTES]
    if resume:
        todo = [name for name in todo if not current(module(name), artefacts)]
    there = f"; data go to {artefacts.folder}"
    told(f"{len(todo)} to make, about {duration_of(todo)} on two cores{there}")
    for number, name in enumerate(todo, 1):
        found = module(name)
        told(f"{number}/{len(todo)} {name}: about {found.MINUTES:g} min")
        parts = parts_of(name, found.FULL)
        found.make(found.FULL, Work(artefacts, parts, told))
        shutil.rmtree(parts, ignore_errors=True)  # who makes it again wants it anew


def current(found: Module, artefacts: Artefacts) -> bool:
    """Whether what a page's module makes is kept, and was made with its settings of today."""
    return not (artefacts.missing(found.MADE) or artefacts.differing(found.MADE, found.FULL))


def parts_of(name: str, settings: Any) -> Path:
    """A folder for what is finished of a page, with these settings, versions and package's code."""
    versions = [version(package) for package in DECISIVE]
    said = repr((settings, versions, code_digest("")))
    digest = hashlib.sha256(said.encode()).hexdigest()[:8]
    return PARTS / f"{pages.stem(name)}-{digest}"


def duration_of(names) -> str:
    """The minutes that making them takes."""
    return f"{sum(module(name).MINUTES for name in names):.0f} min"


def main() -> int:
    """Parse and do."""
    parser = argparse.ArgumentParser(
        prog="python -m experiments",
        description="The paper's tables and figures from our own results, and studies.",
        epilog="Example: python -m experiments make published.comparison",
    )
    parser.add_argument(
        "do",
        nargs="?",
        choices=["list", "make", "draw"],
        default="list",
        help="list: what there is, with minutes (the default); make: run what gives a page its "
        "data, kept in experiments/data; draw: write pages to docs/results and PDF, CSV and LaTeX "
        "to results/figures, from data that are kept",
    )
    parser.add_argument(
        "names", nargs="*", metavar="NAME",
        help="of a page as `list` prints it, such as studies.ablation; all where none is given",
    )  # fmt: skip
    parser.add_argument(
        "--resume",
        action="store_true",
        help="make only what is not kept yet; what was interrupted goes on in any case",
    )
    asked = parser.parse_args()
    try:
        names = asked.names or NAMES
        for name in names:
            module(name)
        if asked.do == "make":
            devices.configure()
            make(names, asked.resume)
        elif asked.do == "draw":
            pages.drawn(names, Artefacts(), told)
        else:
            for name in names:
                found = module(name)
                where = found.PRINTED or "study"
                print(f"{name:32} {where:12} {found.MINUTES:5.0f} min  {found.TITLE}")
    except InputError as error:
        told(f"Error: {error}")
        return 2
    except KeyboardInterrupt:
        told("Interrupted; what was finished is kept, the same command goes on.")
        return 130
    return 0


if __name__ == "__main__":
    sys.exit(main())
