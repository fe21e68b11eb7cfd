"""The video of a calibration: what the arm does, what it feels, and what the camera sees of the board."""

from __future__ import annotations

from pathlib import Path

import cv2
import mujoco
import numpy as np
from PIL import Image, ImageDraw
from scipy.ndimage import gaussian_filter1d

from pack_core.camera import Picture
from pack_core.drawing.renderer import orbit_camera
from pack_core.palletizing.arm import arm_kinematics
from pack_core.palletizing.view import CellView
from pack_core.rotations import Array
from pack_evaluation import video_file
from pack_evaluation.captions import add_bar, caption_font
from pack_evaluation.evaluator import OnProgress
from pack_evaluation.figures import GREY, INK, RED
from pack_evaluation.palletizing.calibration_film import BoardPicture, CalibrationFilm, FeltForce
from pack_evaluation.palletizing.video import HEIGHT, WIDTH
from pack_evaluation.video_file import FPS

SPEED = 8.0
"""Simulated seconds a second of the video: a calibration takes minutes."""
END = 3.0
"""For how long the result is shown [s of the video]."""
PILL, STEP = 11.5, 13.0
"""Of the caption, in its own unit: what is done has a longer name than a stage."""
COLOUR = "#3d9a50"
NEAR, FAR = (2.4, -20.0), (3.6, -38.0)
"""Distance [m] and elevation [deg] of the camera for touches, and for the board."""
ASIDE = np.deg2rad(60.0)
"""From how far beside the line from the arm to its tool the camera looks [rad]."""
CALM = 0.6
"""Standard deviation of the filter that makes the camera follow slowly [s of the video]."""
SIZE = (352, 198)
"""Width and height of the inset [pixel]."""
WAY, FORCE = (-3.0, 1.0), (-40.0, 280.0)
"""Range of the force's drawing [mm, N]."""
FRAME = (40, 30, 344, 160)
"""Left, upper, right and lower end of its axes [pixel]."""
BLUE = "#4c78a8"


def write_calibration_video(film: CalibrationFilm, path: Path, progress: OnProgress = lambda _: None) -> None:
    """Render a calibration as H.264 MP4.

    Raises:
        PackError: there is no OpenGL to draw with.
    """
    times = np.arange(film.times[0], film.times[-1] + END * SPEED, SPEED / FPS)
    rows = np.minimum(film.times.searchsorted(times), len(film.times) - 1)
    cameras, stands = _Cameras(film, times, rows), film.stands

    def frame(i: int, time: float) -> Picture:
        laid = {
            body: track.last_pose(time)
            for body, track in film.tracks.items()
            if track.times[0] <= time <= track.times[-1]
        }
        return captioned(view.picture(film.joints[rows[i]], laid, cameras.at(i)), film, time)

    with CellView(stands.cell, WIDTH, HEIGHT, X_WB=stands.X_WB) as view:
        frames = (frame(i, time) for i, time in enumerate(times.tolist()))
        video_file.write_video(path, (WIDTH, HEIGHT), frames, len(times), progress)


def captioned(picture: Picture, film: CalibrationFilm, time: float) -> Picture:
    """A copy of the picture with what is done and what is measured at `time` [s]."""
    stages = [stage for stage in film.stages if stage.time <= time]
    if not stages:
        return picture
    now = stages[-1]
    felt = [touch for touch in film.touches if now.time <= touch.times[0] <= time]
    seen = [view for view in film.pictures if view.time <= time]
    if felt:
        picture = with_inset(picture, force_inset(felt[-1], time))
    elif seen and _shows_board(now.title):
        picture = with_inset(picture, board_inset(seen[-1]))
    clock = f"t = {min(time, film.times[-1]) - film.times[0]:5.1f} s, {SPEED:.0f} x"
    words = film.verdict if time >= film.times[-1] else now.what
    return add_bar(picture, now.title, COLOUR, (clock, words), pill=PILL, step=STEP)


def _shows_board(title: str) -> bool:
    return "show" in title


class _Cameras:
    """Where the video's camera is in each frame: it follows the tool, and stands back for the board."""

    def __init__(self, film: CalibrationFilm, times: Array, rows: Array) -> None:
        arm = arm_kinematics().chain
        p = np.array([arm.forward_matrix(q)[1] for q in film.joints[rows]])
        begins = np.array([stage.time for stage in film.stages])
        stage = np.maximum(begins.searchsorted(times, side="right") - 1, 0)
        is_board = np.array(["board" in film.stages[k].title for k in stage])
        outward = p[:, :2] - arm.points[0][:2]
        angle = np.unwrap(np.arctan2(outward[:, 1], outward[:, 0])) + ASIDE + np.pi
        columns = np.column_stack([p, np.where(is_board[:, None], FAR, NEAR), angle])
        self._rows = gaussian_filter1d(columns, CALM * FPS, axis=0, mode="nearest")

    def at(self, i: int) -> mujoco.MjvCamera:
        """The camera of a frame."""
        x, y, z, distance, elevation, angle = self._rows[i]
        return orbit_camera((x, y, z), distance, float(np.rad2deg(angle)), float(elevation))


def force_inset(touch: FeltForce, time: float) -> Picture:
    """Force over the way until `time` [s]; where contact begins once the touch is over."""
    sheet = Image.new("RGB", SIZE, "white")
    draw = ImageDraw.Draw(sheet)
    left, upper, right, lower = FRAME
    draw.rectangle(FRAME, outline=GREY)
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
