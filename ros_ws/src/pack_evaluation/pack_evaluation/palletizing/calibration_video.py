"""The video of a calibration: what the arm does, what it feels, and what the camera sees of the board."""

from __future__ import annotations

from pathlib import Path

import mujoco
import numpy as np
from scipy.ndimage import gaussian_filter1d

from pack_core.palletizing.arm import arm_kinematics
from pack_core.palletizing.view import CellView
from pack_core.rotations import Array
from pack_evaluation.captions import Picture, add_bar
from pack_evaluation.evaluator import OnProgress
from pack_evaluation.mp4 import FPS, h264_video
from pack_evaluation.palletizing.calibration_film import CalibrationFilm
from pack_evaluation.palletizing.calibration_inset import board_inset, force_inset, with_inset
from pack_evaluation.palletizing.video import HEIGHT, WIDTH

SPEED = 8.0
"""Simulated seconds a second of the video: a calibration takes minutes."""
END = 3.0
"""For how long the result is shown [s of the video]."""
PILL, STEP = 11.5, 13.0
COLOUR = "#3d9a50"
NEAR, FAR = (2.4, -20.0), (3.6, -38.0)
"""Distance [m] and elevation [deg] of the camera for touches, and for the board."""
ASIDE = np.deg2rad(60.0)
"""From how far beside the line from the arm to its tool the camera looks [rad]."""
CALM = 0.6
"""Standard deviation of the filter that makes the camera follow slowly [s of the video]."""


def write_calibration_video(film: CalibrationFilm, path: Path, progress: OnProgress = lambda _: None) -> None:
    """Render a calibration as H.264 MP4.

    Raises:
        PackError: there is no OpenGL to draw with.
    """
    times = np.arange(film.times[0], film.times[-1] + END * SPEED, SPEED / FPS)
    rows = np.minimum(film.times.searchsorted(times), len(film.times) - 1)
    cameras, stands = _Cameras(film, times, rows), film.stands
    with (
        h264_video(path, WIDTH, HEIGHT) as send,
        CellView(stands.cell, WIDTH, HEIGHT, X_WB=stands.X_WB) as view,
    ):
        for i, time in enumerate(times):
            laid = {
                body: track.at(time)
                for body, track in film.tracks.items()
                if track.times[0] <= time <= track.times[-1]
            }
            picture = view.picture(film.joints[rows[i]], laid, cameras.at(i))
            send(captioned(picture, film, float(time)))
            progress((i + 1) / len(times))


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
        camera = mujoco.MjvCamera()
        camera.lookat[:], camera.distance = (x, y, z), distance
        camera.azimuth, camera.elevation = float(np.rad2deg(angle)), float(elevation)
        return camera
