"""Motions of the cup by a job, step by step, also where the steps come late."""

from __future__ import annotations

import numpy as np
import pytest

from pack_core.joints import JointSample
from pack_core.packing.cell import packing_cell
from pack_core.rotations import Array
from pack_core.states import SceneState
from pack_mpc.filling.cup_moves import CupMoves
from pack_mpc.filling.fill_config import FillConfig
from pack_mpc.filling.requests import FillCommand, FillObservation, FillPort

CELL = packing_cell()
UP_ACROSS_DOWN = [np.array([0.0, 0.0, 0.1]), np.array([-0.05, -0.25, 0.0]), np.array([0.0, 0.0, -0.1])]
STEP = 0.02


class Arm:
    """It is where it is told to be, and stays there while it is told nothing."""

    def __init__(self) -> None:
        self.port, self.time, self.q = FillPort(), 0.0, np.array(CELL.robot.home)
        self.v = np.zeros(7)
        self.see()
        self.moves = CupMoves(self.port, CELL, FillConfig(), CELL.scene, 0.15)
        self.leaps: list[float] = []
        self.places = [self.moves.cup.p]

    def see(self) -> None:
        joints = JointSample(self.time, self.q, self.v, np.zeros(7))
        self.port.seen = FillObservation(joints, SceneState(self.time, {}), np.zeros(3), True, None)

    def go(self, ways: list[Array], stalls: dict[float, float]) -> None:
        """Make a motion; from each time in `stalls` [s] on nobody makes steps for so long [s]."""
        steps = self.moves.move(ways, self.moves.pace(0.6))
        while next(steps, "over") != "over":
            command, self.port.command = self.port.command.setpoints, FillCommand()
            if command is not None:
                self.leaps.append(float(np.abs(command.q[0] - self.q).max()))
                self.q, self.v = command.q[1], command.v[1]
                self.places.append(self.moves.arm.cup(self.q).p)
            self.time += STEP
            for at in [at for at in stalls if at <= self.time]:
                self.time, self.v = self.time + stalls.pop(at), np.zeros(7)
            self.see()


@pytest.mark.parametrize("at", [0.1, 0.4, 0.7, 1.0])
def test_after_a_stall_a_motion_goes_on_from_where_the_arm_stands_by_the_same_corners(at: float) -> None:
    arm, undisturbed = Arm(), Arm()
    undisturbed.go(UP_ACROSS_DOWN, {})
    arm.go(UP_ACROSS_DOWN, {at: 0.5})
    assert max(arm.leaps) < 1.5 * max(undisturbed.leaps)
    np.testing.assert_allclose(arm.moves.cup.p, undisturbed.moves.cup.p, atol=1e-3)
    start, places = arm.places[0], np.array(arm.places)
    is_between = np.linalg.norm((places - start)[:, :2], axis=1) > 0.03
    is_between &= np.linalg.norm((places - places[-1])[:, :2], axis=1) > 0.03
    assert places[is_between, 2].min() > start[2] + 0.09  # it does not cut the corners
