"""Which devices compute, what they are called, and how much they have free."""

import os
import platform
import subprocess
import sys
from contextlib import nullcontext

import jax
import numpy as np
import pytest

import jaxsusp as js
from jaxsusp.comparison.choices import CHUNK
from jaxsusp.comparison.chunks import bytes_of_run, usual_size
from jaxsusp.comparison.workunit import Unit, stack_scenarios
from jaxsusp.optim import devices
from jaxsusp.optim.registry import algorithm
from jaxsusp.problem.flatbatch import BLOCK
from jaxsusp.problem.problem import Problem


class Card:
    """A device that there is not."""

    platform, device_kind = "gpu", "NVIDIA H200"

    def __init__(self, limit: int, used: int = 0):
        self._stats = {"bytes_limit": limit, "bytes_in_use": used}

    def memory_stats(self):
        return self._stats


@pytest.fixture
def cards(monkeypatch):
    """Two of them, and JAX computes on them."""
    found = [Card(2**37, 2**36), Card(2**37)]
    monkeypatch.setattr(jax, "devices", lambda platform=None: found)
    monkeypatch.setattr(jax, "default_backend", lambda: "gpu")
    return found


@pytest.fixture(scope="module")
def units(scenarios):
    groups = stack_scenarios(scenarios[-2:], 5, 40, "box")
    return [Unit.plan(group, algorithm("pso"), 100, 30, "iterations") for group in groups]


@pytest.mark.fast
def test_a_gpu_that_is_not_there_is_one_message(monkeypatch):
    with pytest.raises(js.InputError) as refused:
        devices.use("gpu")
    kind = jax.devices()[0].device_kind
    assert str(refused.value) == (
        f'device = "gpu": JAX computes on 2 × {kind}; install JAX for a GPU of this machine, such '
        'as pip install "jax[cuda13]", or leave device out'
    )
    monkeypatch.setenv("JAX_PLATFORMS", "cpu")
    with pytest.raises(js.InputError, match=r"\(JAX_PLATFORMS is cpu\); install"):
        devices.use("gpu")
    with pytest.raises(js.InputError, match='did you mean "gpu"'):
        devices.use("gpv")


@pytest.mark.fast
def test_a_gpu_that_is_there_is_used_and_named(cards):
    devices.use("gpu")
    devices.use(None)
    assert devices.accelerated()
    assert devices.said() == "2 × NVIDIA H200"
    assert devices.free_memory() == 2 * 2**36, "the fullest decides"


@pytest.mark.fast
def test_a_gpu_that_jax_was_told_not_to_use_is_refused(cards, monkeypatch):
    monkeypatch.setattr(jax, "default_backend", lambda: "cpu")
    with pytest.raises(js.InputError, match="JAX computes on"):
        devices.use("gpu")


@pytest.mark.fast
def test_cpus_share_the_memory_of_the_machine():
    assert devices.free_memory() is None
    assert not devices.accelerated()


@pytest.mark.fast
@pytest.mark.parametrize("command", ["compare", "plan"])
def test_commands_refuse_before_any_work(run, monkeypatch, command):
    monkeypatch.setattr(devices, "configure", lambda device=None, **_: devices.use(device))
    scene = ["scenario-1"] if command == "plan" else []
    status, said, told = run(command, *scene, "--device", "gpu")
    assert (status, said) == (2, "")
    assert told.startswith('device = "gpu": JAX computes on')
    status, _, told = run(command, *scene, "--device", "tpu")
    assert status == 2
    assert told.startswith("device = 'tpu' is not known; ")
    status, _, told = run(command, *scene, "--device", "gpu", "--workers", 2)
    assert status == 2
    assert told.startswith('device = "gpu": is for this process; workers compute on')


def test_a_gpu_is_given_as_many_runs_as_half_of_its_free_memory_holds(units):
    per_run = max(map(bytes_of_run, units))
    assert usual_size(100_000, units, 2 * 5000 * per_run) == 5000
    assert usual_size(3000, units, 2 * 5000 * per_run) == 3000
    assert usual_size(100_000, units, 1000) == 1
    assert usual_size(3000, units, None) == CHUNK


def test_the_memory_of_a_run_is_no_less_than_what_xla_says_for_a_cpu(units, scenarios):
    problem = Problem.from_scenario(scenarios[-1], search="box", dtype=np.float32)
    x = np.zeros((BLOCK, problem.dim), np.float32)  # at a time, as a GPU takes all of them
    quick = {"xla_backend_optimization_level": 0}
    lowered = jax.jit(Problem.evaluate, compiler_options=quick).lower(problem, x)
    said = lowered.compile().memory_analysis().temp_size_in_bytes
    assert said / BLOCK < bytes_of_run(units[0]) / 2 / 30 < 5 * said / BLOCK  # of two scenarios


@pytest.mark.usefixtures("cards")
@pytest.mark.parametrize(("cluster", "free"), [(None, 2**37), (object(), None)])
def test_who_computes_elsewhere_does_not_decide_a_chunk(monkeypatch, cluster, free):
    seen = []

    def size(runs, units, free):
        seen.append((runs, free))
        raise InterruptedError

    place = "jaxsusp.comparison.compare"
    monkeypatch.setattr(f"{place}.usual_size", size)
    monkeypatch.setattr(f"{place}.employed", lambda *_: nullcontext(cluster))
    with pytest.raises(InterruptedError):
        js.compare("scenario-1", "pso", runs=5, search="box")
    assert seen == [(5, free)]


CALLS = """
import resource, sys
import numpy as np
from jaxsusp.optim import devices

if sys.argv[1] == "configured":
    devices.configure(keep=False)


def call():
    for array in [np.empty(3_000_000) for _ in range(8)]:  # 23 MiB each
        array.fill(1.0)


call(), call()
before = resource.getrusage(resource.RUSAGE_SELF).ru_minflt
for _ in range(5):
    call()
print(resource.getrusage(resource.RUSAGE_SELF).ru_minflt - before)
"""


@pytest.mark.skipif(platform.libc_ver()[0] != "glibc", reason="another allocator")
def test_what_a_call_freed_serves_the_next_one_also_where_dask_has_it_given_back():
    def faults(how: str) -> int:
        as_a_worker = {**os.environ, "MALLOC_TRIM_THRESHOLD_": "65536"}
        told = subprocess.run(
            [sys.executable, "-c", CALLS, how], env=as_a_worker, capture_output=True, check=True
        )
        return int(told.stdout)

    assert faults("configured") < faults("not") / 10
