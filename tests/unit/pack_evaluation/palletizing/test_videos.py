"""Videos of orders and of calibrations: what is written and drawn into them."""

from dataclasses import replace
from functools import partial
from pathlib import Path

import imageio_ffmpeg
import numpy as np
import pytest

from pack_core.camera import Picture
from pack_core.palletizing.calibration_board import CALIBRATION_BOARD
from pack_core.palletizing.cell import palletizing_cell
from pack_core.palletizing.view import CellView
from pack_core.rotations import IDENTITY
from pack_core.states import Source
from pack_evaluation.palletizing import calibration_video, video
from pack_evaluation.palletizing.calibration_film import (
    BoardPicture,
    CalibrationFilm,
    FeltForce,
    FilmStage,
)
from pack_evaluation.palletizing.calibration_video import captioned, write_calibration_video
from pack_evaluation.palletizing.run import StandingCell
from pack_evaluation.palletizing.video import HEIGHT, SPEED, WIDTH, write_video
from pack_evaluation.track import track_of
from pack_evaluation.video_file import FPS
from unit.pack_evaluation.palletizing.known_run import a_run

WITHOUT_SHADOWS = partial(CellView, shadows=False)
"""Drawn in less than half of the time."""
GREY = np.full((HEIGHT, WIDTH, 3), 60, dtype=np.uint8)
CORNER = (slice(0, 220), slice(0, 380))
"""Where the inset is."""
TIMES = np.linspace(10.0, 14.0, 101)


def a_film() -> CalibrationFilm:
    """A touch from 10.5 s to 11.5 s, a picture of the board at 13 s, the fit at 14 s."""
    home = np.array(palletizing_cell().arm.home)
    p = [-2.5, 2.5, 0.705]
    touched = np.linspace(10.5, 11.5, 50)
    way = np.linspace(-0.0025, 0.0005, 50)
    return CalibrationFilm(
        StandingCell(), TIMES, np.tile(home, (len(TIMES), 1)),
        {CALIBRATION_BOARD.body: track_of([(time, p, IDENTITY, Source.TRUTH) for time in TIMES])},
        (FilmStage(10.0, "touch surfaces", "1 of 22: pallet, from above"),
         FilmStage(12.0, "show the board", "1 of 18"), FilmStage(14.0, "fit", "")),
        (FeltForce(touched, way, 5e5 * np.maximum(way, 0.0), 0.0019),),
        (BoardPicture(13.0, np.zeros((270, 480, 3), dtype=np.uint8), np.full((90, 2), 100.0)),),
        "42 numbers",
    )  # fmt: skip


def changed(time: float) -> Picture:
    """Which pixels of a grey picture its caption and its inset change."""
    return np.any(captioned(GREY, a_film(), time) != GREY, axis=2)


@pytest.mark.parametrize(
    ("time", "has_inset"),
    [(10.2, False), (11.0, True), (11.9, True), (12.5, False), (13.5, True), (15.0, False)],
)
def test_what_is_measured_is_in_the_corner_while_it_is_measured(time: float, has_inset: bool) -> None:
    assert changed(time)[CORNER].any() == has_inset
    assert changed(time)[-30:].any()  # what is done is below all the time


def test_the_force_grows_with_time_and_its_beginning_is_marked_at_the_end() -> None:
    pictures = [captioned(GREY, a_film(), time)[CORNER] for time in (10.8, 11.2, 11.6)]
    blue = [int(np.count_nonzero((p[..., 2] > 150) & (p[..., 0] < 100))) for p in pictures]
    red = [int(np.count_nonzero((p[..., 0] > 180) & (p[..., 2] < 60))) for p in pictures]
    assert 0 < blue[0] < blue[1] < blue[2]
    assert red[:2] == [0, 0]
    assert red[2] > 100


def test_a_calibration_is_filmed_to_its_result(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(calibration_video, "END", 0.2)
    monkeypatch.setattr(calibration_video, "SPEED", 20.0)
    monkeypatch.setattr(calibration_video, "CellView", WITHOUT_SHADOWS)
    done: list[float] = []
    write_calibration_video(a_film(), tmp_path / "calibration.mp4", done.append)
    count, _ = imageio_ffmpeg.count_frames_and_secs(tmp_path / "calibration.mp4")
    assert count == round((4.0 / calibration_video.SPEED + 0.2) * FPS)
    assert done[-1] == 1.0


def test_an_order_is_filmed_with_its_states_from_its_first_moment_to_its_last(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(video, "CellView", WITHOUT_SHADOWS)
    tool = a_run().tool
    first = {name: value[:8] for name, value in vars(tool).items() if value is not None}
    run = a_run(tool=replace(tool, **first))
    write_video(run, tmp_path / "run.mp4")
    frames = imageio_ffmpeg.read_frames(tmp_path / "run.mp4")
    assert next(frames)["size"] == (WIDTH, HEIGHT)
    pictures = [np.frombuffer(frame, dtype=np.uint8).reshape(HEIGHT, WIDTH, 3) for frame in frames]
    assert len(pictures) == int(np.ceil(tool.times[7] * FPS / SPEED))
    pill = pictures[0][-25:-15, 30:40].astype(int)
    assert np.abs(pill - np.array([0x4C, 0x78, 0xA8])).max() < 40
