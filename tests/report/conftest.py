"""A small synthetic comparison whose every statistic can be checked by hand."""

import numpy as np
import pytest
import xarray as xr

ALGORITHMS = ["pso", "ga", "dbo", "sdbo"]
SCENARIOS = ["scenario-1", "scenario-5"]
TERMS = ["length", "height", "cable", "tension_rate", "curvature", "penalty"]


@pytest.fixture
def comparison() -> xr.Dataset:
    """Two scenarios, four algorithms, four runs, five iterations (three for sdbo).

    The fitness of algorithm a (0 … 3) in scenario s (0, 1) is base·(1, 2, 3, 6) with
    base = 100 (s + 1)·(4 - a): minimum base, maximum 6 base, mean 3 base, and squared deviations
    (4 + 1 + 0 + 9) base², so a sample variance of 14/3 base². Every run of dbo in scenario-1
    collides, and so does the last run of everything. No best fitness is known.
    """
    base = 100.0 * np.array([1, 2])[:, None] * np.array([4, 3, 2, 1])
    fitness = base[..., None] * np.array([2.0, 1.0, 3.0, 6.0])
    collisions = np.zeros((2, 4, 4), int)
    collisions[..., 3] = 2
    collisions[0, 2, :] = 1
    violations = np.zeros_like(collisions)
    terms = np.zeros((2, 4, 4, len(TERMS)))
    terms[..., 0] = fitness / 50
    terms[..., 1] = fitness / 10
    decay = np.array([16.0, 8.0, 4.0, 2.0, 1.0])
    history = (fitness[..., None] * decay).astype(np.float32)
    history[:, 3, :, 3:] = np.nan
    history[:, 3, :, 2] = fitness[:, 3]
    t = np.linspace(0, 1, 40)
    position = np.empty((2, 4, 40, 3))
    for a in range(4):
        position[:, a, :, 0] = 0.5 * (a - 1.5) * np.sin(np.pi * t)
        position[:, a, :, 1] = 2 - 4 * t
        position[:, a, :, 2] = 1 + 2 * t
    by_pair = ("scenario", "algorithm")
    by_run = (*by_pair, "run")
    acted = np.full((2, 4), np.nan)
    acted[:, 3] = [0.4, 0.25]
    return xr.Dataset(
        {
            "fitness": (by_run, fitness),
            "terms": ((*by_run, "term"), terms),
            "collisions": (by_run, collisions),
            "violations": (by_run, violations),
            "x": ((*by_run, "variable"), np.zeros((2, 4, 4, 15))),
            "history": ((*by_run, "iteration"), history),
            "position": ((*by_pair, "sample", "axis"), position),
            "evaluations": (by_pair, np.tile([150, 150, 150, 300], (2, 1))),
            "evaluations_initial": (by_pair, np.zeros((2, 4), int)),
            "evaluations_polish": (by_pair, np.zeros((2, 4), int)),
            "best_known": ("scenario", [np.nan, np.nan]),
            "unit_length": ("scenario", [1.0, 1.0]),
            "unit_mass": ("scenario", [1.0, 1.0]),
            "curvature_radius": (by_pair, np.tile([1.0, 2.0, 8.0, 4.0], (2, 1))),
            "obstacles": ("scenario", [6, 10]),
            "iterations": ("algorithm", [5, 5, 5, 3]),
            "stability_acted": (by_pair, acted),
            "stability_kept": (by_pair, acted / 10),
            "seconds_run": ("algorithm", [0.8, 1.6, 0.08, 16.0]),
            "seconds_compile": ("algorithm", [1.0, 2.0, 3.0, 4.0]),
        },
        coords={
            "scenario": SCENARIOS,
            "algorithm": ALGORITHMS,
            "run": range(4),
            "iteration": range(1, 6),
            "term": TERMS,
            "axis": ["x", "y", "z"],
        },
    )
