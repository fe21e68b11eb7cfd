"""How far off a pushed block ends, by the length of its push: what a price of long pushes would buy."""

import sys

import numpy as np
import pytest

from block_fsm.requests import ExecutorRequest, Look
from block_fsm.task import RearrangeTask
from pack_core.blocks.cell import blocks_cell
from pack_core.blocks.plan import PickPlace, Plan, PlanStatus, Push
from pack_core.blocks.planar import QUARTER, PlanarPose, turn_between
from pack_core.blocks.problem import Problem
from pack_core.states import SceneState
from pack_lockstep.blocks.lockstep import BlocksLockstep
from pack_lockstep.blocks.settings import lockstep_config

LENGTHS_MM = (5, 15, 30, 50, 70, 90, 115)
REPEATS = 1
CENTRE = blocks_cell().workspace.centre


class PushAgain:
    """Plans one push after the other, each of a block that is put down where its push begins."""

    def __init__(self) -> None:
        rng = np.random.default_rng(2000)
        self._left = [length / 1000 for _ in range(REPEATS) for length in LENGTHS_MM]
        self._rng = rng

    def __call__(self, problem: Problem) -> Plan:
        if not self._left:
            return Plan(PlanStatus.OPTIMAL)
        rng, length = self._rng, self._left.pop()
        seen, yaw = problem.starts["a"], float(rng.uniform(-0.5, 0.5))
        x, y = np.array(CENTRE) + rng.uniform(-0.06, 0.06, 2)
        begin = PlanarPose(float(x), float(y), yaw)
        end = begin.moved(length, yaw + QUARTER * float(rng.integers(4)))
        return Plan(PlanStatus.FEASIBLE, (PickPlace("a", seen, begin, 0), Push("a", begin, end)))


@pytest.mark.benchmark
@pytest.mark.timeout(7200)
def test_a_push_of_any_length_ends_within_the_executor_s_tolerance(
    capsys: pytest.CaptureFixture[str],
) -> None:
    cell, config = blocks_cell(), lockstep_config()
    executor = config.executor.model_copy(update={"spare_actions": 4 * REPEATS * len(LENGTHS_MM)})
    config = config.model_copy(update={"executor": executor})
    side = np.array(CENTRE) + 0.4 * np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]])
    task = RearrangeTask({"a": PlanarPose(*CENTRE)}, tuple(map(tuple, side.tolist())))
    lockstep = BlocksLockstep(cell, task, {"a": PlanarPose(*CENTRE, 0.2)}, PushAgain(), config)
    rows: list[tuple[float, float, float, float]] = []

    def on_request(request: ExecutorRequest, truth: SceneState) -> None:
        action = lockstep.executor.action
        if isinstance(request, Look) and isinstance(action, Push):
            pose = PlanarPose.of(truth.objects["a"].X_WO)
            c, s = np.cos(action.direction), np.sin(action.direction)
            x, y = 1000 * (pose.p - action.end.p)
            turn = np.rad2deg(turn_between(pose, action.end))
            rows.append((1000 * action.distance, c * x + s * y, c * y - s * x, turn))

    lockstep.run(on_request)
    assert len(rows) == REPEATS * len(LENGTHS_MM)
    errors = np.array(rows)
    text = "\nlength [mm]  along [mm]  across [mm]  turn [deg]: largest of each length"
    for length in LENGTHS_MM:
        own = np.abs(errors[np.abs(errors[:, 0] - length) < 2.0])
        text += f"\n{length:11}  {own[:, 1].max():10.2f}  {own[:, 2].max():11.2f}  {own[:, 3].max():10.2f}"
    with capsys.disabled():
        sys.stdout.write(text + "\n")
    tolerance = config.executor.tolerance
    assert np.abs(errors[:, 1]).max() <= 1000 * tolerance.push_along
    assert np.abs(errors[:, 2]).max() <= 1000 * tolerance.push_lateral
    assert np.abs(errors[:, 3]).max() <= tolerance.push_angle_deg
