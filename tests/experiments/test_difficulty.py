"""A miniature of the study: scenes of two widths, planned and compared, and the page."""

from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from experiments import pages
from experiments.artefacts import Artefacts
from experiments.contents import Work
from experiments.studies import difficulty as study
from experiments.studies.difficulty_figures import cost_figure

pytestmark = pytest.mark.pages


@pytest.fixture(scope="module")
def folder(tmp_path_factory) -> Path:
    folder = tmp_path_factory.mktemp("difficulty")
    study.make(study.MINIATURE, Work(Artefacts(folder / "data"), folder / "parts", print))
    return folder


@pytest.fixture(scope="module")
def frame(folder) -> pd.DataFrame:
    return Artefacts(folder / "data").frame("difficulty")


def test_every_scene_is_of_its_level(frame):
    assert len(frame) == len(study.MINIATURE.draws()) == 4
    assert (frame["width"] >= frame["narrowest"]).all()
    assert (frame["width"] <= frame["widest"]).all()
    assert frame["feasible"].notna().sum() == 2


def test_no_more_runs_are_clear_than_there_are(frame):
    assert (frame["pso_clear"] <= frame["pso_runs"]).all()
    assert (frame["pso_spent"] <= frame["pso_runs"] * frame["pso_evaluations"]).all()


def test_the_page_is_drawn_from_it(folder):
    files = pages.write(
        "studies.difficulty", Artefacts(folder / "data"), folder / "site", folder / "more"
    )
    assert all(file.stat().st_size > 0 for file in files)


def test_a_bend_that_is_there_is_found():
    width = np.geomspace(0.05, 0.8, 30)
    clear = np.round(20 / (1 + (0.2 / width) ** 4))
    made = pd.DataFrame({"width": width, "pso_clear": clear, "pso_runs": 20})
    assert "one half at 0.20 m of width" in study.bend_of(made, "pso")
    flat = made.assign(pso_clear=20)
    assert "passes one half nowhere" in study.bend_of(flat, "pso")


def test_a_level_without_a_clear_run_has_its_sign_within_the_picture(frame):
    """Beyond the others' widths it took all the room, and no axes were left."""
    one = frame.copy()
    one.attrs = frame.attrs
    one["pso_clear"] = (one["narrowest"] == frame["narrowest"].max()).astype(int)
    figure = cost_figure(one, ["pso"])
    figure.draw_without_rendering()  # a layout that is given up is a warning, and that an error
    never = one.loc[one["pso_clear"] == 0, "width"].median()
    low, high = figure.axes[1].get_xlim()
    assert low < never < high
