"""The video of a run of the palletizing cell."""

from __future__ import annotations

from contextlib import closing
from pathlib import Path

import imageio_ffmpeg
import mujoco
import numpy as np

from pack_core.palletizing.box_body import BoxBody
from pack_core.palletizing.cell import palletizing_cell
from pack_core.palletizing.view import CellView
from pack_evaluation.evaluator import OnProgress
from pack_evaluation.palletizing.run import PalletRun

WIDTH, HEIGHT = 960, 540
FPS = 25
"""Frames a second of the video."""
SPEED = 4.0
"""Simulated seconds a second of the video: an order takes minutes."""


def write_video(run: PalletRun, path: Path, progress: OnProgress = lambda _: None) -> None:
    """Render the run as H.264 MP4.

    Raises:
        PackError: there is no OpenGL to draw with.
    """
    times = np.arange(run.tool.times[0], run.tool.times[-1], SPEED / FPS)
    bodies = {box.name: BoxBody(box.name, box.dims, box.mass) for box in run.boxes}
    video = imageio_ffmpeg.write_frames(
        path, (WIDTH, HEIGHT), fps=FPS, codec="libx264", quality=7, macro_block_size=4,
        output_params=["-preset", "veryfast"],
    )  # fmt: skip
    with closing(video), CellView(palletizing_cell(), WIDTH, HEIGHT) as view:
        video.send(None)
        for i, time in enumerate(times):
            row = min(int(run.tool.times.searchsorted(time)), len(run.tool.times) - 1)
            boxes = {
                bodies[name]: track.at(time)
                for name, track in run.tracks.items()
                if name in bodies and track.times[0] <= time <= track.times[-1] + 1.0
            }
            video.send(np.ascontiguousarray(view.picture(run.tool.joints[row], boxes, _camera())))
            progress((i + 1) / len(times))


def _camera() -> mujoco.MjvCamera:
    """A camera over the pallet's far side, which sees both tables, the arm and the pallet."""
    camera = mujoco.MjvCamera()
    camera.lookat[:], camera.distance = (-0.9, 1.4, 0.8), 6.2
    camera.azimuth, camera.elevation = 125.0, -28.0
    return camera
