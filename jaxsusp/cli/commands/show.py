"""`jaxsusp show`: scenes and plans in motion, as one page for a browser."""

from pathlib import Path
from typing import Annotated

import typer

from jaxsusp._files import require_file
from jaxsusp.cli.application import command, note
from jaxsusp.cli.options import checked, flag, require_choices

SUFFIXES = (".json", ".nc")
"""Of plans, comparisons and free spaces; anything else names a scenario."""


@command(epilog="Example: jaxsusp show results/scenario-1.plan.json --output plan.html --open")
def show(
    what: Annotated[
        list[str],
        typer.Argument(
            metavar="WHAT...",
            help="Scenarios, plans (*.plan.json), comparisons and free spaces (*.nc).",
            show_default=False,
        ),
    ],
    output: Annotated[
        Path,
        typer.Option(
            help="The page.", callback=checked(lambda name, path: require_file(name, path, ".html"))
        ),
    ] = Path("show.html"),
    regions: Annotated[
        bool, flag("--regions", "Compute free regions where nobody has yet; may take minutes.")
    ] = False,
    opened: Annotated[bool, flag("--open", "Open the page in the browser.")] = False,
) -> None:
    """Write a page that shows scenes, plans and runs in motion; it needs nothing but a browser."""
    require_choices([each for each in what if not each.lower().endswith(SUFFIXES)])

    from rich.console import Console

    from jaxsusp.optim import devices
    from jaxsusp.report.browser.page import show as page_of

    devices.configure()
    with Console(stderr=True).status("Reading …") as status:
        page = page_of(*what, path=output, regions=regions, progress=status.update)
    note(f"wrote {output} ({len(page.text) / 1e6:.1f} MB)")
    if opened:
        import webbrowser

        webbrowser.open(output.resolve().as_uri())
