"""Every number that the pages of results print is recomputed from the data that is kept."""

import itertools
import re

import numpy as np
import pytest
import xarray as xr

from experiments import contents, pages
from experiments.__main__ import parts_of
from experiments.artefacts import Artefacts
from jaxsusp.errors import InputError
from jaxsusp.report.latex import to_latex
from jaxsusp.report.render import shown_columns

pytestmark = pytest.mark.pages


@pytest.mark.parametrize("name", contents.NAMES)
def test_a_page_says_what_its_data_say(name):
    """`make figures` writes it anew."""
    found = contents.module(name)
    page = found.draw(Artefacts())
    kept = (pages.SITE / f"{pages.stem(name)}.md").read_text(encoding="utf-8")
    assert pages.text_of(name, found, page) == kept
    assert all(pages.said(figure) for figure in page.figures.values())
    for frame in page.tables.values():
        written = to_latex(frame)
        assert written.isascii(), [each for each in written if not each.isascii()]
        assert "`" not in written.replace("``", "")
        rows = [line for line in written.splitlines() if line.endswith(r" \\")]
        columns = len(shown_columns(frame))
        assert {len(re.findall(r"(?<!\\)&", row)) for row in rows[-len(frame) :]} == {columns - 1}
    for each in page.figures:
        assert (pages.SITE / "images" / f"{each}.png").exists()


@pytest.mark.parametrize("page", sorted(pages.SITE.glob("*.md")), ids=lambda page: page.stem)
def test_rows_of_a_table_have_as_many_cells_as_its_heading(page):
    lines = page.read_text(encoding="utf-8").splitlines()
    for table, rows in itertools.groupby(lines, lambda line: line.startswith("|")):
        if table:
            cells = {len(re.findall(r"(?<!\\)\|", row)): row for row in rows}
            assert len(cells) == 1, cells


def test_the_index_lists_every_page(tmp_path):
    assert pages.write_index(tmp_path).read_text(encoding="utf-8") == (
        pages.SITE / "index.md"
    ).read_text(encoding="utf-8")


def test_names_are_modules_that_say_what_they_are():
    for name in contents.NAMES:
        found = contents.module(name)
        assert found.TITLE
        assert found.DIFFERS
        assert found.__doc__
        assert bool(found.MINUTES) == hasattr(found, "make") == bool(found.MADE)


def test_what_is_missing_names_the_page_that_makes_it(tmp_path):
    with pytest.raises(InputError, match=r"make published\.ends` \(about 3 min\) makes it"):
        Artefacts(tmp_path).frame("ends")
    assert contents.maker("comparison") == "published.comparison"
    motion = pages.commands("published.motion", contents.module("published.motion"))
    assert "make published.comparison" in motion


def test_a_page_with_less_than_before_says_so(tmp_path):
    page = tmp_path / "page.md"
    assert pages.shown(page) == []
    page.write_text("# Title\n\n## A table\n\n![A [b] (c).](images/some.png)\n", encoding="utf-8")
    assert pages.shown(page) == ["A table", "images/some.png"]


@pytest.mark.fast
@pytest.mark.parametrize("name", contents.NAMES)
def test_what_is_kept_was_made_with_the_settings_of_its_module(name):
    found = contents.module(name)
    assert Artefacts().missing(found.MADE) == []
    if found.MADE:
        assert Artefacts().differing(found.MADE, found.FULL) == []


def test_another_setting_is_told_and_has_parts_of_its_own():
    found = contents.module("studies.budgets")
    other = found.FULL._replace(runs=3)
    assert Artefacts().differing(found.MADE, other) == ["runs = 20 in budgets, 3 now"]
    assert parts_of("studies.budgets", other) != parts_of("studies.budgets", found.FULL)


def test_what_other_code_had_finished_is_not_taken_over(monkeypatch):
    before = parts_of("studies.scaling", contents.module("studies.scaling").FULL)
    monkeypatch.setattr("experiments.__main__.code_digest", lambda *rooms: "of other code")
    assert parts_of("studies.scaling", contents.module("studies.scaling").FULL) != before


def test_what_is_read_is_made_before():
    made: set[str] = set()
    for name in contents.NAMES:
        found = contents.module(name)
        made |= {*found.MADE}
        assert {*found.READ} <= made, name


class Holed(Artefacts):
    """What is kept, but the first run of everything found nothing."""

    def dataset(self, name):
        ds = super().dataset(name).copy(deep=True)
        ds["fitness"][dict.fromkeys(ds["fitness"].dims, 0)] = np.inf
        return ds


@pytest.mark.parametrize("name", ["ablation", "budgets", "origin", "spaces"])
def test_a_run_that_found_nothing_empties_no_sentence(name):
    text = contents.module(f"studies.{name}").draw(Holed()).findings
    assert "found nothing" in text
    assert not re.search(r"[+−]–|\bnan\b|\binf\b", text)


@pytest.mark.parametrize(
    "name",
    ["claims.ledger", *(f"published.{each}" for each in ("convergence", "motion", "towing"))],
)
def test_a_page_says_what_its_comparison_lacks(name, tmp_path):
    for each in {*contents.module(name).READ}:
        for file in Artefacts().folder.glob(f"{each}.*"):
            (tmp_path / file.name).write_bytes(file.read_bytes())
    ds = xr.load_dataset(tmp_path / "comparison.nc", engine="h5netcdf")
    ds.isel(scenario=slice(1, None)).to_netcdf(tmp_path / "comparison.nc", engine="h5netcdf")
    with pytest.raises(
        InputError, match=r"holds no scenario scenario-1.*make published\.comparison"
    ):
        contents.module(name).draw(Artefacts(tmp_path))
