"""Files that are either the old one or the new one, never half of either."""

import fcntl
import os
import secrets
import socket
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import IO, Any

from jaxsusp.errors import InputError, require


@contextmanager
def atomic_path(path: str | os.PathLike[str]) -> Iterator[Path]:
    """Lend a scratch path in the folder of `path`; what is written there becomes `path`.

    The scratch file is flushed to disk and renamed over `path` when the block ends normally. When
    it does not (an error, Ctrl-C), the scratch file is removed and `path` stays as it was. A
    symbolic link is followed: its target is replaced and the link stays.

    Args:
        path: the file to create or replace; its folder must exist.

    Yields:
        A path that does not exist yet, with the suffix of `path`, so that writers which choose
        their format by suffix choose the right one.

    Raises:
        FileNotFoundError: the folder is missing, or the block wrote nothing.
    """
    target = Path(path).resolve()
    if not target.parent.is_dir():
        raise FileNotFoundError(f"cannot write {target}: there is no folder {target.parent}")
    scratch = target.with_name(f".{target.stem}-{secrets.token_hex(4)}{target.suffix}")
    try:
        yield scratch
        _flush(scratch)
        os.replace(scratch, target)
    except BaseException:
        scratch.unlink(missing_ok=True)
        raise
    _flush(target.parent)  # the new name itself must survive a power cut


def write_text(path: str | os.PathLike[str], text: str) -> None:
    """Write UTF-8 text to `path` atomically."""
    with atomic_path(path) as scratch:
        scratch.write_text(text, encoding="utf-8")


def write_netcdf(dataset: Any, path: str | os.PathLike[str]) -> None:
    """Write an xarray dataset as NetCDF-4, atomically; its folder is created where missing.

    It is made in memory: where a disk is full in the middle, HDF5 takes the process down with it;
    and by this thread: in a worker of a cluster xarray would ask that for a lock of its own.

    Raises:
        InputError: the place cannot be written.
    """
    import dask.config  # takes a while, and is loaded by xarray for writing in any case

    path = Path(path)
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        with dask.config.set(scheduler="synchronous"), atomic_path(path) as scratch:
            scratch.write_bytes(dataset.to_netcdf(engine="h5netcdf"))
    except OSError as error:
        raise InputError(
            f"{path}: cannot be written ({error.strerror or error}); free space there or choose "
            "another folder"
        ) from error


@contextmanager
def sole_writer(name: str, folder: str | os.PathLike[str]) -> Iterator[None]:
    """Keep other processes from writing to a folder at the same time; a folder made for it goes.

    The system forgets the claim of a process that ends, however it ends.

    Args:
        name: of the setting, for the message.
        folder: made where it is missing, and removed if nothing has come into it.

    Raises:
        InputError: another process writes there.
    """
    folder = Path(folder)
    before = _nearest(folder)
    folder.mkdir(parents=True, exist_ok=True)
    lock = folder / ".lock"
    try:
        with _locked(f"{name} = {folder}", lock):
            yield
    finally:
        for made in (folder, *folder.parents):
            if made == before:
                break
            with suppress(OSError):  # it holds something
                made.rmdir()


@contextmanager
def _locked(told: str, lock: Path) -> Iterator[None]:
    while True:
        file = lock.open("a+", encoding="utf-8")
        try:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            file.seek(0)
            who = file.read().strip() or "another process"
            file.close()
            raise InputError(
                f"{told}: {who} writes there; wait for it, or choose another folder"
            ) from None
        except OSError:  # a file system without locks
            pass
        if _same(file, lock):
            break
        file.close()  # its owner removed it while we waited
    with file:
        file.truncate(0)
        file.write(f"process {os.getpid()} on {socket.gethostname()}")
        file.flush()
        try:
            yield
        finally:
            lock.unlink(missing_ok=True)


def _same(file: IO[str], path: Path) -> bool:
    try:
        return os.path.samestat(os.fstat(file.fileno()), path.stat())
    except FileNotFoundError:
        return False


def _flush(path: Path) -> None:
    """Ask the system to bring a file or folder to disk."""
    handle = os.open(path, os.O_RDONLY)
    try:
        os.fsync(handle)
    finally:
        os.close(handle)


def require_folder(name: str, folder: str | os.PathLike[str]) -> None:
    """Refuse a folder that can be neither written nor made; makes nothing.

    Args:
        name: of the setting, for the message.
        folder: there or not; where it is not, the next one above it that is there is tried.

    Raises:
        InputError: a file is in the way, or nothing can be written there.
    """
    _require_writable(f"{name} = {folder}", Path(folder))


def require_file(name: str, file: str | os.PathLike[str], suffix: str) -> None:
    """Refuse a file of another suffix, or one that cannot be written; writes nothing.

    Raises:
        InputError: the name ends in something else, a folder has it, or its folder is none.
    """
    path = Path(file)
    told = f"{name} = {file}"
    require(path.suffix.lower() == suffix, f"{told}: give a file name that ends in {suffix}")
    _require_writable(told, path.parent, of="its folder ")
    require(not path.is_dir(), f"{told}: is a folder, not a file; choose another name")


def _require_writable(told: str, folder: Path, of: str = "") -> None:
    remedy = "choose another folder"
    try:
        there = _nearest(folder)
        blocked = (
            f"{told}: {of if there == folder else f'{there} '}is a file, not a folder; {remedy}"
        )
        require(there.is_dir(), blocked)
        tempfile.TemporaryFile(dir=there).close()
    except OSError as error:
        reason = error.strerror or error
        raise InputError(f"{told}: {of}cannot be written ({reason}); {remedy}") from error


def _nearest(folder: Path) -> Path:
    """The folder, or what there is of the way to it."""
    for place in (folder, *folder.parents):
        try:
            place.lstat()
        except (FileNotFoundError, NotADirectoryError):
            continue
        return place
    return folder
