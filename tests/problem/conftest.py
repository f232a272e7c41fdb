"""The planning problems of the six scenarios, of one shape here."""

import pytest
from padded import problem_of

import jaxsusp as js


@pytest.fixture(scope="session")
def problems(scenarios) -> list[js.Problem]:
    """In float64, waypoints anywhere in the workspace."""
    return [problem_of(scenario) for scenario in scenarios]
