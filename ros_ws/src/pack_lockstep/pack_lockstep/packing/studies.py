"""Recordings and benchmarks' results as studies, to be put side by side."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

from pack_core.errors import PackError
from pack_evaluation.packing.from_bag import load_run
from pack_evaluation.packing.run import Run
from pack_evaluation.packing.study.trial import Study, Trial, trial_of
from pack_lockstep.packing.benchmark import BenchmarkFolder

RECORDINGS = "recordings"


@dataclass(frozen=True)
class Source:
    """A study and where the runs of its trials come from."""

    study: Study
    load: Callable[[str], Run]


@dataclass(frozen=True)
class Gathered:
    """What was read, and what was left out with the reason."""

    sources: tuple[Source, ...]
    left_out: dict[Path, str]


def gather(paths: Sequence[Path], on_read: Callable[[Path], None] = lambda _: None) -> Gathered:
    """Read what lies at the paths: each folder of a benchmark is a study, all recordings together are one.

    Args:
        paths: benchmarks' folders, and whatever `load_run` reads.
        on_read: is told each path once it has been read.
    """
    sources: list[Source] = []
    trials: list[Trial] = []
    left_out: dict[Path, str] = {}
    for path in paths:
        folder = BenchmarkFolder(path)
        try:
            if folder.exists:
                sources.append(Source(folder.study(), folder.load))
            else:
                trials.append(trial_of(str(path), load_run(path)))
        except PackError as error:
            left_out[path] = str(error)
        on_read(path)
    if trials:
        sources.append(Source(Study(RECORDINGS, tuple(trials)), lambda name: load_run(Path(name))))
    return Gathered(tuple(sources), left_out)
