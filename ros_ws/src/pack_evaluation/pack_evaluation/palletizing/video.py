"""The video of a run of the palletizing cell."""

from __future__ import annotations

from pathlib import Path

import mujoco
import numpy as np

from pack_core.palletizing.boxes import BoxBody
from pack_core.palletizing.view import CellView
from pack_evaluation.captions import add_bar
from pack_evaluation.evaluator import OnProgress
from pack_evaluation.palletizing.run import PalletRun
from pack_evaluation.video_file import FPS, h264_video

WIDTH, HEIGHT = 960, 540
SPEED = 4.0
"""Simulated seconds a second of the video: an order takes minutes."""
PILL, STEP = 10.0, 12.0
COLOUR, FAULT_COLOUR = "#4c78a8", "#c03a2b"


def write_video(run: PalletRun, path: Path, progress: OnProgress = lambda _: None) -> None:
    """Render the run as H.264 MP4, with everything where it truly stood.

    Raises:
        PackError: there is no OpenGL to draw with.
    """
    times = np.arange(run.tool.times[0], run.tool.times[-1], SPEED / FPS)
    bodies = {box.name: BoxBody(box.name, box.dims, box.mass) for box in run.boxes}
    stands = run.stands
    with (
        h264_video(path, WIDTH, HEIGHT) as send,
        CellView(stands.cell, WIDTH, HEIGHT, X_WB=stands.X_WB) as view,
    ):
        for i, time in enumerate(times):
            row = min(int(run.tool.times.searchsorted(time)), len(run.tool.times) - 1)
            boxes = {
                bodies[name]: track.at(time)
                for name, track in run.tracks.items()
                if name in bodies and track.times[0] <= time <= track.times[-1] + 1.0
            }
            picture = view.picture(run.tool.joints[row], boxes, _camera())
            title, colour, readings = _caption(run, float(time))
            send(add_bar(picture, title, colour, readings, pill=PILL, step=STEP))
            progress((i + 1) / len(times))


def _caption(run: PalletRun, time: float) -> tuple[str, str, tuple[str, ...]]:
    """Title, colour and readings at `time` [s]."""
    clock = f"t = {time - run.tool.times[0]:5.1f} s, {SPEED:.0f} x"
    past = [visit for visit in run.visits if visit.time <= time]
    if not past:
        return "waiting", COLOUR, (clock,)
    now, names = past[-1], [box.name for box in run.boxes]
    which = [f"box {names.index(now.box) + 1} of {len(names)}"] if now.box in names else []
    return now.state, FAULT_COLOUR if now.reason else COLOUR, (clock, *which, f"order {run.order}")


def _camera() -> mujoco.MjvCamera:
    """A camera over the pallet's far side, which sees both tables, the arm and the pallet."""
    camera = mujoco.MjvCamera()
    camera.lookat[:], camera.distance = (-0.9, 1.4, 0.65), 6.2
    camera.azimuth, camera.elevation = 125.0, -28.0
    return camera
