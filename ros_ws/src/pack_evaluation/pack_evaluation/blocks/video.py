"""A recorded rearrangement as a video, seen from the side of the table."""

from __future__ import annotations

from pathlib import Path

import cv2
import mujoco
import numpy as np

from pack_core.blocks.cell import blocks_cell
from pack_core.blocks.model import block_name, build_model
from pack_core.blocks.problem import CUBE
from pack_core.bodies import set_object_poses
from pack_core.camera import Picture
from pack_core.drawing.renderer import ModelView, orbit_camera
from pack_core.robots.robotiq_2f85 import FINGER_JOINTS
from pack_core.robots.ur10e import JOINTS
from pack_evaluation import video_file
from pack_evaluation.blocks.from_bag import BlocksRun
from pack_evaluation.evaluator import OnProgress
from pack_evaluation.video_file import FPS

WIDTH, HEIGHT = 960, 540
"""Of the video [pixel]."""
SPEED = 4.0
"""Simulated seconds a second of the video."""
ROWS, COLUMNS = 2, 3
"""Rows and columns of pictures in the strip."""
STRIP_SIZE = (640, 480)
"""Width and height of each of them [pixel]."""


class RunView(ModelView):
    """Draws moments of a run, in pictures of `size` width and height [pixel]."""

    def __init__(self, run: BlocksRun, size: tuple[int, int]) -> None:
        self._run, cell = run, blocks_cell()
        # A goal may name only some of the blocks in the cell; of the others no size was recorded.
        others = dict.fromkeys((name for name in run.truth if name not in run.problem.sizes), CUBE)
        sizes = {**run.problem.sizes, **others}
        tags = {name: number for number, name in enumerate(sizes)}
        super().__init__(build_model(cell, tags, sizes, timestep=0.001, visuals=True), *size)
        # At the side of the work area, over the table's edge.
        self._camera = orbit_camera((*cell.workspace.centre, 0.12), 1.25, 145.0, -32.0)

    def picture(self, time: float) -> Picture:
        """The cell at `time` [s], `(height, width, 3)` RGB."""
        data, run = self._data, self._run
        for name, column in zip(JOINTS, run.joints.T, strict=True):
            data.joint(name).qpos = np.interp(time, run.joint_times, column)
        opening = np.interp(time, run.jaw_times, run.openings)
        for name in FINGER_JOINTS:
            data.joint(name).qpos = 0.5 * opening
        poses = {block_name(name): track.last_pose(time) for name, track in run.truth.items()}
        set_object_poses(self._model, data, poses)
        mujoco.mj_forward(self._model, data)
        self._update_scene(self._camera)
        return self._render()


def write_video(run: BlocksRun, path: Path, progress: OnProgress = lambda _: None) -> None:
    """Render the run as H.264 MP4."""
    times = np.arange(run.start, run.end, SPEED / FPS)
    with RunView(run, (WIDTH, HEIGHT)) as view:
        frames = (view.picture(time) for time in times.tolist())
        video_file.write_video(path, (WIDTH, HEIGHT), frames, len(times), progress)


def write_strip(run: BlocksRun, path: Path) -> None:
    """Write one picture of moments evenly spread over the run, row by row."""
    with RunView(run, STRIP_SIZE) as view:
        moments = np.linspace(run.start, run.end, ROWS * COLUMNS).tolist()
        pictures = [view.picture(time) for time in moments]
    rows = [np.hstack(pictures[row * COLUMNS : (row + 1) * COLUMNS]) for row in range(ROWS)]
    cv2.imwrite(str(path), cv2.cvtColor(np.vstack(rows), cv2.COLOR_RGB2BGR))
