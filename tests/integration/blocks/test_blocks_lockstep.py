"""The blocks cell in lockstep: cameras, planner, arm and gripper of the nodes, in one process."""

from dataclasses import replace

import numpy as np
import pytest

from block_fsm.requests import ExecutorRequest, MoveArm
from block_fsm.task import RearrangeTask
from pack_core.blocks.cell import blocks_cell
from pack_core.blocks.model import block_name
from pack_core.bodies import set_object_poses
from pack_core.errors import MessageError
from pack_core.joints import Setpoints
from pack_core.motion.target import Acceptance, MotionTarget
from pack_core.motion.world import Obstacle
from pack_core.rotations import Pose
from pack_core.states import SceneState
from pack_lockstep.blocks.execution import Execution, execute
from pack_lockstep.blocks.lockstep import BlocksLockstep, CountedPlanner, CountedPlannerConfig
from pack_lockstep.blocks.settings import lockstep_config
from pack_motion.controller import MotionController
from pack_planner.rearrangement.instances import make_instance
from pack_sim.blocks.simulator import BlocksSimulator


def run(blocks: int = 2) -> Execution:
    cell = blocks_cell()
    problem = make_instance(blocks, 0.1, 0, centre=cell.workspace.centre)
    return execute(problem, cell, CountedPlannerConfig(), lockstep_config())


@pytest.mark.timeout(600)
def test_a_run_repeats_bit_for_bit() -> None:
    first = run(blocks=1)
    assert first.is_ok, first
    assert run(blocks=1) == first


@pytest.mark.timeout(600)
def test_two_blocks_are_put_side_by_side_and_a_grasp_that_the_arm_refuses_is_planned_around(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
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
    done = run()
    assert asked
    assert done.is_ok, done
    assert done.error_mm < 0.5
    assert done.plans == 3


@pytest.mark.timeout(600)
def test_a_block_that_a_hand_moves_during_an_action_is_seen_and_planned_for_anew() -> None:
    cell, config = blocks_cell(), lockstep_config()
    problem = make_instance(2, 0.1, 0, centre=cell.workspace.centre)
    task = RearrangeTask.of(problem)
    planner = CountedPlanner(CountedPlannerConfig(), config.planner)
    lockstep = BlocksLockstep(cell, task, problem.starts, planner, config)
    shifted: list[str] = []

    def shift(request: ExecutorRequest, truth: SceneState) -> None:
        if shifted or not isinstance(request, MoveArm) or request.path.segments[0].label != "lift":
            return
        action, sim = lockstep.executor.action, lockstep.simulator
        assert action is not None
        shifted.extend(name for name in problem.starts if name != action.block)
        X_WB = truth.objects[shifted[0]].X_WO
        moved = Pose(X_WB.p + np.array([0.0, 0.02, 0.0]), X_WB.q)
        set_object_poses(sim.model, sim.data, {block_name(shifted[0]): moved})

    outcome = lockstep.run(shift)
    assert shifted
    assert outcome.success, outcome.message
    assert (outcome.tally.disturbances, outcome.tally.plans) == (1, 3)
    assert outcome.position_error < 0.0015


def test_a_run_whose_setpoints_the_driver_refuses_ends_and_says_why(monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(_: BlocksSimulator, setpoints: Setpoints) -> None:
        raise MessageError("velocity of elbow_joint is 9.000 rad/s")

    monkeypatch.setattr(BlocksSimulator, "accept", refuse)
    done = run()
    assert done.exit_reason == "motion failed"
    assert done.message == "the driver refused setpoints: velocity of elbow_joint is 9.000 rad/s"
    assert not done.is_ok
