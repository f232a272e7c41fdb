"""A search that costs nothing, and what it left in a folder."""

import numpy as np
import pytest
from small import SMALL

import jaxsusp as js
from jaxsusp.comparison import workunit
from jaxsusp.optim.base import NoInfo
from jaxsusp.optim.batch import Outcome


@pytest.fixture
def fake(monkeypatch):
    """Replace the search by one that costs nothing; lists (algorithm, runs) of every batch."""
    batches = []

    def run_batch(problems, optimizer, seed, runs, iterations, population, report, room, lanes):
        assert room >= iterations
        assert lanes >= len(runs)
        batches.append((optimizer.name, list(runs)))
        shape = (len(problems.lower), len(runs))
        rng = [np.random.default_rng([seed, len(optimizer.name), run]) for run in runs]
        unit = np.stack([each.random(problems.lower.shape) for each in rng], axis=1)
        lower, upper = problems.lower[:, None], problems.upper[:, None]
        if report is not None:
            report(iterations)
        return Outcome(
            (lower + (upper - lower) * unit).astype(np.float32),
            np.full(shape, 1.0, np.float32),
            np.tile(np.arange(iterations, 0, -1, np.float32), (*shape, 1)),
            NoInfo(),
            1.0,
            2.0,
        )

    monkeypatch.setattr(workunit, "run_batch", run_batch)
    return batches


@pytest.fixture
def folder(tmp_path, fake):
    """Results of pso and ga, two runs each."""
    js.compare("scenario-1", ("pso", "ga"), **SMALL, output=tmp_path)
    fake.clear()
    return tmp_path
