"""A recorded rearrangement as a video, seen from the side of the table."""

from __future__ import annotations

from pathlib import Path
from types import TracebackType
from typing import Self

import cv2
import mujoco
import numpy as np
import numpy.typing as npt

from pack_core.blocks.cell import BlocksCell
from pack_core.blocks.model import block_name, build_model
from pack_core.drawing.renderer import open_renderer
from pack_core.robots.robotiq_2f85 import FINGER_JOINTS
from pack_core.robots.ur10e import JOINTS
from pack_evaluation.blocks.from_bag import BlocksRun
from pack_evaluation.evaluator import OnProgress
from pack_evaluation.video_file import FPS, h264_video

Picture = npt.NDArray[np.uint8]
WIDTH, HEIGHT = 960, 540
SPEED = 4.0
"""Simulated seconds a second of the video."""
ROWS, COLUMNS = 2, 3
"""Rows and columns of pictures in the strip."""
STRIP_SIZE = (640, 480)


class RunView:
    """Draws moments of a run; a context manager, because it holds a renderer.

    Args:
        run: the recording.
        cell: the cell of the recording.
        size: width and height [pixel].
    """

    def __init__(self, run: BlocksRun, cell: BlocksCell, size: tuple[int, int]) -> None:
        self._run, self._cell = run, cell
        tags = {block.id: number for number, block in enumerate(run.problem.blocks)}
        self._model = build_model(cell, tags, timestep=0.001, look=True)
        self._model.vis.global_.offwidth, self._model.vis.global_.offheight = size
        self._data = mujoco.MjData(self._model)
        self._renderer = open_renderer(self._model, *size)

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._renderer.close()

    def picture(self, time: float) -> Picture:
        """The cell at `time` [s], `(height, width, 3)` RGB."""
        self._set(time)
        self._renderer.update_scene(self._data, self._camera())
        self._renderer.scene.flags[mujoco.mjtRndFlag.mjRND_REFLECTION] = False
        picture: Picture = np.ascontiguousarray(self._renderer.render())
        return picture

    def _set(self, time: float) -> None:
        data, run = self._data, self._run
        for name, column in zip(JOINTS, run.joints.T, strict=True):
            data.joint(name).qpos = np.interp(time, run.joint_times, column)
        opening = np.interp(time, run.jaw_times, run.openings)
        for name in FINGER_JOINTS:
            data.joint(name).qpos = 0.5 * opening
        row = int(np.searchsorted(run.times, time))
        for name, track in run.truth.items():
            data.joint(block_name(name)).qpos = track[min(row, len(track) - 1)]
        mujoco.mj_forward(self._model, data)

    def _camera(self) -> mujoco.MjvCamera:
        """A camera at the side of the work area, over the table's edge."""
        camera = mujoco.MjvCamera()
        camera.lookat[:], camera.distance = (*self._cell.workspace.centre, 0.12), 1.25
        camera.azimuth, camera.elevation = 145.0, -32.0
        return camera


def write_video(run: BlocksRun, cell: BlocksCell, path: Path, progress: OnProgress = lambda _: None) -> None:
    """Render the run as H.264 MP4."""
    times = np.arange(run.times[0], run.times[-1], SPEED / FPS)
    with h264_video(path, WIDTH, HEIGHT) as send, RunView(run, cell, (WIDTH, HEIGHT)) as view:
        for i, time in enumerate(times):
            send(view.picture(float(time)))
            progress((i + 1) / len(times))


def write_strip(run: BlocksRun, cell: BlocksCell, path: Path) -> None:
    """Write one picture of moments evenly spread over the run, row by row."""
    times = np.linspace(run.times[0], run.times[-1], ROWS * COLUMNS)
    with RunView(run, cell, STRIP_SIZE) as view:
        pictures = [view.picture(float(time)) for time in times]
    rows = [np.hstack(pictures[row * COLUMNS : (row + 1) * COLUMNS]) for row in range(ROWS)]
    cv2.imwrite(str(path), cv2.cvtColor(np.vstack(rows), cv2.COLOR_RGB2BGR))
