"""The video of a recorded rearrangement."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import closing
from pathlib import Path

import imageio_ffmpeg
import mujoco
import numpy as np

from pack_bringup.blocks.recorded_run import BlocksRun
from pack_core.cells.blocks import BlocksCell
from pack_core.robots.robotiq_2f85 import FINGER_JOINTS
from pack_core.robots.ur10e import JOINTS
from pack_core.rotations import Array
from pack_core.scene.blocks.model import block_name, build_model

WIDTH, HEIGHT = 960, 540
FPS = 25
"""Frames a second of the video."""
SPEED = 4.0
"""Simulated seconds a second of the video."""

Progress = Callable[[float], None]


def write_video(run: BlocksRun, cell: BlocksCell, path: Path, progress: Progress = lambda _: None) -> None:
    """Render the run as H.264 MP4."""
    tags = {block.id: number for number, block in enumerate(run.problem.blocks)}
    model = build_model(cell, tags, timestep=0.001, look=True)
    model.vis.global_.offwidth, model.vis.global_.offheight = WIDTH, HEIGHT
    data, times = mujoco.MjData(model), np.arange(run.times[0], run.times[-1], SPEED / FPS)
    video = imageio_ffmpeg.write_frames(
        path, (WIDTH, HEIGHT), fps=FPS, codec="libx264", quality=7, macro_block_size=4,
        output_params=["-preset", "veryfast"],
    )  # fmt: skip
    with closing(video), closing(mujoco.Renderer(model, HEIGHT, WIDTH)) as renderer:
        video.send(None)
        for i, time in enumerate(times):
            _set(model, data, run, float(time))
            renderer.update_scene(data, _camera(cell))
            renderer.scene.flags[mujoco.mjtRndFlag.mjRND_REFLECTION] = False
            video.send(np.ascontiguousarray(renderer.render()))
            progress((i + 1) / len(times))


def _set(model: mujoco.MjModel, data: mujoco.MjData, run: BlocksRun, time: float) -> None:
    for name, column in zip(JOINTS, run.joints.T, strict=True):
        data.joint(name).qpos = np.interp(time, run.joint_times, column)
    opening = np.interp(time, run.jaw_times, run.openings)
    for name in FINGER_JOINTS:
        data.joint(name).qpos = 0.5 * opening
    row = int(np.searchsorted(run.times, time))
    for name, track in run.truth.items():
        pose: Array = track[min(row, len(track) - 1)]
        data.joint(block_name(name)).qpos = pose
    mujoco.mj_forward(model, data)


def _camera(cell: BlocksCell) -> mujoco.MjvCamera:
    """From the side of the work area, over the table's edge."""
    camera = mujoco.MjvCamera()
    camera.lookat[:], camera.distance = (*cell.workspace.centre, 0.12), 1.25
    camera.azimuth, camera.elevation = 145.0, -32.0
    return camera
