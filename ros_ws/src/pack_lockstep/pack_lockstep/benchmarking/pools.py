"""Where trials run: processes of this machine, or a Ray cluster."""

from __future__ import annotations

import multiprocessing
import os
import signal
import sys
from collections.abc import Callable, Iterable, Iterator, Mapping
from concurrent.futures import BrokenExecutor, ProcessPoolExecutor, as_completed
from contextlib import contextmanager
from threading import Thread
from typing import Any, Protocol, TypeVar

from pack_core.errors import PackError
from pack_core.extras import install_command

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

    with ray_pool(ray_address, threads, SINGLE_THREADED) as pool:
        yield pool


class LocalPool:
    """Processes of their own, each of which runs one trial after the other.

    Work comes from a module that can be imported, not from the script that runs.
    """

    def __init__(self, jobs: int) -> None:
        self._jobs = jobs

    def run(self, work: Callable[[Job], Result], jobs: Iterable[Job]) -> Iterator[Result]:
        """Results in the order in which they are done.

        Raises:
            PackError: of a job, or when a process died.
        """
        context = multiprocessing.get_context("spawn")
        with ProcessPoolExecutor(self._jobs, context, _follow_the_parent) as executor:
            with _without_main_file():
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
def _without_main_file() -> Iterator[None]:
    """Keep processes that start meanwhile from importing the script that runs here.

    multiprocessing has each of them import it by its file. That is the `pack` command with the commands of
    all cells, which no trial uses and no result depends on.
    """
    main = sys.modules["__main__"]
    file = main.__dict__.pop("__file__", None)
    try:
        yield
    finally:
        if file is not None:
            main.__file__ = file


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


class RayPool:
    """A task a job; a machine takes as many at a time as its cores allow.

    Args:
        ray: the module.
        threads: cores a job.
    """

    def __init__(self, ray: Any, threads: int) -> None:
        self._ray, self._threads = ray, threads

    def run(self, work: Callable[[Job], Result], jobs: Iterable[Job]) -> Iterator[Result]:
        """Results in the order in which they are done.

        Raises:
            PackError: of a job.
        """
        task = self._ray.remote(num_cpus=self._threads)(_do)
        waiting = [task.remote(work, job) for job in jobs]
        try:
            while waiting:
                done, waiting = self._ray.wait(waiting, num_returns=1)
                yield self._ray.get(done[0])
        except self._ray.exceptions.RayTaskError as error:
            if isinstance(error.cause, PackError):
                raise error.cause from error
            raise
        finally:
            for reference in waiting:
                self._ray.cancel(reference, force=True)


def _do(work: Callable[[Job], Result], job: Job) -> Result:
    return work(job)


@contextmanager
def ray_pool(address: str, threads: int, variables: Mapping[str, str]) -> Iterator[RayPool]:
    """Join a cluster for as long as the context lasts.

    Raises:
        PackError: Ray is not installed, or there is no such cluster.
    """
    try:
        import ray
    except ImportError as error:
        raise PackError(
            "--ray needs Ray, which is not installed; on every machine: "
            f"{install_command('cluster', '--require-hashes')} (docs/develop/benchmarks.md)"
        ) from error
    try:
        ray.init(address, runtime_env={"env_vars": dict(variables)}, log_to_driver=False)
    except Exception as error:  # Ray raises what it likes, a bare Exception where a node does not start
        raise PackError(
            f"no Ray cluster at {address}: {error}; start one with `ray start --head`, or give `local`"
        ) from error
    try:
        yield RayPool(ray, threads)
    finally:
        ray.shutdown()
