"""A Ray cluster as a pool: every machine of it has this workspace and was started in its environment."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager
from typing import Any, TypeVar

from pack_core.errors import PackError

Job = TypeVar("Job")
Result = TypeVar("Result")


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
            "--ray needs Ray, which is not installed: uv pip install -r requirements/cluster.txt in every "
            "machine's .venv (docs/develop/benchmarks.md)"
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
