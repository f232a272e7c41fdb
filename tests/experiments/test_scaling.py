"""Exponents, bends and reasons of the study of scaling, on curves that are known; a miniature."""

import numpy as np
import pandas as pd
import pytest
from scipy.optimize import curve_fit
from scipy.stats import linregress
from scipy.stats import t as student

from experiments import pages
from experiments.artefacts import Artefacts
from experiments.contents import Work
from experiments.studies import scaling as study
from experiments.studies.scaling_fit import fitted, surely_above, tenfold

SIZES = np.array([1.0, 10, 100, 300, 1000, 3000, 10_000])
RNG = np.random.default_rng(1)


def frame(axis: str, sizes, seconds, memory=1e9) -> pd.DataFrame:
    """A curve as the study keeps it."""
    made = pd.DataFrame(
        {
            "axis": axis, "size": np.asarray(sizes, int), "seconds": seconds, "least": seconds,
            "most": seconds, "memory": memory,
        }
    )  # fmt: skip
    made.attrs["settings"] = study.FULL._asdict() | {"cores": 2, "cache": 2**25, "load": 0.1}
    return made


@pytest.mark.fast
def test_a_power_law_has_the_interval_of_a_regression():
    costs = 3e-4 * SIZES**1.07 * np.exp(0.03 * RNG.normal(size=7))
    theirs = linregress(np.log(SIZES), np.log(costs))
    half = student.ppf(0.975, 5) * theirs.stderr
    law = fitted(SIZES, costs)
    assert law.fixed == law.bend == 0
    assert law.exponent == pytest.approx(theirs.slope)
    assert (law.low, law.high) == pytest.approx((theirs.slope - half, theirs.slope + half))
    assert law.low < 1.07 < law.high


@pytest.mark.fast
def test_a_fixed_part_is_found_where_there_is_one():
    costs = (0.05 + 2e-4 * SIZES**0.95) * np.exp(0.02 * RNG.normal(size=7))
    law = fitted(SIZES, costs)

    def model(x, fixed, factor, exponent):
        return np.log(np.exp(fixed) + np.exp(factor + exponent * np.log(x)))

    best, covariance = curve_fit(model, SIZES, np.log(costs), [-3, -8, 1])
    assert law.exponent == pytest.approx(best[2], rel=1e-3)
    half = student.ppf(0.975, 4) * np.sqrt(covariance[2, 2])
    assert law.high - law.exponent == pytest.approx(half, rel=1e-2)
    assert law.fixed == pytest.approx(0.05, rel=0.1)
    assert law.bend == pytest.approx((0.05 / 2e-4) ** (1 / 0.95), rel=0.2)
    np.testing.assert_allclose(law.at(SIZES), costs, rtol=0.1)


@pytest.mark.fast
def test_what_does_not_grow_has_no_exponent():
    law = fitted(SIZES, 2 + 0.05 * RNG.normal(size=7))
    assert not law.grows
    assert study.interval(law) == "does not grow"


@pytest.mark.fast
def test_ten_times_the_work_is_told_from_neighbours():
    assert tenfold([1, 10, 1000], [1, 11, 1100]) == pytest.approx([11, 10])
    assert surely_above([1, 10], [0.9, 14], [1.2, 16], 11).tolist() == [True]
    assert surely_above([1, 10], [0.9, 12], [1.2, 16], 11).tolist() == [False]


@pytest.mark.fast
def test_what_costs_too_much_is_told_with_its_reason():
    steep = frame("runs", [10, 100, 1000], [1e-3, 9e-3, 0.2], memory=[1e8, 1e8, 1e9])
    (text,) = study.dear("runs", steep, 2**25)
    assert "From 100 to 1,000 runs ten times the work would cost 22.2 times the time" in text
    assert "arrays grow by 858 MiB beyond those of the least, the last cache holds 32 MiB" in text
    (text,) = study.dear("runs", steep.assign(memory=1e8), 2**25)
    assert text.endswith("no reason was found.")
    assert study.dear("runs", frame("runs", [10, 100], [1.0, 10.5]), 2**25) == []


@pytest.mark.fast
def test_findings_say_what_curves_show():
    runs = frame("runs", SIZES, 0.05 + 2e-4 * SIZES)
    level = frame("samples", [20, 40, 80], [0.1, 0.105, 0.11])
    hands = frame("devices", [1, 2], [2.0, 1.0])
    made = pd.concat([runs, level, hands], ignore_index=True)
    made.attrs = runs.attrs
    laws = {axis: study.laws_of(part) for axis, part in study.curves(made).items()}
    said = study.findings(made, laws)
    assert said.startswith("Ten times the work costs at most 9.0 times the time.")
    assert "Time grows with the exponents runs 1.00; it does not grow with samples." in said
    assert "The curve of runs bends at 250: below it a fixed part of 50.0 ms" in said
    assert "2 devices 2.00 times as fast" in said


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    folder = tmp_path_factory.mktemp("scaling")
    study.make(study.MINIATURE, Work(Artefacts(folder / "data"), folder / "parts", print))
    return folder


@pytest.mark.pages
def test_a_miniature_is_measured_and_drawn(made):
    data = Artefacts(made / "data")
    rows = data.frame("scaling")
    assert rows["axis"].tolist() == ["runs"] * 2 + ["population"] * 2 + ["obstacles", "devices"]
    assert (rows["least"] <= rows["seconds"]).all()
    assert (rows["seconds"] <= rows["most"]).all()
    assert (rows["memory"] > 2**26).all()
    assert (rows["repeats"] == 2).all()
    files = pages.write("studies.scaling", data, made / "site", made / "more")
    assert all(file.stat().st_size > 0 for file in files)
