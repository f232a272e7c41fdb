"""A miniature of the study: both checks, judged densely, and the page."""

from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from experiments import pages
from experiments.artefacts import Artefacts
from experiments.contents import Work
from experiments.studies import cable_check as study
from experiments.studies import cable_cuts

pytestmark = pytest.mark.pages


@pytest.fixture(scope="module")
def folder(tmp_path_factory) -> Path:
    folder = tmp_path_factory.mktemp("cable-check")
    study.make(study.MINIATURE, Work(Artefacts(folder / "data"), folder / "parts", print))
    return folder


@pytest.fixture(scope="module")
def ds(folder) -> xr.Dataset:
    return Artefacts(folder / "data").dataset("cable-check")


def test_what_the_sound_check_calls_clear_it_counts_nothing_of(ds):
    sound = ds.sel(contacts="swept")
    assert (sound["swept"].where(sound["clear"], 0) == 0).all()


def test_what_is_in_an_obstacle_is_in_its_warning_area(ds):
    depth = np.maximum(ds["load_depth"], ds["cable_depth"])
    assert (ds["warning_depth"] > depth).all()


def test_the_checks_lead_to_other_runs(ds):
    sampled, swept = (ds["fitness"].sel(contacts=each).values for each in ("sampled", "swept"))
    assert (sampled != swept).any()


def test_a_jump_through_an_obstacle_is_seen_and_measured(ds):
    """As the page would tell it: of two clear runs one is made to cut by 0.2 m."""
    made = ds.copy(deep=True)
    made["clear"][:] = True
    made["cable_depth"][:] = -1.0
    made["load_depth"][:] = -1.0
    made["cable_depth"].loc[{"contacts": "sampled", "run": 0}] = 0.2
    table = cable_cuts.checks_table(made).set_index("contacts")
    assert table.loc["sampled", ["touching", "deepest"]].tolist() == [1, pytest.approx(0.2)]
    assert table.loc["swept", "touching"] == 0
    assert "0.200 m at most, by PSO" in cable_cuts.findings(made)


def test_the_page_is_drawn_from_it(folder):
    files = pages.write(
        "studies.cable_check", Artefacts(folder / "data"), folder / "site", folder / "more"
    )
    assert all(file.stat().st_size > 0 for file in files)
    assert "nan" not in files[0].read_text()
