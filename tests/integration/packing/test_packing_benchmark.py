"""Scenes through the benchmark: the same whatever runs them, kept, gone on with, and read as a study."""

from __future__ import annotations

import json
import re
from collections.abc import Callable, Iterable, Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from typer.testing import CliRunner

from pack_bringup.cli.main import app
from pack_core.errors import ConfigError
from pack_core.packing.goals import PackingExitReason
from pack_core.paths import bags_path
from pack_evaluation.packing.measures import goal_force, measure
from pack_evaluation.packing.run import Run
from pack_evaluation.packing.run_file import load_saved_run
from pack_evaluation.packing.studies import STUDIES
from pack_evaluation.packing.summary import PackingStudy
from pack_lockstep.benchmarking.benchmark import Verdict, run_benchmark
from pack_lockstep.benchmarking.pools import LocalPool, Pool
from pack_lockstep.benchmarking.results_folder import ResultsFolder
from pack_lockstep.packing.benchmark import PackingBenchmark, run_scene
from pack_lockstep.packing.settings import BenchmarkSettings, PackingSetup, SceneJob, scene_jobs, set_up
from pack_mpc.task.look import LookConfig

SHORT = 0.45
"""Of simulated time for each goal [s]: a few iterations of the controller."""
MEASURED = ("truth", "estimate")


def short(threads: int = 1, **settings: object) -> PackingSetup:
    """The benchmark's setup, but for goals that soon time out."""
    setup = set_up(BenchmarkSettings(**{"optimizer": "ilqr", "weights": "tuned", **settings}), threads)
    task = setup.config.session.task.model_copy(update={"timeout": SHORT})
    session = setup.config.session.model_copy(update={"task": task})
    return PackingSetup(setup.settings, setup.cell, setup.config.model_copy(update={"session": session}))


def assert_same(a: Run, b: Run) -> None:
    """All but the wall clock is the same, bit for bit."""
    for kind in MEASURED:
        for name, track in getattr(a, kind).items():
            other = getattr(b, kind)[name]
            for field in ("times", "p", "q", "sources"):
                np.testing.assert_array_equal(getattr(track, field), getattr(other, field))
    np.testing.assert_array_equal(a.joints, b.joints)
    np.testing.assert_array_equal(a.force, b.force)
    np.testing.assert_array_equal(a.iterations.cost, b.iterations.cost)
    assert a.outcome == b.outcome


def measure_scenes(
    folder: ResultsFolder, setup: PackingSetup, jobs: Sequence[SceneJob], pool: Pool
) -> list[Verdict]:
    return list(run_benchmark(PackingBenchmark(setup, tuple(jobs)), folder, pool, {}))


class Here:
    """A pool that is this process: one of its own takes three seconds to start."""

    def run(self, work: Callable[[SceneJob], Any], jobs: Iterable[SceneJob]) -> Iterator[Any]:
        return map(work, jobs)


def study_of(folder: ResultsFolder) -> PackingStudy:
    return STUDIES.of_benchmark(folder.kept())[0]


def load(folder: ResultsFolder, name: str) -> Run:
    return load_saved_run(folder.path / "runs" / f"{name}.npz")


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> ResultsFolder:
    """Two scenes, run by another process of one thread."""
    found = ResultsFolder(tmp_path_factory.mktemp("results"))
    measure_scenes(found, short(), scene_jobs(BenchmarkSettings(), 3, 2), LocalPool(1))
    return found


def test_a_scene_of_the_folder_in_this_process_with_two_threads_is_the_same_bit_for_bit(
    folder: ResultsFolder,
) -> None:
    job = scene_jobs(BenchmarkSettings(scene_dir=folder.path / "scenes"), 3, 1)[0]
    assert job.name == "seed_3_seed3"
    result = run_scene(short(threads=2), job)
    assert result.run.iterations.times.size > 3
    assert_same(result.run, load(folder, "seed_3"))


