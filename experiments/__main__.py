"""Make and draw, see the package's documentation."""

import argparse
import sys
from pathlib import Path

from experiments import pages
from experiments.artefacts import Artefacts
from experiments.contents import NAMES, Work, module
from jaxsusp.errors import InputError
from jaxsusp.optim import devices

PARTS = Path("results") / "studies"


def told(line: str) -> None:
    """A line for a person who waits."""
    print(line, file=sys.stderr, flush=True)


def make(names, resume: bool) -> None:
    """Run what needs runs, one after the other; what is finished stays when one is interrupted."""
    artefacts = Artefacts()
    todo = [name for name in names if module(name).MINUTES]
    if resume:
        todo = [name for name in todo if artefacts.missing(module(name).MADE)]
    told(f"{len(todo)} to make, about {duration_of(todo)} on two cores")
    for number, name in enumerate(todo, 1):
        found = module(name)
        told(f"{number}/{len(todo)} {name}: about {found.MINUTES:g} min")
        folder = PARTS / pages.stem(name)
        found.make(found.FULL, Work(artefacts, folder, told))


def duration_of(names) -> str:
    """The minutes that making them takes."""
    return f"{sum(module(name).MINUTES for name in names):.0f} min"


def main() -> int:
    """Parse and do."""
    parser = argparse.ArgumentParser(
        prog="python -m experiments",
        description="The paper's tables and figures from our own results, and studies.",
    )
    parser.add_argument("do", nargs="?", choices=["list", "make", "draw"], default="list")
    parser.add_argument("names", nargs="*", metavar="NAME", help="all where none is given")
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
