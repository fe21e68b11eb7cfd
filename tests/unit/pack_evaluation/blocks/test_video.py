from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np
import pytest

from pack_core.blocks.cell import blocks_cell
from pack_core.blocks.planar import PlanarPose
from pack_core.blocks.problem import PlacedBlock, Problem
from pack_core.states import Source
from pack_evaluation.blocks.from_bag import BlocksRun
from pack_evaluation.blocks.video import COLUMNS, ROWS, STRIP_SIZE, RunView, write_strip
from pack_evaluation.track import track_of

CELL = blocks_cell()
SQUARE = ((0.5, -0.15), (0.8, -0.15), (0.8, 0.15), (0.5, 0.15))
STARTS = {"a": PlanarPose(0.55, -0.1, 0.3), "b": PlanarPose(0.7, 0.1, 0.0)}


@pytest.fixture
def run() -> BlocksRun:
    """Block `a` is moved at 1 s, the arm stands."""
    times = np.array([0.0, 0.99, 1.0, 2.0])
    moved = STARTS["a"].moved(0.2, 1.0)
    places = {name: [pose.pose(0.0254)] * 4 for name, pose in STARTS.items()}
    places["a"][2:] = [moved.pose(0.0254)] * 2
    rows = {
        name: [(time, X_WB.p, X_WB.q, Source.TRUTH) for time, X_WB in zip(times, poses, strict=True)]
        for name, poses in places.items()
    }
    blocks = tuple(PlacedBlock(name, pose) for name, pose in STARTS.items())
    return BlocksRun(
        problem=Problem(blocks, {**STARTS, "a": moved}, SQUARE), result={}, plans=(), sights=(), start=0.0,
        end=2.0, truth={name: track_of(samples) for name, samples in rows.items()},
        joint_times=times[[0, -1]], joints=np.array([CELL.robot.look] * 2), jaw_times=times[[0, -1]],
        openings=np.array([0.06, 0.06]),
    )  # fmt: skip


def test_a_view_shows_what_was_recorded_for_a_moment(run: BlocksRun) -> None:
    with RunView(run, (320, 240)) as view:
        first, still, later = (view.picture(time).astype(int) for time in (0.0, 0.5, 1.5))
    assert np.abs(first - still).max() == 0
    assert np.abs(first - later).max() > 50


def test_blocks_that_the_goal_does_not_name_are_drawn_too(run: BlocksRun) -> None:
    first, _ = run.problem.blocks
    some = replace(run.problem, blocks=(first,), goals={first.id: run.problem.goals[first.id]})
    with RunView(run, (320, 240)) as view, RunView(replace(run, problem=some), (320, 240)) as other:
        difference = view.picture(0.0).astype(int) - other.picture(0.0).astype(int)
    assert np.abs(difference).max() == 0


def test_a_strip_has_a_picture_for_each_moment(run: BlocksRun, tmp_path: Path) -> None:
    write_strip(run, tmp_path / "run.png")
    picture = cv2.imread(str(tmp_path / "run.png"))
    assert picture is not None
    assert picture.shape == (ROWS * STRIP_SIZE[1], COLUMNS * STRIP_SIZE[0], 3)
