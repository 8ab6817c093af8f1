"""Keeping two processes from writing into one folder."""

from __future__ import annotations

import fcntl
import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from tether.errors import InputError


@contextmanager
def locked(folder: Path) -> Iterator[None]:
    """Hold the folder's lock; the operating system lets it go with the process, however that ends.

    Raises InputError when another process holds it. A file system without locks is written without one.
    """
    # A file of its own: NFS locks no folders, and every other file is replaced while the run goes.
    handle = os.open(folder / ".lock", os.O_RDWR | os.O_CREAT | os.O_CLOEXEC, 0o666)
    try:
        try:
            fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            raise InputError(
                f"{folder} is in use", "another tether is running in it", "wait for it, or stop it"
            ) from None
        except OSError:
            pass
        yield
    finally:
        os.close(handle)
