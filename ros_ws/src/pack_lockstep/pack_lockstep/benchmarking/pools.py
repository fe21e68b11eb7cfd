"""Where trials run: processes of this machine, or a Ray cluster."""

from __future__ import annotations

import multiprocessing
import os
import signal
from collections.abc import Callable, Iterable, Iterator, Mapping
from concurrent.futures import BrokenExecutor, ProcessPoolExecutor, as_completed
from contextlib import contextmanager
from threading import Thread
from typing import Protocol, TypeVar

from pack_core.errors import PackError

Job = TypeVar("Job")
Result = TypeVar("Result")

SINGLE_THREADED = dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "NUMBA_NUM_THREADS"), "1")
"""Libraries that split sums among threads would round by the number of cores."""


class Pool(Protocol):
    """Runs jobs somewhere."""

    def run(self, work: Callable[[Job], Result], jobs: Iterable[Job]) -> Iterator[Result]:
        """Results in the order in which they are done; `work` and what it takes are pickled."""
        ...


def cores() -> int:
    """Processor cores that this process may use."""
    return len(os.sched_getaffinity(0))


@contextmanager
def open_pool(jobs: int, ray_address: str | None, threads: int) -> Iterator[Pool]:
    """A pool of `jobs` processes, or of a Ray cluster's where its address is given.

    Args:
        jobs: processes at a time on this machine.
        ray_address: of a cluster, `auto` for the one this machine is part of, `local` for a new one.
        threads: cores that a trial uses, for the cluster to count with.

    Raises:
        PackError: Ray is wanted and is not installed, or there is no such cluster.
    """
    if ray_address is None:
        with _environment(SINGLE_THREADED):
            yield LocalPool(jobs)
        return
    from pack_lockstep.benchmarking.ray_pool import ray_pool

    with ray_pool(ray_address, threads, SINGLE_THREADED) as pool:
        yield pool


class LocalPool:
    """Fresh processes, so that a trial cannot tell what ran before it."""

    def __init__(self, jobs: int) -> None:
        self._jobs = jobs

    def run(self, work: Callable[[Job], Result], jobs: Iterable[Job]) -> Iterator[Result]:
        """Results in the order in which they are done.

        Raises:
            PackError: of a job, or when a process died.
        """
        context = multiprocessing.get_context("spawn")
        with ProcessPoolExecutor(self._jobs, context, _follow_the_parent) as executor:
            futures = [executor.submit(work, job) for job in jobs]
            try:
                for future in as_completed(futures):
                    yield future.result()
            except BrokenExecutor as error:
                raise PackError(f"a benchmark's process died: {error}; is there enough memory?") from error
            finally:
                executor.shutdown(wait=False, cancel_futures=True)
                for process in multiprocessing.active_children():
                    process.terminate()


def _follow_the_parent() -> None:
    """Leave Ctrl-C to the parent, and end when it ends, however that happens."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    Thread(target=_end_with_the_parent, daemon=True).start()


def _end_with_the_parent() -> None:
    if parent := multiprocessing.parent_process():
        parent.join()
        os._exit(1)


@contextmanager
def _environment(values: Mapping[str, str]) -> Iterator[None]:
    """Environment variables for processes that start meanwhile."""
    before = {name: os.environ.get(name) for name in values}
    os.environ.update(values)
    try:
        yield
    finally:
        for name, value in before.items():
            if value is None:
                os.environ.pop(name)
            else:
                os.environ[name] = value
