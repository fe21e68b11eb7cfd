"""Results of any kind side by side: benchmarks' folders and recordings, of any cells."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from pack_core.cells import CELLS, cell_part
from pack_core.errors import PackError
from pack_evaluation.record import cell_of
from pack_evaluation.study import Study, StudyEvaluator
from pack_lockstep.benchmarking.results_folder import ResultsFolder


@dataclass(frozen=True)
class CellStudies:
    """Studies of one cell that are shown in the same way, of different names."""

    cell: str
    evaluator: StudyEvaluator[Any, Any]
    studies: tuple[Study[Any], ...]


@dataclass(frozen=True)
class Gathered:
    """What was read, in the order of `CELLS`, and what was left out with the reason."""

    cells: tuple[CellStudies, ...]
    left_out: dict[Path, str]


def gather(paths: Sequence[Path], on_read: Callable[[Path], None] = lambda _: None) -> Gathered:
    """Read what lies at the paths; of each cell, all recordings together are one study.

    Args:
        paths: benchmarks' folders, and recordings.
        on_read: is told each path once it has been read.
    """
    studies: dict[tuple[str, str], list[Study[Any]]] = {}
    recordings: dict[tuple[str, str], list[Any]] = {}
    left_out: dict[Path, str] = {}
    for path in paths:
        try:
            if ResultsFolder.is_at(path):
                folder = ResultsFolder(path)
                kind = (folder.cell, folder.studies)
                found = cell_part(*kind).of_benchmark(folder.kept())
                studies.setdefault(kind, []).extend(found)
            else:
                cell = cell_of(path)
                kind = (cell, cell_part(cell, "studies").kind_of(path))
                recordings.setdefault(kind, []).append(cell_part(*kind).read_recording(path))
        except PackError as error:
            left_out[path] = str(error)
        on_read(path)
    for kind, found in recordings.items():
        studies.setdefault(kind, []).append(cell_part(*kind).of_recordings(found))
    cells = [
        CellStudies(kind[0], cell_part(*kind), tuple(with_names_that_differ(studies[kind])))
        for kind in sorted(studies, key=lambda kind: (CELLS.index(kind[0]), kind[1] != "studies", kind[1]))
    ]
    return Gathered(tuple(cells), left_out)


def with_names_that_differ(studies: Sequence[Study[Any]]) -> list[Study[Any]]:
    """The studies; those that share a name are told apart by their detail, then by their folder."""
    return _told_apart(_told_apart(studies, _detail), _folder)


def _told_apart(studies: Sequence[Study[Any]], tell: Callable[[Study[Any]], str]) -> list[Study[Any]]:
    counts = Counter(study.name for study in studies)
    return [
        replace(study, name=f"{study.name} ({tell(study)})")
        if counts[study.name] > 1 and tell(study)
        else study
        for study in studies
    ]


def _detail(study: Study[Any]) -> str:
    return study.detail


def _folder(study: Study[Any]) -> str:
    return str(study.origin.get("results", ""))
