"""What is told of a GPU beside a CPU, on numbers that agree and on those that do not."""

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from benchmarks import gpu

ROOT = Path(__file__).parents[1]

RNG = np.random.default_rng(2)
COUNT = 500


@pytest.fixture
def cpu() -> dict:
    """Of a machine: terms of size one and ten, counts, and runs."""
    found = {f"scene/{key}": RNG.uniform(0, 10, COUNT) for key in gpu.TERMS}
    found |= {f"scene/{key}": RNG.integers(0, 3, COUNT) for key in gpu.COUNTS}
    found |= {"scene/steady": RNG.random(COUNT) < 0.9, "scene/runs": RNG.gamma(2, 1, 200)}
    return {**found, "card": "2 × cpu", "seconds/pso/20": 1.0, "evaluations/pso/20": 10**6}


@pytest.fixture
def card(cpu) -> dict:
    """Of another one that agrees but for rounding."""
    rounded = {key: value * (1 + 4e-6) for key, value in cpu.items() if key[6:] in gpu.TERMS}
    runs = {"scene/runs": RNG.gamma(2, 1, 200), "card": "1 × H", "seconds/pso/20": 0.01}
    return {**cpu, **rounded, **runs}


@pytest.mark.fast
def test_what_agrees_is_told(cpu, card):
    (row,) = gpu.agreement(cpu, card).itertuples()
    assert row.ok
    assert row.apart == pytest.approx(4e-6, rel=1e-3)
    assert (row.counts, row.near) == (0, 0)
    assert row.steady == cpu["scene/steady"].sum()


@pytest.mark.fast
def test_a_term_a_count_and_runs_that_differ_are_told(cpu, card):
    length = card["scene/length"].copy()
    length[3] += 2e-5 * max(length[3], 1)
    (row,) = gpu.agreement(cpu, {**card, "scene/length": length}).itertuples()
    assert (row.ok, row.term) == (False, "length")
    near = np.flatnonzero(~cpu["scene/steady"])[0]
    far = np.flatnonzero(cpu["scene/steady"])[0]
    for place, counts, ok in ((near, 0, True), (far, 1, False)):
        other = card["scene/collisions"].copy()
        other[place] += 1
        (row,) = gpu.agreement(cpu, {**card, "scene/collisions": other}).itertuples()
        assert (row.counts, row.ok) == (counts, ok)
    worse = {**card, "scene/runs": card["scene/runs"] + 1}
    assert not gpu.agreement(cpu, worse)["ok"].any()


@pytest.mark.fast
def test_speed_is_by_card(cpu, card):
    frame = gpu.speed(cpu, card)
    assert frame["times"].tolist() == pytest.approx([100])
    assert frame["rate"].tolist() == pytest.approx([100])
    assert frame.attrs["columns"]["gpu"].label == "1 × H"


def test_terms_of_one_device_are_those_of_the_same_device():
    first, again = (gpu.terms_of("scenario-1", 200) for _ in range(2))
    for key in (*gpu.TERMS, *gpu.COUNTS):
        np.testing.assert_array_equal(first[key], again[key])
    assert 0 < first["steady"].mean() <= 1
    assert (first["collisions"] == 0).any()
    assert (first["collisions"] > 0).any()


def test_without_a_gpu_it_is_one_message_before_anything_is_measured():
    command = [sys.executable, "-m", "benchmarks.gpu"]
    done = subprocess.run(command, capture_output=True, text=True, check=False, cwd=ROOT)
    if "NVIDIA" in done.stdout:
        pytest.skip("there is one")
    assert done.returncode == 2
    told = done.stderr.strip().splitlines()[-1]
    assert told.startswith('device = "gpu": JAX computes on')
