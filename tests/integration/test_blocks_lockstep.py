"""The blocks cell in lockstep: cameras, planner, arm and gripper of the nodes, in one process."""

from dataclasses import replace

import numpy as np
import pytest

from pack_bringup.blocks.execution import Execution, execute
from pack_bringup.blocks.planning import CountedPlannerConfig
from pack_bringup.blocks.settings import lockstep_config
from pack_core.cells.blocks import blocks_cell
from pack_core.errors import MessageError
from pack_core.joint_reference import JointReference
from pack_core.motion.target import Acceptance, MotionTarget
from pack_core.motion.world import Obstacle
from pack_motion.controller import MotionController
from pack_planner.rearrangement.instances import make_instance
from pack_sim.blocks.simulator import BlocksSimulator


def run(seed: int) -> Execution:
    cell = blocks_cell()
    problem = make_instance(2, 0.1, seed, centre=cell.workspace.centre)
    return execute(problem, cell, CountedPlannerConfig(), lockstep_config())


@pytest.mark.timeout(600)
def test_two_blocks_are_put_side_by_side_and_a_run_repeats_bit_for_bit() -> None:
    first = run(0)
    assert first.is_ok, first
    assert first.error_mm < 0.5
    assert run(0) == first


@pytest.mark.timeout(600)
def test_a_grasp_that_the_arm_refuses_is_planned_around(monkeypatch: pytest.MonkeyPatch) -> None:
    """Something nobody sees stands over the first block, until the arm has been told to go there."""
    asked: list[MotionTarget] = []
    command = MotionController.command

    def hinder(self: MotionController, target: MotionTarget) -> Acceptance:
        approaches = [segment for segment in target.move.segments if segment.label == "down"]
        if approaches and not asked:
            asked.append(target)
            phantom = Obstacle("phantom", approaches[0].X_WT, np.full(3, 0.2))
            target = replace(target, obstacles=(*target.obstacles, phantom))
        return command(self, target)

    monkeypatch.setattr(MotionController, "command", hinder)
    done = run(0)
    assert asked
    assert done.is_ok, done
    assert done.plans == 3


def test_a_run_whose_setpoints_the_driver_refuses_ends_and_says_why(monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(_: BlocksSimulator, reference: JointReference) -> None:
        raise MessageError("velocity of elbow_joint is 9.000 rad/s")

    monkeypatch.setattr(BlocksSimulator, "accept", refuse)
    done = run(0)
    assert done.exit_reason == "motion failed"
    assert done.message == "the driver refused setpoints: velocity of elbow_joint is 9.000 rad/s"
    assert not done.is_ok
