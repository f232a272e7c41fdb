"""Table 1: the four algorithms on the six scenarios, beside the printed table."""

from typing import NamedTuple

import jaxsusp as js
from experiments.artefacts import Artefacts
from experiments.contents import Page, Work
from jaxsusp.optim.choices import PUBLISHED
from jaxsusp.report.comparison.tables import comparison_table, ratio_table

TITLE = "Comparison of the algorithms"
PRINTED = "Table 1"
DIFFERS = (
    "The paper prints no coordinates of obstacles: ours are six scenarios of our own, so ratios "
    "and rankings compare, absolute values do not."
)
MADE = READ = ("comparison",)
MINUTES = 2.0


class Settings(NamedTuple):
    """Of `jaxsusp.compare`."""

    scenarios: tuple[str, ...] = js.scenarios()
    algorithms: tuple[str, ...] = (*PUBLISHED, "cmaes", "routed")
    runs: int = 20
    iterations: int = 500
    population: int = 30
    seed: int = 0


FULL = Settings()
MINIATURE = Settings(("scenario-1",), ("pso", "dbo", "sdbo"), 2, 20)


def make(settings: Settings, work: Work) -> None:
    """One comparison; it is what Figs. 7, 11 and 12 are drawn from, too."""
    ds = js.compare(**settings._asdict(), output=work.folder, resume=True)
    work.artefacts.keep("comparison", ds)


def draw(artefacts: Artefacts) -> Page:
    """Our table, and our ratios beside the printed ones."""
    ds = artefacts.comparison("comparison")
    ours, ratios = comparison_table(ds), ratio_table(ds)
    return Page({}, {"table-1": ours, "table-1-ratios": ratios})
