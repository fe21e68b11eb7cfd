"""The engine of all benchmarks, with a benchmark that takes no time."""

import json
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, ClassVar

import pytest

from pack_core.errors import ConfigError
from pack_lockstep.benchmarking.benchmark import Benchmark, Verdict, run_benchmark
from pack_lockstep.benchmarking.results_folder import SOURCES, ResultsFolder

ORIGIN = {"command": "pack benchmark squares", "commit": "1a2b", "versions": {"numpy": "2"}}


@dataclass(frozen=True)
class Number:
    value: int

    @property
    def name(self) -> str:
        return f"number_{self.value}"


@dataclass(frozen=True)
class Squares(Benchmark[Number, int]):
    cell: ClassVar[str] = "packing"
    files: ClassVar[tuple[str, ...]] = ("squares/*.txt",)
    jobs: tuple[Number, ...]
    factor: int = 1

    @property
    def folder_name(self) -> str:
        return "squares"

    def settings(self) -> Mapping[str, Any]:
        return {"factor": self.factor}

    @property
    def work(self) -> Callable[[Number], int]:
        return lambda job: self.factor * job.value**2

    def keep(self, result: int, folder: Path) -> Mapping[str, Any]:
        name = f"number_{round(result**0.5)}"
        (folder / "squares").mkdir(exist_ok=True)
        (folder / "squares" / f"{name}.txt").write_text(str(result))
        return {"name": name, "square": result}

    def verdict(self, trial: Mapping[str, Any]) -> Verdict:
        return Verdict(trial["name"], trial["square"] < 10, str(trial["square"]))


class Backwards:
    """A pool whose last job is done first."""

    def __init__(self) -> None:
        self.done: list[Number] = []

    def run(self, work: Callable[[Any], Any], jobs: Iterable[Any]) -> Iterator[Any]:
        for job in reversed(list(jobs)):
            self.done.append(job)
            yield work(job)


def squares(*values: int, factor: int = 1) -> Squares:
    return Squares(tuple(map(Number, values)), factor)


def test_trials_are_shown_as_they_end_and_kept_in_the_order_of_the_jobs(tmp_path: Path) -> None:
    folder = ResultsFolder(tmp_path / "new")
    shown = list(run_benchmark(squares(1, 2, 4), folder, Backwards(), ORIGIN))
    assert [trial.name for trial in shown] == ["number_4", "number_2", "number_1"]
    assert [trial.success for trial in shown] == [False, True, True]
    kept = folder.kept(["number_1", "number_2", "number_4"])
    assert [trial["square"] for trial in kept.trials] == [1, 4, 16]
    assert kept.settings == {"factor": 1}
    assert kept.origin == {**ORIGIN, "results": str(tmp_path / "new")}
    assert folder.cell == "packing"


def test_only_what_is_missing_is_run(tmp_path: Path) -> None:
    folder, pool = ResultsFolder(tmp_path), Backwards()
    list(run_benchmark(squares(1, 2), folder, Backwards(), ORIGIN))
    assert folder.count(["number_1", "number_2", "number_3"]) == 2
    list(run_benchmark(squares(1, 2, 3), folder, pool, ORIGIN))
    assert pool.done == [Number(3)]


def test_what_was_done_before_an_interruption_is_kept(tmp_path: Path) -> None:
    folder = ResultsFolder(tmp_path)
    running = run_benchmark(squares(1, 2, 3), folder, Backwards(), ORIGIN)
    next(running)
    running.close()
    assert folder.count(["number_1", "number_2", "number_3"]) == 1


def test_what_the_trials_were_made_with_is_kept_until_all_is_measured_anew(tmp_path: Path) -> None:
    folder = ResultsFolder(tmp_path)
    assert folder.sources == {}
    list(run_benchmark(squares(1), folder, Backwards(), ORIGIN, ["config/cells/blocks.yaml"]))
    assert {
        "config/cells/blocks.yaml",
        "ros_ws/src/pack_evaluation/pack_evaluation/packing/studies.py",
    } <= set(folder.sources)
    assert folder.changed_sources() == []

    kept = folder.sources
    (tmp_path / SOURCES).write_text(json.dumps({**kept, "config/cells/blocks.yaml": "of another day"}))
    list(run_benchmark(squares(1, 2), folder, Backwards(), ORIGIN, ["config/cells/blocks.yaml"]))
    assert folder.changed_sources() == ["config/cells/blocks.yaml"]

    folder.clear(Squares.files)
    assert folder.sources == {}


def test_results_of_other_settings_or_of_another_cell_are_refused(tmp_path: Path) -> None:
    class OfBlocks(Squares):
        cell: ClassVar[str] = "blocks"

    folder = ResultsFolder(tmp_path)
    list(run_benchmark(squares(1), folder, Backwards(), ORIGIN))
    with pytest.raises(ConfigError, match="factor: 1 in the file, 2 now"):
        list(run_benchmark(squares(1, factor=2), folder, Backwards(), ORIGIN))
    with pytest.raises(ConfigError, match="benchmark of: packing in the file, blocks now"):
        list(run_benchmark(OfBlocks((Number(1),)), folder, Backwards(), ORIGIN))


def test_clearing_removes_the_results_and_nothing_else(tmp_path: Path) -> None:
    folder = ResultsFolder(tmp_path)
    list(run_benchmark(squares(1), folder, Backwards(), ORIGIN))
    (tmp_path / "notes.txt").write_text("mine")
    folder.clear(Squares.files)
    assert not ResultsFolder.is_at(tmp_path)
    assert [path.name for path in tmp_path.rglob("*") if path.is_file()] == ["notes.txt"]


@pytest.mark.parametrize("name", ["results.jsonl", "summary.json", "report.html", "file"])
def test_a_file_is_no_folder_of_results(tmp_path: Path, name: str) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(ConfigError, match="results are a folder"):
        ResultsFolder(tmp_path / name)
