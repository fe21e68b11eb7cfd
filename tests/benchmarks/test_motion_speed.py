"""Wall time of the motion controller: a step, a plan, an inverse."""

from __future__ import annotations

import numpy as np
import pytest
from pytest_benchmark.fixture import BenchmarkFixture

from pack_core.joints import JointSample
from pack_core.motion.moves import UP, Line, Path, PoseMove, Retreat, Transfer
from pack_core.motion.target import MotionTarget
from pack_core.motion.world import CarriedBox, Obstacle
from pack_core.rotations import Pose, from_rpy
from pack_motion.arm.arm import load_arm
from pack_motion.controller import MotionController
from pack_motion.tracking.config import motion_set

pytestmark = pytest.mark.benchmark
ARM = load_arm("palletizing")
DOWN = from_rpy((np.pi, 0.0, 0.0))
PICK, PLACE = Pose(np.array([-2.5, 2.5, 0.9]), DOWN), Pose(np.array([0.0, 0.5, 0.4]), DOWN)
BOX = CarriedBox(Pose(np.array([0.0, 0.0, 0.1])), np.array([0.4, 0.3, 0.2]))
STACK = tuple(
    Obstacle(f"box {k}", Pose(np.array([-0.5 + 0.07 * k, 0.82, 0.2])), np.full(3, 0.06)) for k in range(15)
)


@pytest.fixture
def controller() -> MotionController:
    return MotionController(ARM, motion_set("shipped"), 0.0, ARM.home)


@pytest.mark.parametrize("moving", [0, 3])
def test_a_step_takes_well_under_a_millisecond(
    benchmark: BenchmarkFixture, controller: MotionController, moving: int
) -> None:
    things = [
        Obstacle(f"cart {k}", Pose(np.array([-1.0, 3.5 + 0.5 * k, 1.0])), np.full(3, 0.3), is_moving=True)
        for k in range(moving)
    ]
    controller.command(MotionTarget(1, Path((PoseMove(PICK),)), BOX))
    controller.observe(things)

    def step() -> None:
        told = controller.commanded
        controller.step(controller.time + 0.004, JointSample(controller.time, told.q, told.v, told.a))
        controller.status()

    benchmark.pedantic(step, rounds=400, warmup_rounds=20)
    assert benchmark.stats.stats.median < 0.7e-3


def test_a_transfer_past_fifteen_boxes_is_planned_in_under_a_tenth_of_a_second(
    benchmark: BenchmarkFixture, controller: MotionController
) -> None:
    transfer = Transfer((Line(PLACE),), Retreat(UP, (0.1, 1.0)), Retreat(UP, (0.1, 0.7)))
    target = MotionTarget(1, transfer, BOX, STACK)
    prepared = benchmark.pedantic(lambda: controller.prepare(target), rounds=10, warmup_rounds=1)
    assert prepared.plan is not None, prepared.reason
    assert benchmark.stats.stats.median < 0.1


def test_an_inverse_takes_under_a_tenth_of_a_millisecond(benchmark: BenchmarkFixture) -> None:
    X_WT, branch = ARM.chain.forward(ARM.home), ARM.inverse.branch(ARM.home)
    q = benchmark(lambda: ARM.inverse.follow(X_WT, ARM.home, branch))
    np.testing.assert_allclose(q, ARM.home, atol=1e-9)
    assert benchmark.stats.stats.median < 0.1e-3
