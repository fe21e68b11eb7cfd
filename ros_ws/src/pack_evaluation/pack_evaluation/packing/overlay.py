"""The caption of a run's pictures: stage, time, distance to the packing pose, force."""

from __future__ import annotations

from functools import cache

import numpy as np
from matplotlib import font_manager
from PIL import Image, ImageDraw, ImageFont

from pack_evaluation.packing.run import Run
from pack_evaluation.packing.view import Picture

STAGE_COLOURS = {"LOOK": "#8a6fb0", "PRE_PACK": "#4c78a8", "INSERT": "#e08a1e", "FINE_TUNE": "#3d9a50"}
STAGE_TITLES = {"LOOK": "LOOK", "PRE_PACK": "PRE-PACK", "INSERT": "INSERT", "FINE_TUNE": "FINE-TUNE"}
OTHER_COLOUR = "#7f7f7f"
UNITS = 36
"""Unit of the caption's sizes: the picture's height divided by this."""
OPACITY = 0.85
INK = "#20252b"


@cache
def caption_font(size: int) -> ImageFont.FreeTypeFont:
    """The font of captions, `size` pixels high."""
    return ImageFont.truetype(font_manager.findfont("DejaVu Sans"), size)


def add_caption(picture: Picture, run: Run, time: float) -> Picture:
    """A copy of the picture with the state of the run at `time` [s] along its lower edge."""
    unit = len(picture) // UNITS
    top = len(picture) - 3 * unit
    bar = Image.fromarray((OPACITY * 255 + (1.0 - OPACITY) * picture[top:]).astype(np.uint8))
    draw, stage, middle = ImageDraw.Draw(bar), _stage(run, time), 1.5 * unit
    pill = (unit, 0.6 * unit, 8 * unit, 2.4 * unit)
    draw.rounded_rectangle(pill, radius=0.5 * unit, fill=STAGE_COLOURS.get(stage, OTHER_COLOUR))
    title = STAGE_TITLES.get(stage, "WAITING")
    draw.text((4.5 * unit, middle), title, font=caption_font(unit), fill="white", anchor="mm")
    for i, text in enumerate(_readings(run, time)):
        draw.text(
            ((10 + 13 * i) * unit, middle), text, font=caption_font(int(1.1 * unit)), fill=INK, anchor="lm"
        )
    return np.concatenate([picture[:top], np.asarray(bar)])


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
