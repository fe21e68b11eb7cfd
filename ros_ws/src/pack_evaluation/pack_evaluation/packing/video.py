"""The video of a run, and a picture of it."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from PIL import Image

from pack_core.rotations import Array
from pack_evaluation.evaluator import OnProgress
from pack_evaluation.mp4 import FPS, h264_video
from pack_evaluation.packing.drawing import draw, drawing_processes
from pack_evaluation.packing.run import Run
from pack_evaluation.packing.view import View, ViewConfig

FRAMES_A_PART = 10
"""Number of frames that a drawing process renders at a time."""
LEAD_IN, LEAD_OUT = 0.4, 1.0
"""Time that is shown before the goal is accepted and after it ended [s]."""
STILL_SCALE = 2
"""Stills are drawn this much larger and scaled down, for smooth edges."""


def write_video(
    run: Run, path: Path, config: ViewConfig | None = None, progress: OnProgress = lambda _: None
) -> None:
    """Render the run as H.264 MP4, on all cores.

    Args:
        run: what to show.
        path: the file to write.
        config: camera and size.
        progress: is told the fraction done.

    Raises:
        PackError: there is no OpenGL to draw with.
    """
    view, times = config or ViewConfig(), frame_times(run)
    parts = np.array_split(times, max(1, len(times) // FRAMES_A_PART))
    with h264_video(path, view.width, view.height) as send, drawing_processes(run, view) as pool:
        for i, pictures in enumerate(pool.map(draw, parts)):
            for picture in pictures:
                send(picture)
            progress((i + 1) / len(parts))


def write_still(run: Run, path: Path, time: float | None = None, config: ViewConfig | None = None) -> None:
    """Write one picture, by default of the moment the object is half way down."""
    size = config or ViewConfig()
    large = {"width": STILL_SCALE * size.width, "height": STILL_SCALE * size.height, "shadow_size": 8192}
    with View(run, size.model_copy(update=large)) as view:
        picture = view.picture(_half_way(run) if time is None else time)
    Image.fromarray(picture).resize((size.width, size.height), Image.Resampling.LANCZOS).save(path)


def frame_times(run: Run) -> Array:
    """Simulated times `(F,)` [s] of the frames, within what was recorded."""
    recorded = run.truth[run.held].times
    start, end = max(run.start - LEAD_IN, recorded[0]), min(run.end + LEAD_OUT, recorded[-1])
    return np.arange(start, end, 1.0 / FPS)


def _half_way(run: Run) -> float:
    """When the held object has done half of its way down [s]."""
    held = run.truth[run.held].between(run.start, run.end)
    height = held.p[:, 2]
    return float(held.times[np.argmax(height < 0.5 * (height[0] + height[-1]))])
