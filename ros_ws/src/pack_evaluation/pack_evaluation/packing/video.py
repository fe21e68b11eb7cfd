"""A run as a video with captions, drawn in parallel processes, because software OpenGL keeps a core busy."""

from __future__ import annotations

import os
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from contextlib import contextmanager
from itertools import chain
from multiprocessing import get_context
from pathlib import Path

import numpy as np
from PIL import Image

from pack_core.camera import Picture
from pack_core.rotations import Array
from pack_evaluation import video_file
from pack_evaluation.captions import add_bar
from pack_evaluation.evaluator import OnProgress
from pack_evaluation.packing.run import Run
from pack_evaluation.packing.view import View, ViewConfig
from pack_evaluation.video_file import FPS

FRAMES_A_PART = 10
"""Number of frames that a drawing process renders at a time."""
LEAD_IN, LEAD_OUT = 0.4, 1.0
"""Time that is shown before the goal is accepted and after it ended [s]."""
STILL_SCALE = 2
"""Stills are drawn this much larger and scaled down, for smooth edges."""
_open: dict[str, tuple[Run, View]] = {}
STAGE_COLOURS = {"LOOK": "#8a6fb0", "PRE_PACK": "#4c78a8", "INSERT": "#e08a1e", "FINE_TUNE": "#3d9a50"}
STAGE_TITLES = {"LOOK": "LOOK", "PRE_PACK": "PRE-PACK", "INSERT": "INSERT", "FINE_TUNE": "FINE-TUNE"}
OTHER_COLOUR = "#7f7f7f"


def write_video(
    run: Run, path: Path, progress: OnProgress = lambda _: None, config: ViewConfig | None = None
) -> None:
    """Render the run as H.264 MP4, on all cores.

    Args:
        run: what to show.
        path: the file to write.
        progress: is told the fraction done.
        config: camera and size.

    Raises:
        PackError: there is no OpenGL to draw with.
    """
    view, times = config or ViewConfig(), frame_times(run)
    parts = np.array_split(times, max(1, len(times) // FRAMES_A_PART))
    with drawing_processes(run, view) as pool:
        frames = chain.from_iterable(pool.map(draw, parts))
        video_file.write_video(path, (view.width, view.height), frames, len(times), progress)


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


@contextmanager
def drawing_processes(run: Run, config: ViewConfig) -> Iterator[ProcessPoolExecutor]:
    """A pool with one process for each core, each with a view of the run that `draw` uses."""
    with View(run, config):  # without OpenGL this raises a PackError here instead of in a process
        pass
    count = len(os.sched_getaffinity(0))
    with ProcessPoolExecutor(count, get_context("spawn"), _start, (run, config)) as pool:
        yield pool


def draw(times: Array) -> list[Picture]:
    """Pictures of the run with their captions at simulated times [s]; runs in a drawing process."""
    run, view = _open["run"]
    return [add_caption(view.picture(time), run, time) for time in times]


def _start(run: Run, config: ViewConfig) -> None:
    # one thread of the software renderer for each process, since there is a process for each core
    os.environ["LP_NUM_THREADS"] = "1"
    _open["run"] = (run, View(run, config))


def add_caption(picture: Picture, run: Run, time: float) -> Picture:
    """A copy of the picture with the state of the run at `time` [s] along its lower edge."""
    stage = _stage(run, time)
    title, colour = STAGE_TITLES.get(stage, "WAITING"), STAGE_COLOURS.get(stage, OTHER_COLOUR)
    return add_bar(picture, title, colour, _readings(run, time))


def _stage(run: Run, time: float) -> str:
    i = int(np.searchsorted(run.iterations.times, time, side="right")) - 1
    return run.iterations.stages[i] if i >= 0 else ""


def _readings(run: Run, time: float) -> tuple[str, ...]:
    readings = [f"t = {max(0.0, min(time, run.end) - run.start):5.2f} s"]
    i = int(np.searchsorted(run.iterations.times, time, side="right")) - 1
    if i >= 0:
        held = run.truth[run.held].at(np.array([time]))
        readings.append(f"distance {100 * held.distance_to(run.iterations.p_WT[i])[0]:4.1f} cm")
        readings.append(f"force {np.interp(time, run.force_times, run.force):4.1f} N")
    return tuple(readings)
