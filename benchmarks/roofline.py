"""How far the fitness is from what this machine can do: a roofline (Williams et al. 2009).

Operations and bytes of a candidate are XLA's own count, taken of the compiled program; the peaks
are measured: products of matrices for arithmetic, sums of vectors that fit a core's own cache for
bytes, as what a candidate needs does.
"""

from typing import NamedTuple
from unittest import mock

import jax
import jax.numpy as jnp
import numpy as np
from jax.sharding import Mesh, NamedSharding, PartitionSpec

from benchmarks.timing import least_seconds
from jaxsusp.problem.problem import Problem, Suspension

_MATRIX, _VECTOR, _TURNS = 1024, 2**14, 2000


class Work(NamedTuple):
    """What one candidate takes, by XLA's count."""

    flops: float
    roots: float  # square roots, divisions of a circle and the like, counted apart
    bytes: float  # read and written by fused kernels


class Peak(NamedTuple):
    """What all devices do together."""

    flops: float  # 1/s, single precision
    bytes: float  # 1/s, from and to the cores' caches


class Roofline(NamedTuple):
    """One candidate against the machine."""

    work: Work
    peak: Peak
    seconds: float  # of a candidate, measured

    @property
    def bound(self) -> float:
        """Seconds below which no candidate can be: of arithmetic or of memory, whichever binds."""
        return max(self.work.flops / self.peak.flops, self.work.bytes / self.peak.bytes)

    def __str__(self) -> str:
        work, peak = self.work, self.peak
        which = "arithmetic" if self.bound == work.flops / peak.flops else "its bytes"
        return (
            f"roofline: {work.flops:.0f} operations, {work.roots:.0f} roots and angles and "
            f"{work.bytes / 1024:.1f} KiB a candidate, {work.flops / work.bytes:.1f} operations a "
            f"byte; {peak.flops / 1e9:.0f} Gflop/s and {peak.bytes / 1e9:.0f} GB/s of cache, "
            f"measured: no candidate below {1e6 * self.bound:.2f} µs, which {which} would take; "
            f"{self.bound / self.seconds:.0%} of that speed is reached"
        )


def work_of(problem: Problem, candidates: int) -> Work:
    """XLA's count for a population on one device.

    XLA counts the body of a loop once, however often it turns. The loops of the fitness go over
    the obstacles, kind by kind: what another turn of one takes is found by writing two of them out.
    """
    assert isinstance(problem.fitness, Suspension)
    turns = [*filter(None, problem.fitness.world.obstacles.counts)]

    def written_out(twice: int | None = None) -> np.ndarray:
        met = 0

        def loop(first, stop, body, carry):
            nonlocal met
            del stop
            for i in range(1 + (met % len(turns) == twice)):
                carry = body(jnp.int32(first + i), carry)
            met += 1
            return carry

        jax.clear_caches()  # what was traced before has other loops in it
        x = jnp.zeros((candidates, problem.dim), jnp.float32)
        with mock.patch.object(jax.lax, "fori_loop", loop):
            program = jax.jit(lambda problem, x: problem.evaluate(x)).lower(problem, x).compile()
        assert met
        assert met % len(turns) == 0  # the kinds one after the other, as often as need be
        counted = program.cost_analysis() or {}
        parts = (counted.get(key, 0.0) for key in ("flops", "transcendentals", "bytes accessed"))
        return np.array([*parts]) / candidates

    once = written_out()
    more = [(times - 1) * (written_out(kind) - once) for kind, times in enumerate(turns)]
    return Work(*(once + sum(more)).tolist())


def peak_of() -> Peak:
    """Products of matrices, and sums of vectors turn after turn, on every device."""
    devices = np.asarray(jax.devices())
    rows = NamedSharding(Mesh(devices, ("devices",)), PartitionSpec("devices"))

    def on_all(*shape: int) -> jax.Array:
        return jax.device_put(jnp.ones((len(devices), *shape), jnp.float32), rows)

    matrix, vector = on_all(_MATRIX, _MATRIX), on_all(_VECTOR)
    product = jax.jit(lambda a: a @ a)

    @jax.jit
    def sums(a):
        return jax.lax.fori_loop(0, _TURNS, lambda _, b: a + 0.5 * b, a)

    return Peak(
        flops=len(devices) * 2 * _MATRIX**3 / least_seconds(lambda: product(matrix)),
        bytes=len(devices) * _TURNS * 3 * 4 * _VECTOR / least_seconds(lambda: sums(vector)),
    )


def roofline(problem: Problem, candidates: int, seconds: float) -> Roofline:
    """Of a population of so many on all devices, of which one took `seconds`."""
    return Roofline(work_of(problem, candidates // len(jax.devices())), peak_of(), seconds)
