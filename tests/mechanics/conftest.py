"""Fixtures of the mechanics' tests."""

import pytest
from suspensions import Hung


@pytest.fixture(scope="session")
def hung() -> Hung:
    return Hung()