def test_the_trials_are_measured_from_their_runs(folder: ResultsFolder) -> None:
    study = study_of(folder)
    assert {trial.name for trial in study.trials} == {"seed_3", "seed_4"}
    assert study.name == "pack_it_in ilqr tuned ideal"
    for trial in study.trials:
        m = trial.measures
        assert m == measure(load(folder, trial.name))
        assert m.exit_reason is PackingExitReason.TIMEOUT
        assert m.execution_time == pytest.approx(SHORT, abs=0.1)
        assert m.m_pos < 0.002
        assert m.m_per >= 0.0
        assert trial.iterations_ms.size == m.iterations > 3
        assert trial.forces.size == pytest.approx(1000 * m.execution_time, abs=2)


def test_the_log_says_what_the_task_said(folder: ResultsFolder) -> None:
    run = load(folder, "seed_4")
    m = measure(run)
    assert m.success == run.outcome["success"]
    assert m.placements == run.outcome["placements"]
    assert np.mean(goal_force(run)[1][4::4]) == pytest.approx(run.outcome["force_mean"])  # at 250 Hz
    assert run.iterations.distance[-1] == pytest.approx(run.outcome["distance"], abs=0.05)


def test_a_scene_with_objects_that_no_camera_sees_fails_and_names_them(tmp_path: Path) -> None:
    setup = short()
    narrow = setup.cell.mocap.model_copy(update={"target": (5.0, 5.0, 0.1), "half_angle_deg": 1.0})
    cell, config = setup.cell.model_copy(update={"mocap": narrow}), setup.config
    # The arm looks from everywhere at once, as the goal is over soon.
    look = LookConfig(dwell=1e-3, travel_time=1e-3)
    task = config.session.task.model_copy(update={"look": look})
    session = config.session.model_copy(update={"task": task})
    blind = PackingSetup(setup.settings, cell, config.model_copy(update={"session": session}))
    folder = ResultsFolder(tmp_path)
    measure_scenes(folder, blind, [SceneJob("seed_3", 3)], Here())
    (trial,) = study_of(folder).trials
    assert trial.measures.exit_reason is PackingExitReason.NO_PLACEMENT
    assert not trial.measures.success
    assert re.match("no camera has seen.* soup_can", trial.message)


def test_scenes_that_are_there_are_not_run_again(folder: ResultsFolder) -> None:
    class NoPool:
        def run(self, work: object, jobs: list[SceneJob]) -> list[object]:
            assert list(jobs) == []
            return []

    wanted = scene_jobs(BenchmarkSettings(), 3, 2)
    assert folder.count(job.name for job in wanted) == 2
    assert measure_scenes(folder, short(), wanted, NoPool()) == []


def test_results_of_other_settings_are_refused(folder: ResultsFolder) -> None:
    other = short(optimizer="sgn")
    with pytest.raises(ConfigError, match="optimizer: ilqr in the file, sgn now"):
        measure_scenes(folder, other, [], LocalPool(1))


def test_results_and_recordings_are_reported_side_by_side(folder: ResultsFolder, tmp_path: Path) -> None:
    summary, sample = tmp_path / "summary.json", bags_path() / "samples" / "packing"
    arguments = ["evaluate", str(folder.path), str(sample), str(tmp_path / "nothing"), "--pictures", "1"]
    outcome = CliRunner().invoke(app, [*arguments, "-o", str(tmp_path), "--json", str(summary)])
    assert outcome.exit_code == 0, outcome.output
    assert re.search(r"left out \S*nothing", outcome.output)
    studies = json.loads(summary.read_text())
    assert {name: (s["scenes"], s["success"]) for name, s in studies.items()} == {
        "pack_it_in ilqr tuned ideal": (2, 0),
        "recordings": (1, 1),
    }
    assert len(list((tmp_path / "failures").rglob("*.png"))) == 1
    report = (tmp_path / "report.html").read_text()
    assert re.findall(r"<b>(seed_\d)</b>", report) == [trial.name for trial in study_of(folder).trials]


def test_a_saved_run_is_evaluated_like_a_recording(folder: ResultsFolder, tmp_path: Path) -> None:
    run = folder.path / "runs" / "seed_3.npz"
    outcome = CliRunner().invoke(app, ["evaluate", str(run), "-o", str(tmp_path), "--no-video"])
    assert outcome.exit_code == 0, outcome.output
    assert "timeout" in outcome.output
    assert (tmp_path / "report.html").is_file()
