"""What is measured in a calibration, drawn into a corner of its video."""

from __future__ import annotations

import cv2
import numpy as np
from PIL import Image, ImageDraw

from pack_core.rotations import Array
from pack_evaluation.captions import INK, Picture, caption_font
from pack_evaluation.palletizing.calibration_film import BoardPicture, FeltForce

SIZE = (352, 198)
"""Width and height of the inset [pixel]."""
WAY, FORCE = (-3.0, 1.0), (-40.0, 280.0)
"""Range of the force's drawing [mm, N]."""
FRAME = (40, 30, 344, 160)
"""Left, upper, right and lower end of its axes [pixel]."""
RED, BLUE = "#c03a2b", "#4c78a8"


def force_inset(touch: FeltForce, time: float) -> Picture:
    """Force over the way until `time` [s]; where contact begins once the touch is over."""
    sheet = Image.new("RGB", SIZE, "white")
    draw = ImageDraw.Draw(sheet)
    left, upper, right, lower = FRAME
    draw.rectangle(FRAME, outline="#9aa4ae")
    for force in (0, 100, 200):
        y = _at(np.array([0.0]), np.array([float(force)]))[0][1]
        draw.line((left, y, right, y), fill="#dde2e6")
        draw.text((left - 4, y), str(force), font=caption_font(12), fill=INK, anchor="rm")
    for way in (-2, -1, 0, 1):
        x = _at(np.array([float(way)]), np.array([0.0]))[0][0]
        draw.text((x, lower + 4), str(way), font=caption_font(12), fill=INK, anchor="ma")
    draw.text(((left + right) / 2, SIZE[1] - 3), "way of the tool [mm]", font=caption_font(12), fill=INK,
              anchor="mb")  # fmt: skip
    is_over = time >= touch.times[-1]
    title = f"felt {1e3 * touch.off:+.2f} mm from where it should be" if is_over else "force [N]"
    draw.text((left, 8), title, font=caption_font(14), fill=RED if is_over else INK)
    known = touch.times <= time
    points = _at(1e3 * touch.way[known], touch.force[known])
    if len(points) > 1:
        draw.line(points, fill=BLUE, width=2)
    if is_over:
        x = _at(np.array([0.0]), np.array([0.0]))[0][0]
        draw.line((x, upper, x, lower), fill=RED)
    return np.asarray(sheet)


def board_inset(seen: BoardPicture) -> Picture:
    """The camera's picture with the corners that were found in it."""
    width = SIZE[0]
    scale = width / seen.picture.shape[1]
    picture = cv2.resize(seen.picture, SIZE, interpolation=cv2.INTER_AREA)
    for u, v in seen.corners * scale:
        cv2.circle(picture, (round(u), round(v)), 1, (235, 60, 40), -1, cv2.LINE_AA)
    sheet = Image.fromarray(picture)
    draw = ImageDraw.Draw(sheet)
    draw.rectangle((0, 0, width, 22), fill="white")
    draw.text((8, 3), f"overhead camera: {len(seen.corners)} corners", font=caption_font(14), fill=INK)
    return np.asarray(sheet)


def with_inset(picture: Picture, inset: Picture) -> Picture:
    """A copy of the picture with an inset in its upper left corner."""
    framed = cv2.copyMakeBorder(inset, 1, 1, 1, 1, cv2.BORDER_CONSTANT, value=(120, 128, 136))
    rows, columns = framed.shape[:2]
    found = picture.copy()
    found[12 : 12 + rows, 12 : 12 + columns] = framed
    return found


def _at(way: Array, force: Array) -> list[tuple[float, float]]:
    """Pixels of points of the force's drawing; the part of the way before its range is at its left end."""
    left, upper, right, lower = FRAME
    x = left + (right - left) * np.clip((way - WAY[0]) / (WAY[1] - WAY[0]), 0.0, 1.0)
    y = lower - (lower - upper) * np.clip((force - FORCE[0]) / (FORCE[1] - FORCE[0]), 0.0, 1.0)
    return list(zip(x.tolist(), y.tolist(), strict=True))
