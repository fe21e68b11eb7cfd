"""What a fill job does with one object, told what it sees and how its requests are answered."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
import pytest

from pack_core.joints import JointSample, Setpoints
from pack_core.packing.cell import packing_cell
from pack_core.packing.goals import Arrangement, PackingExitReason
from pack_core.packing.objects import Box
from pack_core.packing.packing_list import PackingList
from pack_core.rotations import POINTING_DOWN, Array, Pose, exp
from pack_core.states import ObjectState, SceneState
from pack_mpc.filling.fill_config import FillConfig
from pack_mpc.filling.fill_job import FillJob
from pack_mpc.filling.requests import (
    Arrange,
    FillObservation,
    FillRequest,
    Pack,
    Packed,
    Present,
    Presented,
    UsePump,
)
from pack_mpc.filling.tool_motion import CupPace, ToolArm, lines
from pack_mpc.task.task import PackingOutcome

CELL = packing_cell()
CARTON = Box(name="carton", shape="box", size=(0.09, 0.06, 0.1), mass=0.3)
LIST = PackingList(objects=[CARTON])
PLACE = Pose(np.array([0.5, 0.0, 0.05]))
ARM, HOME = ToolArm(CELL), np.array(CELL.robot.home)
HANGING = Pose(np.array([0.0, 0.0, 0.05]), POINTING_DOWN)
"""Pose X_TN of the carton in the cup while it is packed."""
LEANING = np.array([0.0, np.deg2rad(18.0), 0.0])
"""More than the tilt at which an object is let go [rad]."""


@dataclass
class FakeCell:
    """A cell whose arm is where it shall be, with a carton that is where and as a packing goal leaves it.

    While it is gripped it moves with the cup.

    Attributes:
        tilts: rotation vectors `(3,)` of the carton after each packing goal.
        reasons: how each packing goal ends.
        places: how many of the arrangements have a place for it.
        is_stuck: the arm moves no more once a packing goal has ended.
        keeps: how the pump does not open: it refuses with this reason, or, if that is empty, without a word.
    """

    tilts: list[Array]
    reasons: list[PackingExitReason]
    places: int = 9
    is_stuck: bool = False
    keeps: str | None = None
    packs: list[Pack] = field(default_factory=list)
    is_gripped: bool = False
    X_WO: Pose = field(default_factory=lambda: CELL.hand_over.pose_of(CARTON))
    q: Array = field(default_factory=lambda: np.array(CELL.robot.home))

    def follow(self, setpoints: Setpoints, time: float) -> None:
        """Bring the arm, and the carton if it is gripped, to where they shall be at `time` [s]."""
        if self.is_stuck and self.packs:
            return
        row = int(np.searchsorted(setpoints.time + setpoints.offsets, time))
        X_OT = self.X_WO.inverse() @ ARM.cup(self.q)
        self.q = setpoints.q[min(row, len(setpoints.q) - 1)]
        if self.is_gripped:
            self.X_WO = ARM.cup(self.q) @ X_OT.inverse()

    def serve(self, request: FillRequest) -> object:
        match request:
            case Arrange(items):
                names = tuple(item.name for item in items)
                self.places -= 1
                return Arrangement(names, dict.fromkeys(names, PLACE) if self.places >= 0 else {})
            case Present():
                return Presented(LIST.start(CELL))
            case UsePump(close):
                self.is_gripped = close or self.keeps is not None
                return "" if close else self.keeps or ""
            case Pack():
                self.packs.append(request)
                k = len(self.packs) - 1
                self.X_WO = Pose(PLACE.p, exp(self.tilts[k]))
                X_WT = self.X_WO @ HANGING.inverse()
                here = ARM.cup(HOME)
                path = lines(here, [X_WT.p - here.p], CupPace(0.5, 4.0), FillConfig(), X_WT.q)
                self.q = ARM.plan(HOME, 0.0, path).q[-1]
                reason = self.reasons[k]
                success = reason is PackingExitReason.PLACED
                return Packed(PackingOutcome(reason, success, "as told", 1.0, 0.0, 0.0, 0.0, 1), PLACE)
        raise AssertionError(request)


def run(cell: FakeCell, config: FillConfig | None = None) -> FillJob:
    """Run a job to its end on a clock of 20 ms a step."""
    job = FillJob(LIST, CELL, config or FillConfig(), LIST.start(CELL))
    time, answer = 0.0, None
    while not job.is_done:
        joints = JointSample(time, cell.q, np.zeros(7), np.zeros(7))
        scene = SceneState(time, {"carton": ObjectState(cell.X_WO)})
        command = job.step(FillObservation(joints, scene, np.zeros(3), cell.is_gripped, answer))
        answer = None if command.request is None else cell.serve(command.request)
        time += 0.02
        if command.setpoints is not None:
            cell.follow(command.setpoints, time)
    return job


PLACED = PackingExitReason.PLACED


def test_an_object_that_leans_is_taken_out_and_packed_again() -> None:
    cell = FakeCell([LEANING, np.zeros(3)], [PLACED, PLACED])
    (row,) = run(cell).report.objects
    assert len(cell.packs) == 2
    assert row.is_packed
    assert not cell.is_gripped


@pytest.mark.parametrize("tries", [1, 2])
def test_it_is_put_aside_once_its_tries_are_used_up(tries: int) -> None:
    cell = FakeCell([LEANING] * tries, [PLACED] * tries)
    (row,) = run(cell, FillConfig(pack_tries=tries)).report.objects
    assert len(cell.packs) == tries
    assert row.reason == "put aside: it is tilted by 18 degrees"
    assert not row.has_fault
    assert np.linalg.norm(cell.X_WO.p - CELL.hand_over.pose_of(CARTON).p) < 0.01


def test_a_job_ends_with_the_object_held_if_the_arm_cannot_put_it_aside() -> None:
    cell = FakeCell([LEANING], [PLACED], places=1, is_stuck=True)
    job = run(cell)
    (row,) = job.report.objects
    assert cell.is_gripped
    assert row.has_fault
    assert not row.is_packed
    assert job.fault == job.report.message
    assert job.fault.startswith(
        "'carton' is still held (it is tilted by 18 degrees): the arm could not carry it on"
    )


@pytest.mark.parametrize(
    ("keeps", "reason"), [("the valve is stuck", "the valve is stuck"), ("", "the vacuum stayed")]
)
@pytest.mark.parametrize("is_put_aside", [False, True])
def test_a_pump_that_does_not_let_go_ends_the_job(keeps: str, reason: str, is_put_aside: bool) -> None:
    tilt = LEANING if is_put_aside else np.zeros(3)
    cell = FakeCell([tilt], [PLACED], places=1, keeps=keeps)
    job = run(cell)
    (row,) = job.report.objects
    assert (row.is_packed, row.has_fault) == (False, True)
    assert job.fault.endswith(f"the pump does not let go: {keeps or 'the vacuum stayed'}")


def test_it_is_put_aside_at_once_if_there_is_no_other_place_for_it() -> None:
    cell = FakeCell([LEANING], [PLACED], places=1)
    (row,) = run(cell).report.objects
    assert len(cell.packs) == 1
    assert row.reason == "put aside: it is tilted by 18 degrees"


def test_a_goal_that_fails_is_not_repeated_as_it_has_tried_several_placements_itself() -> None:
    cell = FakeCell([np.zeros(3)], [PackingExitReason.TIMEOUT])
    (row,) = run(cell).report.objects
    assert len(cell.packs) == 1
    assert row.reason == "put aside: timeout: as told"
    assert not row.has_fault


def test_a_force_stop_is_a_fault() -> None:
    (row,) = run(FakeCell([np.zeros(3)], [PackingExitReason.FORCE])).report.objects
    assert row.has_fault
