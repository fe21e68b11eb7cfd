"""The video of a recorded rearrangement, and a strip of pictures of it."""

from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np

from pack_core.blocks.cell import BlocksCell
from pack_evaluation.blocks.from_bag import BlocksRun
from pack_evaluation.blocks.view import RunView
from pack_evaluation.evaluator import OnProgress
from pack_evaluation.mp4 import FPS, h264_video

WIDTH, HEIGHT = 960, 540
SPEED = 4.0
"""Simulated seconds a second of the video."""
ROWS, COLUMNS = 2, 3
"""Rows and columns of pictures in the strip."""
STRIP_SIZE = (640, 480)


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
