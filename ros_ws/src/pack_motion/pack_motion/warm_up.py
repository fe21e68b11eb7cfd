"""Has numba compile all functions before the arm moves."""

from __future__ import annotations

import numpy as np

from pack_core.joints import JointSample
from pack_core.motion.moves import UP, Line, Path, PoseMove, Retreat, Transfer
from pack_core.motion.target import MotionTarget
from pack_core.motion.world import CarriedBox, Obstacle
from pack_core.rotations import Pose
from pack_motion.arm.arm import MotionArm
from pack_motion.controller import MotionController
from pack_motion.tracking.config import MotionSet


def warm_up(arm: MotionArm, config: MotionSet) -> None:
    """Plan and step once without a robot; takes half a minute if nothing has been compiled yet.

    The moves use all that is compiled: a path and a transfer, with a carried box, a standing obstacle and a
    moving one.
    """
    controller = MotionController(arm, config, 0.0, arm.home)
    X_WT = arm.chain.forward(arm.home)
    X_up = Pose(X_WT.p + 0.02 * UP, X_WT.q)
    box = CarriedBox(Pose(np.array([0.0, 0.0, 0.1])), np.full(3, 0.1))
    standing = Obstacle("standing", Pose(X_WT.p + 0.6 * UP), np.full(3, 0.05))
    moving = Obstacle("moving", Pose(X_WT.p + 0.4 * UP), np.full(3, 0.05), is_moving=True)
    hover = Retreat(UP, (0.02, 0.02))
    for move in (Path((PoseMove(X_up), Line(X_WT))), Transfer((Line(X_WT),), hover, hover)):
        controller.command(MotionTarget(0, move, box, (standing, moving)))
        sample = JointSample(controller.time, arm.home, np.zeros(arm.chain.n), np.zeros(arm.chain.n))
        controller.step(controller.time + config.substep, sample)
        controller.status()
