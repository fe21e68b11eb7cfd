"""What the arm does about obstacles that move: it slows, stands, goes on, and says so."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from pack_core.motion.moves import Line, Mode, Path, PoseMove
from pack_core.motion.target import MotionState, MotionTarget
from pack_core.motion.world import Obstacle
from pack_core.rotations import Pose
from pack_motion.arm.arm import MotionArm
from pack_motion.move_monitor import StuckDetector
from pack_motion.reference.trajectory import JointState
from pack_motion.rmpflow.spheres import box_distance
from pack_motion.tracking.config import motion_set
from pack_motion.tracking.speed_separation import SpeedSeparationMonitor, Threat
from unit.pack_motion.loop import PERIOD, Loop, pose

CONFIG = motion_set("shipped")
OVER, BESIDE = pose(-0.3, 0.5, 1.2), pose(0.3, 0.5, 1.2)
SIZE = np.array([0.5, 0.5, 1.8])


def person(y: float, v: float = 0.0, x: float = 0.0) -> Obstacle:
    return Obstacle(
        "person", Pose(np.array([x, y, 0.9])), SIZE, np.array([0.0, v, 0.0]), is_moving=True
    )  # fmt: skip


@pytest.fixture
def monitor(arm: MotionArm) -> SpeedSeparationMonitor:
    return SpeedSeparationMonitor(CONFIG.speed_separation, arm.chain, arm.limits.acceleration)


def settled(monitor: SpeedSeparationMonitor, arm: MotionArm, threat: Threat) -> float:
    """The rate after a second, on a reference that moves the tool at about 1 m/s."""
    planned = JointState(arm.home, np.array([0.6, 0.0, 0.0, 0.0, 0.0, 0.0]), np.zeros(6))
    for _ in range(250):
        rate = monitor.update(planned, 0.0, threat, PERIOD)
    return rate


def test_the_nearer_and_faster_an_obstacle_the_slower_the_reference(
    monitor: SpeedSeparationMonitor, arm: MotionArm
) -> None:
    far, near, fast, at_hand = (
        settled(
            SpeedSeparationMonitor(CONFIG.speed_separation, arm.chain, arm.limits.acceleration), arm, threat
        )
        for threat in (Threat(5.0, 1.0), Threat(0.7, 0.5), Threat(0.7, 1.0), Threat(0.2, 0.5))
    )
    assert far == 1.0
    assert 1.0 > near > fast > 0.0
    assert at_hand == 0.0


def test_it_stands_while_nothing_is_heard_of_those_who_were_seen(
    monitor: SpeedSeparationMonitor, arm: MotionArm
) -> None:
    assert settled(monitor, arm, Threat(5.0, 0.0, is_blind=True)) == 0.0
    assert monitor.gives_way
    assert settled(monitor, arm, Threat(5.0, 0.0)) == 1.0


def test_an_obstacle_that_has_stopped_long_ago_is_not_given_way_to(
    monitor: SpeedSeparationMonitor, arm: MotionArm
) -> None:
    settled(monitor, arm, Threat(0.3, 1.0))
    assert monitor.gives_way
    for _ in range(int(CONFIG.speed_separation.calm_time) + 1):
        settled(monitor, arm, Threat(0.3, 0.0))
    assert not monitor.gives_way


def test_giving_way_has_more_patience_than_being_stuck() -> None:
    stuck = StuckDetector(CONFIG.stuck)
    assert not any(stuck.update(0.1, 0.0, False, False, gives_way=True) for _ in range(150))
    assert any(stuck.update(0.1, 0.0, False, False) for _ in range(15))
    stuck.restart()
    assert any("gave way" in stuck.update(0.1, 0.0, False, False, gives_way=True) for _ in range(250))


def test_a_person_who_walks_through_the_way_is_kept_clear_of_and_the_move_is_finished(
    arm: MotionArm,
) -> None:
    """The observation comes late, so the person is where the velocity says, not where it was seen."""
    gaps, slowest, latency, v = [], [], 0.1, 1.2
    loop = Loop(arm)
    loop.run(MotionTarget(1, Path((PoseMove(OVER),))))
    moved = loop.time

    def world(time: float) -> list[Obstacle]:
        now = person(2.6 - v * (time - moved), -v, x=0.9)
        p = arm.chain.forward_matrix(loop.q[-1])[1]
        gaps.append(box_distance(p, np.eye(3), now.X_WO.p, 0.5 * SIZE)[0])
        slowest.append(loop.controller.status().reason)
        return [now]

    loop.controller.command(MotionTarget(2, Path((PoseMove(pose(0.6, 0.9, 1.2)), PoseMove(BESIDE)))))
    while loop.time < moved + 12.0 and loop.controller.status().state is not MotionState.REACHED:
        seen = world(loop.time)
        late = replace(seen[0], X_WO=Pose(seen[0].X_WO.p - latency * seen[0].v_WO_W))
        loop.controller.observe([late], loop.time - latency)
        loop.step()
    assert loop.controller.status().state is MotionState.REACHED
    assert min(gaps) > 0.1
    assert any("gives way" in reason and "person" in reason for reason in slowest)
    assert np.all(loop.accelerations <= 1.001)


@pytest.mark.parametrize(("mode", "is_left"), [(Mode.FAST, True), (Mode.SLOW, False)])
def test_fast_policies_leave_the_path_for_what_slow_ones_only_stop_for(
    arm: MotionArm, mode: Mode, is_left: bool
) -> None:
    """A person comes as near as 0.3 m to a tool on a line near contact, and to one on a line that is not."""
    loop = Loop(arm)
    loop.run(MotionTarget(1, Path((PoseMove(OVER),))))
    down = Pose(OVER.p - np.array([0.0, 0.0, 0.5]), OVER.q)
    loop.controller.command(MotionTarget(2, Path((Line(down, speed=0.24, mode=mode),))))
    begun = loop.time
    first = len(loop.q)
    for _ in range(750):
        y = OVER.p[1] - 0.25 - max(0.30, 1.3 - 0.8 * (loop.time - begun))
        is_walking = y < OVER.p[1] - 0.56
        loop.controller.observe([person(y, 0.8 * is_walking, x=OVER.p[0])])
        loop.step()
    off = np.abs(loop.tool[first:, :2] - OVER.p[:2]).max()
    assert bool(off > 0.02) is is_left
    assert is_left or off < 0.002
