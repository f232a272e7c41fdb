"""How a program of ours starts JAX: devices, wide vectors, freed memory and programs kept.

The library itself sets nothing global; the command line, the benchmarks and the experiments call
`configure` before anything touches a device.
"""

import ctypes
import hashlib
import os
import platform
import stat
import tempfile
import warnings
from collections import Counter
from contextlib import suppress
from importlib.metadata import version
from pathlib import Path

import jax

from jaxsusp._cache import cache_folder, drop_oldest
from jaxsusp.errors import InputError
from jaxsusp.optim.choices import require_device

WIDE = "--xla_cpu_prefer_vector_width=512"
"""XLA uses half of a 512-bit unit by default; `make bench` times the fitness with all of it."""

WORTH = 0.2
"""Seconds of compilation from which a program is kept: it takes 0.01 to 0.1 to load."""

MALLOC = {-3: 32 * 2**20, -1: 256 * 2**20}
"""Of glibc, in bytes: arrays above M_MMAP_THRESHOLD (the most that it takes) are pages of the
system's, and so much of what was freed is held at hand (M_TRIM_THRESHOLD)."""


def cores() -> int:
    """Number of cores this process may use (`taskset` and cgroup affinity count)."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def configure(devices: int | None = None, keep: bool = True, device: str | None = None) -> None:
    """Choose devices and code generation; only before the first computation.

    What was freed is held at hand, see `_keep_memory`.

    Args:
        devices: number of CPU devices; default one per core, or JAX_NUM_CPU_DEVICES if set.
        keep: whether compiled programs are kept for the next process, see `_keep_programs`.
        device: see `use`.

    Raises:
        InputError: see `use`.
    """
    _keep_memory()
    flags = os.environ.get("XLA_FLAGS", "")
    if "xla_cpu_prefer_vector_width" not in flags and _has_wide_vectors():
        os.environ["XLA_FLAGS"] = f"{flags} {WIDE}".strip()
    if devices is not None or "JAX_NUM_CPU_DEVICES" not in os.environ:
        jax.config.update("jax_num_cpu_devices", devices or cores())
    if keep:
        with suppress(OSError):  # where nothing can be kept it takes longer, and works
            _keep_programs()
    use(device)


def use(device: str | None) -> None:
    """Have everything computed by a kind of device; only before the first computation.

    Args:
        device: "cpu"; "gpu", which has to be there; or None, a GPU where JAX has one.

    Raises:
        InputError: JAX has no GPU.
    """
    if device is None:
        return
    require_device(device)
    if device == "cpu":
        jax.config.update("jax_platforms", "cpu")
        return
    with suppress(RuntimeError):
        if jax.devices("gpu")[0].platform == jax.default_backend():
            return
    kept = os.environ.get("JAX_PLATFORMS")
    why = f" (JAX_PLATFORMS is {kept})" if kept else ""
    raise InputError(
        f'device = "gpu": JAX computes on {said()}{why}; install JAX for a GPU of this machine, '
        'such as pip install "jax[cuda13]", or leave device out'
    )


def said() -> str:
    """What searches run on, in words: "2 × cpu", "1 × NVIDIA H200"."""
    kinds = Counter(each.device_kind for each in jax.devices())
    return ", ".join(f"{count} × {kind}" for kind, count in kinds.items())


def accelerated() -> bool:
    """Whether that is something else than the cores of this machine."""
    return jax.default_backend() != "cpu"


def free_memory() -> int | None:
    """Bytes that all devices have free, as much of each as the fullest.

    None where they do not tell, as those do that share the memory of the machine.
    """
    told = [each.memory_stats() for each in jax.devices()]
    free = [each["bytes_limit"] - each["bytes_in_use"] for each in told if each]
    return len(free) * min(free) if len(free) == len(told) else None


def _keep_memory() -> None:
    """Have the arrays of one call of a program serve the next one.

    A call frees its arrays and the next one wants as many: pages that go to the system and come
    back, zeroed, cost a third of the time of a batch; half of it in a worker of Dask's, which has
    its allocator give back whatever is freed.
    """
    with suppress(OSError, AttributeError, TypeError):  # another allocator than glibc's
        for parameter, value in MALLOC.items():
            ctypes.CDLL(None).mallopt(parameter, value)


def _keep_programs() -> None:
    """Let JAX keep what it compiles in a folder of this person's, machine's and version's.

    It holds executable code: a folder that others may write to is left alone. Where the person has
    set up a cache of JAX's own (JAX_COMPILATION_CACHE_DIR), that one is used.

    Raises:
        OSError: the folder cannot be written.
    """
    # Loading a program logs, as an error, that tuning hints are no features of the machine.
    jax.config.update("jax_logging_level", "CRITICAL")
    all_kept = cache_folder("compiled")
    own = getattr(jax.config, "jax_compilation_cache_dir", None)
    if all_kept is None or own is not None:
        return
    folder = all_kept / f"jax-{jax.__version__}-{version('jaxlib')}-{instruction_set()}"
    folder.mkdir(mode=0o700, parents=True, exist_ok=True)
    there = folder.stat()
    if there.st_uid != os.getuid() or there.st_mode & (stat.S_IWGRP | stat.S_IWOTH):
        return
    tempfile.TemporaryFile(dir=folder).close()
    drop_oldest(all_kept)
    warnings.filterwarnings("ignore", ".*persistent compilation cache", UserWarning)  # disk full
    jax.config.update("jax_compilation_cache_dir", str(folder))
    jax.config.update("jax_persistent_cache_min_compile_time_secs", WORTH)


def _has_wide_vectors() -> bool:
    return "avx512f" in _cpu_features()


def instruction_set() -> str:
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
