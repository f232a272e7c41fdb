"""A small comparison against runs that were stored, as far as another processor may round.

    python tests/comparison/test_stored_runs.py

stores them anew. On one kind of processor runs are the same to the last digit. On another one they
part after some iterations, as every comparison of two candidates may fall the other way; what they
begin with, and how they are distributed, may not change.
"""

import json
import sys
from pathlib import Path

import numpy as np
import pytest
from scipy.stats import ks_2samp

import jaxsusp as js
from jaxsusp.optim.choices import PUBLISHED

STORED = Path(__file__).with_suffix(".json")
SCENARIOS = ("scenario-1", "scenario-5")
SETTINGS = {"runs": 20, "iterations": 40, "population": 20, "seed": 0, "search": "box"}

FIRST = 1e-5
"""Of the best of the first population, relative: one evaluation in float32."""

LEVEL = 1e-4
"""Of a Kolmogorov-Smirnov test for each of eight distributions."""

MEDIAN = 1.3
"""Factor within which medians lie."""


def compared() -> dict[str, dict[str, list[list[float]]]]:
    """Best of the first population and of all, of every run, by scenario and algorithm."""
    ds = js.compare(SCENARIOS, PUBLISHED, **SETTINGS)
    first = ds["history"].isel(iteration=0).astype(np.float64)
    return {
        scenario: {
            algorithm: [
                each.sel(scenario=scenario, algorithm=algorithm).values.tolist()
                for each in (first, ds["fitness"])
            ]
            for algorithm in PUBLISHED
        }
        for scenario in SCENARIOS
    }


@pytest.fixture(scope="module")
def found():
    return compared()


@pytest.mark.parametrize("algorithm", PUBLISHED)
@pytest.mark.parametrize("scenario", SCENARIOS)
def test_runs_are_those_that_were_stored(found, scenario, algorithm):
    first, last = np.array(found[scenario][algorithm])
    first_then, last_then = np.array(json.loads(STORED.read_text("utf-8"))[scenario][algorithm])
    np.testing.assert_allclose(first, first_then, rtol=FIRST)
    assert ks_2samp(last, last_then).pvalue > LEVEL
    assert 1 / MEDIAN < np.median(last) / np.median(last_then) < MEDIAN


def test_the_comparison_tells_algorithms_apart():
    """What it says of one algorithm, it does not say of another: it can fail."""
    stored = json.loads(STORED.read_text("utf-8"))["scenario-1"]
    pso, dbo = (np.array(stored[name][1]) for name in ("pso", "dbo"))
    assert ks_2samp(pso, dbo).pvalue < LEVEL
    assert np.median(dbo) / np.median(pso) > MEDIAN


if __name__ == "__main__":
    STORED.write_text(json.dumps(compared(), indent=1) + "\n", encoding="utf-8")
    sys.stderr.write(f"{STORED}\n")
