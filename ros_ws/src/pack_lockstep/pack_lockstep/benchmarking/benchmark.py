"""The one engine of all benchmarks: runs what a folder does not have yet, and keeps each trial as it ends."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, ClassVar, Generic, Protocol, TypeVar

from pack_lockstep.benchmarking.pools import Pool
from pack_lockstep.benchmarking.results_folder import ResultsFolder
from pack_lockstep.benchmarking.sources import Traced


class NamedJob(Protocol):
    """What a trial is made from; it is pickled and sent to another process or machine."""

    @property
    def name(self) -> str:
        """Tells the trial from every other one of the benchmark."""


JobT = TypeVar("JobT", bound=NamedJob)
ResultT = TypeVar("ResultT")


@dataclass(frozen=True)
class Verdict:
    """A trial that has ended, for the terminal: its name, whether it went well, and a line about it."""

    name: str
    success: bool
    text: str


class Benchmark(ABC, Generic[JobT, ResultT]):
    """What a cell's benchmark consists of.

    Attributes:
        cell: name of the cell.
        studies: the cell's part that reports the results; also kept with them, for `pack evaluate`.
        files: patterns of the files that `keep` writes beside the trials, for `--fresh` to remove.
        jobs: the trials to run, in the order in which reports show them.
    """

    cell: ClassVar[str]
    studies: ClassVar[str] = "studies"
    files: ClassVar[tuple[str, ...]] = ()
    jobs: Sequence[JobT]

    @property
    def threads(self) -> int:
        """Cores that a trial uses."""
        return 1

    @property
    @abstractmethod
    def folder_name(self) -> str:
        """Folder below bags/benchmarks where results go by default: one name for each kind of settings."""

    @abstractmethod
    def settings(self) -> Mapping[str, Any]:
        """All that decides the results, jobs apart; a folder of other settings is refused."""

    @property
    @abstractmethod
    def work(self) -> Callable[[JobT], ResultT]:
        """Runs one job; it is pickled, and its result depends on nothing but the job and the settings."""

    @abstractmethod
    def keep(self, result: ResultT, folder: Path) -> Mapping[str, Any]:
        """Write a result's own files, if it has any, and return what is kept: `name` and measures."""

    @abstractmethod
    def verdict(self, trial: Mapping[str, Any]) -> Verdict:
        """A kept line in words."""


def run_benchmark(
    benchmark: Benchmark[JobT, ResultT],
    folder: ResultsFolder,
    pool: Pool,
    origin: Mapping[str, Any],
    sources: Iterable[str] = (),
) -> Iterator[Verdict]:
    """Run the jobs that the folder does not have yet.

    Args:
        benchmark: what to run.
        folder: keeps each trial as soon as it has ended.
        pool: where to run it.
        origin: command, commit and versions, kept in a new folder.
        sources: files of the project that were used to set the benchmark up; those of its trials are added.

    Yields:
        Trials in the order in which they end.

    Raises:
        PackError: the folder is of other settings or another cell, or a job cannot be run.
    """
    file = folder.open(benchmark.cell, benchmark.settings(), origin)
    folder.add_sources(sources)
    missing = [job for job in benchmark.jobs if job.name not in file.trials]
    for result, sources in pool.run(Traced(benchmark.work, benchmark.cell, benchmark.studies), missing):
        trial = benchmark.keep(result, folder.path)
        folder.add_sources(sources)
        file.add(trial)
        yield benchmark.verdict(trial)
