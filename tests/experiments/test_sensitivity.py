"""A miniature of the study: its design, its runs, and what is said of them."""

from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from experiments import pages
from experiments.artefacts import Artefacts
from experiments.contents import Work
from experiments.studies import sensitivity as study

pytestmark = pytest.mark.pages


@pytest.fixture(scope="module")
def folder(tmp_path_factory) -> Path:
    folder = tmp_path_factory.mktemp("sensitivity")
    study.make(study.MINIATURE, Work(Artefacts(folder / "data"), folder / "parts", print))
    return folder


def test_every_setting_is_run_and_measured(folder):
    frame, settings = Artefacts(folder / "data").frame("sensitivity"), study.MINIATURE
    assert len(frame) == (len(study.FACTORS) + 2) * settings.base
    assert frame[[*study.TERMS, "excess"]].to_numpy().min() > 0
    assert frame["clear"].isin(np.arange(settings.runs + 1) / settings.runs).all()
    assert frame[[*study.WEIGHTS]].to_numpy().min() >= 1 / settings.spread
    assert frame[[*study.WEIGHTS]].nunique().min() > 1


def test_what_is_finished_is_not_run_again(folder, monkeypatch):
    monkeypatch.setattr(study, "run_settings", None)
    study.make(study.MINIATURE, Work(Artefacts(folder / "data"), folder / "parts", print))


def test_the_page_is_drawn_from_it(folder):
    files = pages.write(
        "studies.sensitivity", Artefacts(folder / "data"), folder / "site", folder / "more"
    )
    assert all(file.stat().st_size > 0 for file in files)
    text = files[0].read_text()
    assert "nan" not in text
    assert "24 settings" in text


def test_indices_of_a_known_function_are_found(monkeypatch):
    """f1 = w1² and nothing else: its variance is due to w1 alone, that of f2 to luck."""
    settings = study.FULL._replace(base=256)
    frame = study.design(settings)
    frame = frame.assign(**dict.fromkeys([*study.TERMS, "excess", "clear"], 1.0))
    frame["f1"], frame["f2"] = frame["w1"] ** 2, 1 + frame["luck"] * 7919 % 1000
    found = study.indices(frame, settings).set_index(["output", "factor"])
    assert found.loc[("f1", "w1"), "first"] == pytest.approx(1, abs=0.05)
    assert found.loc[("f1", "w1"), "way"] == pytest.approx(1)
    assert found.loc[("f1", "w2"), "total"] == pytest.approx(0, abs=0.02)
    assert found.loc[("f2", "luck"), "total"] == pytest.approx(1, abs=0.2)
    assert found.loc["clear", "total"].isna().all()
    assert isinstance(frame, pd.DataFrame)
