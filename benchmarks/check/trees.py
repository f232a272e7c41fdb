"""Which two trees of the package are compared: folders, or revisions that are unpacked."""

import io
import json
import os
import subprocess
import sys
import tarfile
from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

from jaxsusp.errors import InputError
from jaxsusp.optim.devices import cores

HERE = Path(__file__).resolve().parents[2]

SCRIPT = Path(__file__).with_name("canaries.py")


class Tree(NamedTuple):
    """A checkout, and where its processes keep what they compile."""

    name: str
    folder: Path
    kept: Path

    def timed(self, names: Sequence[str]) -> dict[str, float]:
        """Seconds of canaries, by a process of its own.

        Raises:
            InputError: the tree cannot run one of them.
        """
        done = subprocess.run(
            [sys.executable, "-P", str(SCRIPT), str(self.folder), *names],
            env=self._environment(), cwd=self.kept, capture_output=True, text=True, check=False,
        )  # fmt: skip
        if done.returncode:
            *_, last = done.stderr.strip().splitlines() or ["no message"]
            raise InputError(
                f"{self.name}: its canaries do not run ({last}); leave out what it does not have "
                "with canaries = NAME,NAME, or give another tree"
            )
        return json.loads(done.stdout.splitlines()[-1])

    def _environment(self) -> dict[str, str]:
        return os.environ | {
            "PYTHONPATH": str(self.folder),
            "JAX_NUM_CPU_DEVICES": str(cores()),
            "JAXSUSP_CACHE": str(self.kept),
            "JAX_COMPILATION_CACHE_DIR": str(self.kept / "jax"),
            "JAX_PERSISTENT_CACHE_MIN_COMPILE_TIME_SECS": "0",
        }


def tree(asked: str, scratch: Path) -> Tree:
    """A folder with the package in it, or a revision of this checkout.

    Args:
        asked: by a person.
        scratch: a folder for what is unpacked and kept.

    Raises:
        InputError: it is neither.
    """
    kept = scratch / "kept"
    kept.mkdir(parents=True, exist_ok=True)
    if Path(asked).is_dir():
        folder = Path(asked).resolve()
        if not (folder / "jaxsusp" / "__init__.py").is_file():
            raise InputError(f"tree = {asked}: holds no jaxsusp; give a checkout, or a revision")
        return Tree(asked, folder, kept)
    return Tree(asked, unpacked(asked, scratch / "tree"), kept)


def unpacked(revision: str, folder: Path) -> Path:
    """The package as it was at a revision.

    Raises:
        InputError: there is no such revision, or no git.
    """
    command = ["git", "archive", "--format=tar", revision, "jaxsusp"]
    try:
        done = subprocess.run(command, cwd=HERE, capture_output=True, check=False)
    except FileNotFoundError:
        raise InputError(f"tree = {revision}: needs git; give a folder instead") from None
    if done.returncode:
        reason = done.stderr.decode().strip().splitlines()[-1]
        raise InputError(
            f"tree = {revision}: is neither a folder nor a revision of {HERE.name} ({reason}); "
            "give a folder, or a revision such as main~10"
        )
    folder.mkdir(parents=True, exist_ok=True)
    with tarfile.open(fileobj=io.BytesIO(done.stdout)) as packed:
        packed.extractall(folder, filter="data")
    return folder
