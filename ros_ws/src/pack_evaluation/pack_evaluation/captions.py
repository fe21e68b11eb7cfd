"""Captions of the pictures of a video: a bar along the lower edge."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache

import numpy as np
from matplotlib import font_manager
from PIL import Image, ImageDraw, ImageFont

from pack_core.camera import Picture
from pack_evaluation.figures import INK

UNITS = 36
"""Unit of the caption's sizes: the picture's height divided by this."""
OPACITY = 0.85
"""Of the white bar behind a caption."""


@cache
def caption_font(size: int) -> ImageFont.FreeTypeFont:
    """The font of captions, `size` pixels high."""
    return ImageFont.truetype(font_manager.findfont("DejaVu Sans"), size)


def add_bar(
    picture: Picture,
    title: str,
    colour: str,
    readings: Sequence[str],
    *,
    pill: float = 7.0,
    step: float = 13.0,
) -> Picture:
    """A copy of the picture with what happens along its lower edge.

    Args:
        picture: RGB.
        title: of the present stage.
        colour: of the pill behind the title.
        readings: what is measured, from left to right.
        pill: width of the pill, in units of the caption.
        step: distance between two readings, in units of the caption.
    """
    unit = len(picture) // UNITS
    top = len(picture) - 3 * unit
    bar = Image.fromarray((OPACITY * 255 + (1.0 - OPACITY) * picture[top:]).astype(np.uint8))
    draw, middle = ImageDraw.Draw(bar), 1.5 * unit
    shape = (unit, 0.6 * unit, (1 + pill) * unit, 2.4 * unit)
    draw.rounded_rectangle(shape, radius=0.5 * unit, fill=colour)
    font = caption_font(unit)
    draw.text(((1 + pill / 2) * unit, middle), title, font=font, fill="white", anchor="mm")
    for i, text in enumerate(readings):
        x = (3 + pill + step * i) * unit
        draw.text((x, middle), text, font=caption_font(int(1.1 * unit)), fill=INK, anchor="lm")
    return np.concatenate([picture[:top], np.asarray(bar)])
