"""Near where the gripper acts a transfer is slow, and away from it as fast as without."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from pack_core.motion.moves import UP, Mode, Retreat, Transfer
from pack_core.rotations import Array
from pack_motion.arm.arm import MotionArm
from pack_motion.clearance.check import ClearanceCheck, Surrounding
from pack_motion.clearance.transfer import TransferPlanner
from pack_motion.reference.path_planner import MotionPlan, PathPlanner
from pack_motion.reference.trajectory import JointState
from unit.pack_motion.clearance.test_transfer import CLEARANCE, PICK, PLACE, Bench, transfer
from unit.pack_motion.loop import SHARE

SLOW, ZONE = 0.24, 0.1


@pytest.fixture(scope="module")
def start(arm: MotionArm) -> JointState:
    return JointState.at_rest(Bench(arm).at_pick.q)


def planned(arm: MotionArm, start: JointState, move: Transfer) -> MotionPlan:
    paths = PathPlanner(arm, SHARE)
    return TransferPlanner(arm, paths, ClearanceCheck(arm, CLEARANCE)).plan(start, move, Surrounding())


def slowed(zone: float = ZONE) -> Transfer:
    lift = Retreat(UP, (0.3, 0.7), 1.0, pass_speed=0.5, slow_length=zone, slow_speed=SLOW)
    hover = Retreat(UP, (0.3, 1.0), 1.0, pass_speed=0.5, slow_length=zone, slow_speed=SLOW)
    lines = tuple(replace(line, speed=1.0) for line in transfer().lines[:1]) + transfer().lines[1:]
    return Transfer(lines, hover, lift)


def tool_speeds(arm: MotionArm, plan: MotionPlan) -> tuple[Array, Array]:
    """Positions `(T, 3)` [m] and speeds `(T,)` [m/s] of the tool."""
    rows = plan.trajectory
    p = np.array([arm.chain.forward_matrix(q)[1] for q in rows.q])
    v = np.array([(arm.chain.jacobian(q) @ v)[:3] for q, v in zip(rows.q, rows.v, strict=True)])
    return p, np.linalg.norm(v, axis=1)


def test_within_the_zone_of_both_ends_the_tool_is_slow_and_beyond_it_is_not(
    arm: MotionArm, start: JointState
) -> None:
    plan = planned(arm, start, slowed())
    p, speed = tool_speeds(arm, plan)
    near = (np.linalg.norm(p - PICK.p, axis=1) < ZONE) | (np.linalg.norm(p - PLACE.p, axis=1) < ZONE)
    assert speed[near].max() <= SLOW + 1e-6
    assert speed[near].max() > 0.9 * SLOW
    assert speed[~near].max() > 1.0


def test_without_a_zone_the_same_transfer_is_fast_there(arm: MotionArm, start: JointState) -> None:
    p, speed = tool_speeds(arm, planned(arm, start, slowed(0.0)))
    assert speed[np.linalg.norm(p - PICK.p, axis=1) < ZONE].max() > 1.5 * SLOW


def test_slow_parts_run_with_the_slow_policies_and_fast_ones_with_the_fast(
    arm: MotionArm, start: JointState
) -> None:
    plan = planned(arm, start, slowed())
    modes = {segment.label: segment.mode for segment in plan.segments}
    assert list(modes) == ["depart", "rise", "transit", "descend", "approach", "insert"]
    assert {label for label, mode in modes.items() if mode is Mode.SLOW} == {"depart", "approach", "insert"}


def test_a_retreat_as_short_as_the_zone_is_slow_as_a_whole(arm: MotionArm, start: JointState) -> None:
    move = slowed()
    short = Transfer(
        move.lines, replace(move.hover, lengths=(0.1, 1.0)), replace(slowed().hover, lengths=(0.1, 0.7))
    )
    labels = [segment.label for segment in planned(arm, start, short).segments]
    assert labels == ["depart", "transit", "approach", "insert"]
