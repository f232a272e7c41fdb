"""Settings under which every test runs: float64, two CPU devices, no silent promotion."""

import jax
import pytest

import jaxsusp as js

jax.config.update("jax_num_cpu_devices", 2)
jax.config.update("jax_enable_x64", True)
jax.config.update("jax_numpy_dtype_promotion", "strict")
jax.config.update("jax_numpy_rank_promotion", "raise")


@pytest.fixture(scope="session")
def scenarios() -> list[js.Scenario]:
    """The six benchmark scenarios."""
    return [js.load_scenario(name) for name in js.scenarios()]


@pytest.fixture(scope="session")
def problems(scenarios) -> list[js.Problem]:
    """Their planning problems in float64."""
    return [js.Problem.from_scenario(scenario) for scenario in scenarios]
