"""What is kept for the next time: where, how much, and what becomes of it."""

import json
import os
import subprocess
import sys

import pytest

from jaxsusp import _cache
from jaxsusp.errors import InputError

pytestmark = pytest.mark.fast


@pytest.fixture(autouse=True)
def folder(monkeypatch, tmp_path):
    monkeypatch.setenv("JAXSUSP_CACHE", str(tmp_path))
    monkeypatch.delenv("JAXSUSP_NO_CACHE", raising=False)
    return tmp_path


def keep(folder, name: str, size: int, age: float):
    file = folder / name
    file.parent.mkdir(parents=True, exist_ok=True)
    file.write_bytes(bytes(size))
    os.utime(file, (1e9 - age, 1e9 - age))
    return file


@pytest.mark.parametrize(
    ("variable", "value", "kept"),
    [
        ("JAXSUSP_CACHE", "", False),
        ("JAXSUSP_NO_CACHE", "1", False),
        ("JAXSUSP_NO_CACHE", "0", True),
        ("JAXSUSP_NO_CACHE", "", True),
    ],
)
def test_a_person_says_whether_and_where(monkeypatch, folder, variable, value, kept):
    monkeypatch.setenv(variable, value)
    assert (_cache.cache_folder("compiled") == folder / "compiled") == kept
    assert (_cache.cache_folder("compiled") is None) == (not kept)


def test_what_was_used_longest_ago_makes_way(folder):
    old, older, new = (
        keep(folder, f"compiled/{i}/jit_f-cache", 100, age) for i, age in enumerate((20, 30, 10))
    )
    _cache.drop_oldest(folder, limit=300)
    assert old.exists()
    assert older.exists()
    _cache.used(older)
    _cache.drop_oldest(folder, limit=299)
    assert not old.exists()
    assert older.exists()
    assert new.exists()


def test_the_command_shows_and_clears(run, folder):
    keep(folder, f"free-space/{32 * 'a'}.nc", 1500, 1)
    keep(folder, "compiled/machine/jit_b-cache", 500, 1)
    status, out, _ = run("cache", "--json")
    told = json.loads(out)
    assert (status, told["folder"]) == (0, str(folder))
    assert told["kept"]["free-space"] == {"files": 1, "bytes": 1500}
    assert "compiled programs" in run("cache")[1]
    other = keep(folder, "compiled/another.txt", 1, 1)
    assert json.loads(run("cache", "--clear", "--json")[1])["kept"]["compiled"]["files"] == 0
    assert other.exists(), "nothing of somebody else's is removed"
    assert run("cache")[1].startswith(str(folder))


def test_the_command_says_so_where_nothing_is_kept(run, monkeypatch):
    monkeypatch.setenv("JAXSUSP_NO_CACHE", "1")
    assert run("cache")[1] == "Nothing is kept.\n"


def test_a_place_where_nothing_can_be_kept_is_told(run, monkeypatch, folder):
    (folder / "file").touch()
    monkeypatch.setenv("JAXSUSP_CACHE", str(folder / "file"))
    status, _, told = run("cache")
    assert status == 0
    assert f"JAXSUSP_CACHE = {folder / 'file'}: is a file, not a folder" in told


def test_what_cannot_be_kept_is_told_once(monkeypatch, folder):
    monkeypatch.setattr(_cache, "_TOLD", [])
    file = folder / "missing" / "a.nc"
    with (
        pytest.warns(
            UserWarning, match=r"missing: nothing can be kept there \(No such file"
        ) as told,
        _cache.keeping(file),
    ):
        file.write_bytes(b"")
    with _cache.keeping(file):
        fails(file)
    assert len(told) == 1


def fails(file):
    raise InputError(f"{file}: cannot be written")


def test_another_code_is_known_by_another_name(monkeypatch, tmp_path):
    known = _cache.code_digest("freespace", "geometry")
    assert known != _cache.code_digest("freespace")
    (tmp_path / "geometry").mkdir()
    monkeypatch.setattr(_cache, "_PACKAGE", tmp_path)
    assert _cache._digest_of.__wrapped__("freespace", "geometry") != known


def test_code_that_was_changed_after_it_was_loaded_shares_nothing(monkeypatch, tmp_path):
    known = _cache.code_digest("geometry")
    file = tmp_path / "later.py"
    file.touch()
    monkeypatch.setattr(_cache, "_PACKAGE", tmp_path)
    os.utime(file, (0, _cache._LOADED - 1))
    assert _cache.code_digest("geometry") == known
    os.utime(file, (0, _cache._LOADED + 1))
    alone = _cache.code_digest("geometry")
    assert alone.startswith(known)
    assert alone != known


COMPILES = """
import jax
from jaxsusp.optim import devices
devices.WORTH = 0.0
devices.configure(1)
import jax.numpy as jnp
jax.jit(lambda x: jnp.sin(x) @ x.T)(jnp.ones((20, 20))).block_until_ready()
"""


@pytest.mark.parametrize("place", ["usable", "another's", "a file", "nothing is kept"])
def test_programs_are_kept_where_that_is_safe_and_silently_not_elsewhere(folder, place):
    environment = {key: value for key, value in os.environ.items() if "JAX" not in key}
    environment |= {"JAXSUSP_CACHE": str(folder)}
    if place == "a file":
        (folder / "compiled").write_text("in the way")
    if place == "nothing is kept":
        environment["JAXSUSP_NO_CACHE"] = "1"
    command = [sys.executable, "-W", "error", "-c", COMPILES]
    if place == "another's":  # others could put code there
        subprocess.run(command, check=True, env=environment)
        (kept,) = (folder / "compiled").iterdir()
        for file in kept.iterdir():
            file.unlink()
        kept.chmod(0o777)
    ended = subprocess.run(command, check=True, env=environment, capture_output=True, text=True)
    assert ended.stdout + ended.stderr == ""
    written = [file for file in folder.rglob("*-cache") if file.is_file()]
    assert bool(written) == (place == "usable")
    if written:
        assert written[0].parent.stat().st_mode & 0o777 == 0o700
