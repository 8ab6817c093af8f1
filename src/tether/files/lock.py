"""Keeping two processes from writing into one folder."""

from __future__ import annotations

import fcntl
import os
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from tether.errors import InputError

_LOCK = ".lock"
_SECONDS_BETWEEN_TRIES = 0.1


@contextmanager
def locked(folder: Path, patience: float = 1.0) -> Iterator[None]:
    """Hold the folder's lock; the operating system lets it go with the process, however that ends.

    patience: seconds to wait for another process that holds it. Raises InputError when it still does. A file system
    without locks is written without one.
    """
    # A file of its own: NFS locks no folders, and every other file is replaced while the run goes.
    handle = os.open(folder / _LOCK, os.O_RDWR | os.O_CREAT | os.O_CLOEXEC, 0o666)
    until = time.monotonic() + patience
    try:
        while not _taken(handle):
            if time.monotonic() >= until:
                raise InputError(
                    f"{folder} is in use", "another tether is running in it", "wait for it, or stop it"
                ) from None
            time.sleep(_SECONDS_BETWEEN_TRIES)
        yield
    finally:
        os.close(handle)


def is_locked(folder: Path) -> bool:
    """Whether a process holds the folder's lock."""
    try:
        handle = os.open(folder / _LOCK, os.O_RDWR | os.O_CLOEXEC)
    except OSError:
        return False
    try:
        return not _taken(handle)
    finally:
        os.close(handle)


def _taken(handle: int) -> bool:
    """Try to take the lock; False if another process holds it."""
    try:
        fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        return False
    except OSError:
        pass
    return True
