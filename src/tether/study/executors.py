"""Executors: where the runs of a study are done. Whatever has the interface of concurrent.futures will do."""

from __future__ import annotations

import json
import multiprocessing
import os
import signal
import sys
import threading
import time
from collections.abc import Callable, Iterator
from concurrent.futures import Executor, Future, ProcessPoolExecutor
from contextlib import AbstractContextManager, ExitStack, contextmanager
from dataclasses import dataclass
from multiprocessing import resource_tracker
from multiprocessing.connection import Connection, wait
from pathlib import Path
from typing import Any

from tether.errors import InputError, RunError

_SECONDS_TO_CONNECT = 10

_SECONDS_TO_END = 2.0
"""For processes of a study that has been stopped; whatever they are at, they are ended then."""


@dataclass(frozen=True)
class Crew:
    """An executor, and how many runs it does at a time."""

    executor: Executor
    size: int


OpenCrew = Callable[[], AbstractContextManager[Crew]]
"""Makes a crew, anew where the former one broke down."""


def processors() -> int:
    """How many processors this process may use."""
    return len(os.sched_getaffinity(0))


@contextmanager
def processes(workers: int) -> Iterator[Crew]:
    """Processes on this machine."""
    context = multiprocessing.get_context("spawn")  # a fork of a process that has threads may hang
    theirs, ours = context.Pipe(duplex=False)
    executor = _Processes(workers, mp_context=context, initializer=_follow_the_parent, initargs=(theirs,))
    impatience = threading.Timer(_SECONDS_TO_END, ours.close)
    try:
        yield Crew(executor, workers)
    except BaseException:
        impatience.start()
        raise
    finally:
        executor.shutdown(wait=True, cancel_futures=True)
        impatience.cancel()
        ours.close()
        theirs.close()


class _Processes(ProcessPoolExecutor):
    """Processes that a Ctrl-C does not end."""

    def submit(self, *arguments: Any, **keywords: Any) -> Future[Any]:
        """Have a function called; this may start a process for it."""
        with _unheard_interrupts():
            return super().submit(*arguments, **keywords)


def _follow_the_parent(line: Connection) -> None:
    """End this process when its parent is gone, which may have been killed, or has closed its end of the line; a run
    under way has its checkpoint then."""
    parent = multiprocessing.parent_process()
    assert parent is not None

    def follow() -> None:
        wait([parent.sentinel, line])
        while True:  # the first one ends the run, the next one the process
            os.kill(os.getpid(), signal.SIGTERM)
            time.sleep(1.0)

    threading.Thread(target=follow, name="follow the parent", daemon=True).start()


@contextmanager
def _unheard_interrupts() -> Iterator[None]:
    """Processes that are started meanwhile never hear a Ctrl-C.

    In a terminal it reaches all processes: the main one's word ends the others. It hears it itself a moment later.
    """
    resource_tracker.ensure_running()  # started later it would let the signal through
    former = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, former)


@contextmanager
def dask(scheduler: str, workers: int) -> Iterator[Crew]:
    """Workers of Dask. scheduler: an address, a scheduler's file, or "local" for a cluster of so many workers here.

    Raises InputError when Dask is not installed or the scheduler does not answer.
    """
    try:
        from distributed import Client, LocalCluster
    except ImportError:
        raise InputError(
            "--dask needs the package distributed", "it is not installed", "pip install 'tether[dask]'"
        ) from None
    if scheduler == "local":
        with ExitStack() as stack:
            with _unheard_interrupts():
                cluster = LocalCluster(  # type: ignore[no-untyped-call]
                    n_workers=workers, threads_per_worker=1, dashboard_address=":0", processes=True
                )
                stack.enter_context(cluster)
            yield _crew_of(stack.enter_context(Client(cluster)))  # type: ignore[no-untyped-call]
        return
    address = _address(Path(scheduler)) if Path(scheduler).exists() else scheduler
    try:
        client = Client(address, timeout=_SECONDS_TO_CONNECT)  # type: ignore[no-untyped-call]
    except (OSError, ValueError) as error:
        why = str(error).splitlines()[0]
        raise InputError(
            f"no Dask scheduler answers at {scheduler}", why, "start one with: dask scheduler, or give --dask local"
        ) from None
    with client:
        yield _crew_of(client)


def _address(scheduler_file: Path) -> str:
    try:
        return str(json.loads(scheduler_file.read_text(encoding="utf-8"))["address"])
    except (OSError, ValueError, KeyError, TypeError):
        raise InputError(
            f"{scheduler_file} is no scheduler's file of Dask", "it tells no address",
            "give the one that dask scheduler --scheduler-file wrote",
        ) from None  # fmt: skip


def _crew_of(client: Any) -> Crew:
    workers = client.scheduler_info(n_workers=-1)["workers"]
    size = sum(worker["nthreads"] for worker in workers.values())
    # Each call is a run of its own, whatever was called before with the same arguments.
    return Crew(client.get_executor(pure=False), max(1, size))


def is_under_mpi() -> bool:
    """Whether this is `mpiexec ... python -m mpi4py.futures -m tether ...`, whose other processes wait for work."""
    return "mpi4py.futures" in sys.modules


@contextmanager
def mpi() -> Iterator[Crew]:
    """The processes of MPI but the first, which is the one that asks."""
    from mpi4py import MPI
    from mpi4py.futures import MPIPoolExecutor

    ranks = MPI.COMM_WORLD.Get_size()
    if ranks < 2:
        raise InputError(
            "a study under MPI needs at least 2 processes", "the first one only hands out the work",
            "mpiexec -n 2 python -m mpi4py.futures -m tether study ..., or more",
        )  # fmt: skip
    with MPIPoolExecutor() as executor:
        yield Crew(executor, ranks - 1)


def lost(error: BaseException) -> RunError:
    """What is said of a run whose worker died again and again."""
    return RunError(
        "its worker died each time", f"{type(error).__name__}: {str(error).splitlines()[0] if str(error) else ''}",
        "look whether the machine runs out of memory, then start the study again",
    )  # fmt: skip
