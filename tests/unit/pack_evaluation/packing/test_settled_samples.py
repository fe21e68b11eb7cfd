"""Figure 3: settled samples survive a file and a bag, and are drawn in the report."""

from pathlib import Path

import mujoco
import numpy as np
import pytest
from PIL import Image

from pack_core.packing import topics
from pack_core.packing.cell import packing_cell
from pack_core.packing.settled_sample import SettledSample
from pack_core.rotations import Pose, from_yaw
from pack_evaluation.packing.evaluator import EVALUATOR
from pack_evaluation.packing.from_bag import load_run
from pack_evaluation.packing.run_file import load_saved_run, save_run
from pack_evaluation.packing.settled_samples import CAPTION, TILE, caption, write_settled_samples
from unit.pack_evaluation.packing.messages import OUTCOME, GoalWriter, header, make, pose
from unit.pack_evaluation.packing.runs import make_run

SCENE = packing_cell().scene
NAMES = [*SCENE.names, SCENE.new_object.name]


def sample(cost: float, rank: float, *, is_feasible: bool = True) -> SettledSample:
    places = {
        name: Pose(np.array([0.4 + 0.04 * i, 0.0, 0.07]), from_yaw(0.1)) for i, name in enumerate(NAMES)
    }
    return SettledSample(cost, rank, is_feasible, places)


SAMPLES = (sample(0.01, 0.0), sample(0.2, 0.4), sample(0.3, 0.6), sample(11.0, 1.0, is_feasible=False))


def test_a_saved_run_keeps_its_samples(tmp_path: Path) -> None:
    save_run(make_run(samples=SAMPLES), tmp_path / "run.npz")
    read = load_saved_run(tmp_path / "run.npz").samples
    assert [(s.cost, s.rank, s.is_feasible) for s in read] == [
        (s.cost, s.rank, s.is_feasible) for s in SAMPLES
    ]
    for name in NAMES:
        np.testing.assert_array_equal(read[0].poses[name].p, SAMPLES[0].poses[name].p)
        np.testing.assert_array_equal(read[0].poses[name].q, SAMPLES[0].poses[name].q)


def test_a_run_that_was_saved_before_samples_were_has_none(tmp_path: Path) -> None:
    save_run(make_run(samples=SAMPLES), tmp_path / "run.npz")
    with np.load(tmp_path / "run.npz") as file:
        arrays = {name: file[name] for name in file.files if name != "samples"}
    np.savez(tmp_path / "old.npz", **arrays)
    assert load_saved_run(tmp_path / "old.npz").samples == ()


def write_bag(folder: Path) -> None:
    """A goal from 1 s on, with samples of an earlier goal and of two placements of its own."""
    writer = GoalWriter(folder)
    for time, cost in ((0.5, 7.0), (1.3, 1.0), (1.6, 2.0)):
        message = make(
            "pack_interfaces/msg/SettledSample", cost=cost, names=NAMES,
            poses=[pose(0.4, 0.0, 0.07) for _ in NAMES],
        )  # fmt: skip
        writer.write(time, topics.SETTLED_SAMPLES, header=header(time), samples=[message])
    writer.write_goal(1.0, OUTCOME)
    writer.close()


def test_a_bags_samples_are_those_of_the_goals_first_placement(tmp_path: Path) -> None:
    write_bag(tmp_path)
    (read,) = load_run(tmp_path).samples
    assert read.cost == 1.0
    assert list(read.poses) == NAMES


def test_every_sample_is_drawn_with_its_cost(tmp_path: Path) -> None:
    write_settled_samples(make_run(samples=SAMPLES), tmp_path / "samples.png")
    with Image.open(tmp_path / "samples.png") as picture:
        assert picture.size == (3 * TILE[0], 2 * (TILE[1] + CAPTION))
    assert caption(SAMPLES[0]) == "cost 0.01, the cheapest, feasible"
    assert caption(SAMPLES[1]) == "cost 0.20, dearer than 40 %, feasible"
    assert caption(SAMPLES[3]) == "cost 11.00, the dearest, not feasible"


def test_the_report_has_a_section_for_them_and_none_without_opengl(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    write_bag(tmp_path)
    found = EVALUATOR.evaluate(tmp_path, tmp_path / "out", with_video=False)
    assert "<h2>Placement samples</h2>" in found.report.read_text()

    def refuse(*_: object) -> None:
        raise RuntimeError("no OpenGL")

    monkeypatch.setattr(mujoco, "Renderer", refuse)
    found = EVALUATOR.evaluate(tmp_path, tmp_path / "blind", with_video=False)
    assert "<h2>Placement samples</h2>" not in found.report.read_text()
