"""Settings under which every test runs: float64, two CPU devices, no silent promotion."""

import os
import signal
import sys
import tempfile

import jax
import pytest

import jaxsusp as js
from jaxsusp.cli.main import main
from jaxsusp.optim import devices

# What takes long is done once per session, by whichever process needs it first: free spaces, and
# compilations. Neither is found in, or left to, a person's own cache.
if "PYTEST_XDIST_WORKER" not in os.environ:
    _cache = tempfile.TemporaryDirectory(prefix="jaxsusp-cache-")
    os.environ["JAXSUSP_CACHE"] = _cache.name
    os.environ["JAX_COMPILATION_CACHE_DIR"] = f"{_cache.name}/compiled"  # of subprocesses as well
    os.environ["JAX_PERSISTENT_CACHE_MIN_COMPILE_TIME_SECS"] = "0.3"
    # XLA's own default, said aloud: programs of the command line, which asks for wider vectors
    # where nothing is said, are then the same as ours and need no compilation of their own.
    flags = os.environ.get("XLA_FLAGS", "")
    if "xla_cpu_prefer_vector_width" not in flags:
        flags += " --xla_cpu_prefer_vector_width=256"
    # Most of a test's time is compilation: two thirds of it will do, and the bits are the same.
    os.environ["XLA_FLAGS"] = f"{flags} --xla_backend_optimization_level=1".strip()

jax.config.update("jax_compilation_cache_dir", os.environ["JAX_COMPILATION_CACHE_DIR"])
jax.config.update("jax_persistent_cache_min_compile_time_secs", 0.3)
jax.config.update("jax_num_cpu_devices", 2)
jax.config.update("jax_enable_x64", True)
jax.config.update("jax_numpy_dtype_promotion", "strict")
jax.config.update("jax_numpy_rank_promotion", "raise")


LONGEST = [
    *("test_compare", "test_examples", "test_contract", "test_planner", "test_batch"),
    *("test_cli_compare", "test_similarity", "test_notebooks"),
    *("test_leastvariance", "test_search", "test_space", "test_ends", "test_equilibrium"),
    *("test_plans", "test_dbo", "test_readme", "test_cli_freespace"),
]
"""Files that take long; those that use programs of another one come well after it."""

WHOLE = {
    *("test_examples", "test_planner", "test_plans", "test_plan_many", "test_motion"),
    *("test_study", "test_plans_by_workers", "test_long_studies", "test_stored_runs"),
    *("test_similarity", "test_cli_compare", "test_batch", "test_ablation", "test_random_scenario"),
    *("test_misplaced", "test_leastvariance", "test_polish", "test_nearby", "test_crowded"),
    *("test_compare", "test_resuming", "test_budgets", "test_host_searches", "test_ends"),
    *("test_routed", "test_cli_freespace"),
}
"""Files of whole journeys, from a statement to a plan or a study's end: more than half of all the
time."""


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Mark whole journeys; several workers begin with what takes long, and end together."""
    for item in items:
        if item.path.stem in WHOLE:
            item.add_marker("whole")
    if "PYTEST_XDIST_WORKER" in os.environ:
        place = {name: i for i, name in enumerate(LONGEST)}
        items.sort(key=lambda item: place.get(item.path.stem, len(place)))


@pytest.fixture(scope="session")
def scenarios() -> list[js.Scenario]:
    """The six benchmark scenarios."""
    return [js.load_scenario(name) for name in js.scenarios()]


@pytest.fixture(scope="session")
def problems(scenarios) -> list[js.Problem]:
    """Their planning problems in float64, waypoints anywhere in the workspace."""
    return [js.Problem.from_scenario(scenario, search="box") for scenario in scenarios]


@pytest.fixture
def run(monkeypatch, capsys):
    """Run a command of the command line in this process: (status, stdout, stderr)."""
    monkeypatch.setattr(devices, "configure", lambda **_: None)  # JAX has started already

    def run(*arguments):
        monkeypatch.setattr(sys, "argv", ["jaxsusp", *map(str, arguments)])
        with pytest.raises(SystemExit) as ended:
            main()
        said = capsys.readouterr()
        return ended.value.code or 0, said.out, said.err

    return run


@pytest.fixture(scope="session", autouse=True)
def _interrupts_arrive():
    """Also where the tests run as a background job, which is started with interrupts ignored."""
    if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
        signal.signal(signal.SIGINT, signal.default_int_handler)
