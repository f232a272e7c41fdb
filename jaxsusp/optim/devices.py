"""How a program of ours starts JAX on a CPU: one device per core, wide vectors.

The library itself sets nothing global; the command line, the benchmarks and the experiments call
`configure` before anything touches a device.
"""

import hashlib
import os
import platform
from importlib.metadata import version
from pathlib import Path

import jax

WIDE = "--xla_cpu_prefer_vector_width=512"
"""XLA uses half of a 512-bit unit by default; `make bench` times the fitness with all of it."""


def cores() -> int:
    """Number of cores this process may use (`taskset` and cgroup affinity count)."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def configure(devices: int | None = None, cache: str | os.PathLike[str] | None = None) -> None:
    """Choose devices and code generation; only before the first computation.

    Args:
        devices: number of CPU devices; default one per core, or JAX_NUM_CPU_DEVICES if set.
        cache: folder for a persistent compilation cache; default none. It holds executable code:
            share it with nobody you do not trust. Every kind of machine and every version of
            jaxlib gets a folder of its own in it.

    Raises:
        OSError: the cache cannot be written.
    """
    flags = os.environ.get("XLA_FLAGS", "")
    if "xla_cpu_prefer_vector_width" not in flags and _has_wide_vectors():
        os.environ["XLA_FLAGS"] = f"{flags} {WIDE}".strip()
    if devices is not None or "JAX_NUM_CPU_DEVICES" not in os.environ:
        jax.config.update("jax_num_cpu_devices", devices or cores())
    if cache is not None:
        folder = Path(cache) / f"jaxlib-{version('jaxlib')}-{_machine()}"
        folder.mkdir(parents=True, exist_ok=True)
        jax.config.update("jax_compilation_cache_dir", str(folder))
        jax.config.update("jax_persistent_cache_min_compile_time_secs", 0.5)
        # Loading a program logs, as an error, that tuning hints are no features of the machine.
        jax.config.update("jax_logging_level", "CRITICAL")


def _has_wide_vectors() -> bool:
    return "avx512f" in _cpu_features()


def _machine() -> str:
    """Short name of this kind of machine: compiled programs run where the CPU has the features."""
    features = " ".join(sorted(_cpu_features()))
    return f"{platform.machine()}-{hashlib.sha256(features.encode()).hexdigest()[:8]}"


def _cpu_features() -> set[str]:
    """What the kernel says the CPU can do; nothing where it does not say."""
    try:
        lines = Path("/proc/cpuinfo").read_text().splitlines()
    except OSError:
        return set()
    return {word for line in lines if line.startswith("flags") for word in line.split()[2:]}
