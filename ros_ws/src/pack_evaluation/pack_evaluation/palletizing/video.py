"""The video of a run of the palletizing cell."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from pack_core.camera import Picture
from pack_core.drawing.renderer import orbit_camera
from pack_core.palletizing.boxes import BoxBody
from pack_core.palletizing.view import CellView
from pack_evaluation import video_file
from pack_evaluation.captions import add_bar
from pack_evaluation.evaluator import OnProgress
from pack_evaluation.figures import RED
from pack_evaluation.palletizing.run import PalletRun
from pack_evaluation.video_file import FPS

WIDTH, HEIGHT = 960, 540
"""Of the video [pixel]."""
SPEED = 4.0
"""Simulated seconds a second of the video: an order takes minutes."""
PILL, STEP = 10.0, 12.0
"""Of the caption, in its own unit: states have longer names than stages."""
COLOUR = "#4c78a8"


def write_video(run: PalletRun, path: Path, progress: OnProgress = lambda _: None) -> None:
    """Render the run as H.264 MP4, with everything where it truly stood.

    Raises:
        PackError: there is no OpenGL to draw with.
    """
    times = np.arange(run.tool.times[0], run.tool.times[-1], SPEED / FPS)
    with CellView(run.stands.cell, WIDTH, HEIGHT, X_WB=run.stands.X_WB) as view:
        frames = (_frame(view, run, float(time)) for time in times)
        video_file.write_video(path, (WIDTH, HEIGHT), frames, len(times), progress)


def _frame(view: CellView, run: PalletRun, time: float) -> Picture:
    """The cell at `time` [s], over the pallet's far side, from where both tables and the arm are seen."""
    row = min(int(run.tool.times.searchsorted(time)), len(run.tool.times) - 1)
    there = {
        BoxBody(box.name, box.dims, box.mass): track.last_pose(time)
        for box in run.boxes
        if (track := run.tracks.get(box.name)) and track.times[0] <= time <= track.times[-1] + 1.0
    }
    picture = view.picture(run.tool.joints[row], there, orbit_camera((-0.9, 1.4, 0.65), 6.2, 125.0, -28.0))
    title, colour, readings = _caption(run, time)
    return add_bar(picture, title, colour, readings, pill=PILL, step=STEP)


def _caption(run: PalletRun, time: float) -> tuple[str, str, tuple[str, ...]]:
    """Title, colour and readings at `time` [s]."""
    clock = f"t = {time - run.tool.times[0]:5.1f} s, {SPEED:.0f} x"
    past = [visit for visit in run.visits if visit.time <= time]
    if not past:
        return "waiting", COLOUR, (clock,)
    now, names = past[-1], [box.name for box in run.boxes]
    which = [f"box {names.index(now.box) + 1} of {len(names)}"] if now.box in names else []
    return now.state, RED if now.reason else COLOUR, (clock, *which, f"order {run.order}")
