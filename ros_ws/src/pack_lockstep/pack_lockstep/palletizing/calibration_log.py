"""Collects what the video of a calibration shows."""

from __future__ import annotations

import cv2
import numpy as np

from pack_core.camera import Picture
from pack_core.kinematics.chain import SerialChain
from pack_core.palletizing.arm import arm_kinematics
from pack_core.palletizing.boxes import BoxBody
from pack_core.palletizing.calibration_board import BoardSighting
from pack_core.palletizing.topics import TRUTH_RATE
from pack_core.rotations import Array, Pose
from pack_core.states import Source
from pack_core.topics import steps_between
from pack_evaluation.palletizing.calibration_film import (
    BoardPicture,
    CalibrationFilm,
    FeltForce,
    FilmStage,
)
from pack_evaluation.palletizing.run import StandingCell
from pack_evaluation.track import Sample, track_of
from pack_sim.palletizing.simulator import PalletSimulator
from pallet_calibration.conclusion import CalibrationRun
from pallet_calibration.measurements import FeltContact
from pallet_calibration.progress import CalibrationProgress

SMALL = (480, 270)
"""Width and height of the board's pictures that are kept [pixel]."""


class CalibrationLog:
    """Records a calibration in lockstep for its video.

    Args:
        period: time between two steps of the lockstep [s].
    """

    def __init__(self, period: float) -> None:
        self._every, self._steps = steps_between(TRUTH_RATE, period), 0
        self._stands = StandingCell()
        self._times: list[float] = []
        self._joints: list[Array] = []
        self._laid: dict[BoxBody, list[Sample]] = {}
        self._stages: list[FilmStage] = []
        self._pictures: list[BoardPicture] = []

    def note(self, simulator: PalletSimulator) -> None:
        """Record the present state."""
        self._steps += 1
        if self._steps % self._every:
            return
        self._stands = StandingCell(simulator.cell, simulator.X_WB)
        now = simulator.snapshot()
        self._times.append(now.time)
        self._joints.append(now.q)
        for body, X_WB in now.boxes.items():
            self._laid.setdefault(body, []).append((now.time, X_WB.p, X_WB.q, Source.TRUTH))

    def note_progress(self, progress: CalibrationProgress, time: float) -> None:
        """Something else is done from `time` [s] on."""
        of = f"{progress.number} of {progress.count}" if progress.count > 1 else ""
        what = ": ".join(part for part in (of, progress.what) if part)
        self._stages.append(FilmStage(time, progress.state.value, what))

    def note_sighting(self, picture: Picture, seen: BoardSighting) -> None:
        """Record a picture of the board, and what was found in it."""
        small = cv2.resize(picture, SMALL, interpolation=cv2.INTER_AREA)
        self._pictures.append(BoardPicture(seen.time, np.asarray(small), seen.scaled(SMALL[0]).pixels))

    def film(self, run: CalibrationRun) -> CalibrationFilm:
        """What the video shows, once it is known what was found."""
        predicted, chain = run.calibration.predicted, arm_kinematics().chain
        return CalibrationFilm(
            self._stands, np.array(self._times), np.array(self._joints),
            {body: track_of(samples) for body, samples in self._laid.items()},
            tuple(self._stages), tuple(_felt(contact, chain) for contact in run.measured.contacts),
            tuple(self._pictures),
            f"{len(run.calibration.estimates)} numbers; boxes will be {predicted.mean:.2f} mm off on average",
        )  # fmt: skip


def _felt(contact: FeltContact, chain: SerialChain) -> FeltForce:
    touch = contact.touch
    p_WC = chain.with_tool(Pose(touch.p_TC)).forward(contact.q).p
    return FeltForce(touch.times, contact.way, contact.felt, float(p_WC[touch.axis] - touch.at))
