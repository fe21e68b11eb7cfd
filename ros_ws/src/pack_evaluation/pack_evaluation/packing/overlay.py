"""The caption of a run's pictures: stage, time, distance to the packing pose, force."""

from __future__ import annotations

import numpy as np

from pack_evaluation.captions import add_bar
from pack_evaluation.packing.run import Run
from pack_evaluation.packing.view import Picture

STAGE_COLOURS = {"LOOK": "#8a6fb0", "PRE_PACK": "#4c78a8", "INSERT": "#e08a1e", "FINE_TUNE": "#3d9a50"}
STAGE_TITLES = {"LOOK": "LOOK", "PRE_PACK": "PRE-PACK", "INSERT": "INSERT", "FINE_TUNE": "FINE-TUNE"}
OTHER_COLOUR = "#7f7f7f"


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
