"""What the arm does about those who are seen around it: it slows, stands, goes on, and says so."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from pack_core.motion.moves import Line, Mode, Path, PoseMove
from pack_core.motion.target import MotionState, MotionTarget
from pack_core.motion.world import CarriedBox, Obstacle
from pack_core.rotations import Array, Pose
from pack_motion.arm.arm import MotionArm
from pack_motion.clearance.check import Surrounding, with_carried
from pack_motion.clearance.separation import separations
from pack_motion.controller import MotionController
from pack_motion.move_monitor import StuckDetector
from pack_motion.rmpflow.spheres import box_distance
from pack_motion.setpoint_stream import StreamConfig
from pack_motion.tracking.config import MotionSet, motion_set
from unit.pack_motion.loop import PERIOD, Loop, pose

CONFIG = motion_set("shipped")
OVER, BESIDE = pose(-0.3, 0.5, 1.2), pose(0.3, 0.5, 1.2)
LATE = 0.1
"""Age of an observation [s]."""
EVERY = 8
"""Cycles from an observation to the next one, as of the simulated sensor."""
SIZE = np.array([0.5, 0.5, 1.8])
BOX = CarriedBox(Pose(np.array([0.0, 0.0, 0.1])), np.array([0.4, 0.3, 0.2]))
STANDS = 1e-3
"""Speed of joints below which the arm stands [rad/s]."""


def without_policies() -> MotionSet:
    """The shipped set for an arm that never leaves its way."""
    quiet = {
        mode: getattr(CONFIG, mode)._replace(
            collision=getattr(CONFIG, mode).collision._replace(
                metric_modulation_radius=0.0, radius_per_speed=0.0, avoiding_radius=0.0
            )
        )
        for mode in ("fast", "slow")
    }
    return CONFIG.model_copy(update=quiet)


def person(x: float, y: float, v: float = 0.0) -> Obstacle:
    """Somebody who walks along y."""
    return Obstacle(
        "person", Pose(np.array([x, y, 0.9])), SIZE, np.array([0.0, v, 0.0]), is_moving=True
    )  # fmt: skip


def gap(arm: MotionArm, q: Array, who: Obstacle) -> float:
    """Distance of the arm, with the box, from somebody [m]."""
    b = with_carried(arm, Surrounding(carried=BOX))
    box = np.eye(3)[None], who.X_WO.p[None].copy(), 0.5 * SIZE[None]
    return float(separations(*arm.chain.links(q), b.link, b.R, b.p, b.half, *box, 10.0).min())


@pytest.mark.parametrize(
    ("bearing", "far", "age", "every"),
    [(4.0, 2.3, 0.0, 1), (0.1, 3.9, 0.12, 8), (3.8, 3.7, 0.07, 25), (1.1, 4.1, 0.07, 1)],
)
def test_who_runs_at_the_arm_does_not_reach_it_before_it_stands(
    arm: MotionArm, bearing: float, far: float, age: float, every: int
) -> None:
    """Somebody comes straight at the tool at 1.6 m/s, and is seen now and then where he was a moment ago.

    While any joint moves he is farther away than C, also from an arm that is behind its setpoints by all of
    the reaction time, and the margin is at least 0. The policies, which would make room, are silent.
    """
    loop, v = Loop(arm), CONFIG.separation.person_speed
    behind = round(CONFIG.separation.reaction / PERIOD)
    loop.controller = MotionController(arm, without_policies(), 0.0, arm.home)
    loop.controller.command(MotionTarget(1, Path((PoseMove(OVER), PoseMove(BESIDE))), carried=BOX))
    p = OVER.p[:2] + far * np.array([np.cos(bearing), np.sin(bearing)])
    track, least = [p], np.inf
    while np.linalg.norm(OVER.p[:2] - p) > PERIOD * v:
        p = p + PERIOD * v * (OVER.p[:2] - p) / max(float(np.linalg.norm(OVER.p[:2] - p)), 1e-6)
        track.append(p)
        before = track[max(len(track) - 1 - int(age / PERIOD), 0)]
        if len(track) % every == 0:
            loop.controller.observe([person(*before, v)], loop.time - age)
        loop.step()
        if np.abs(loop.v[-1]).max() > STANDS:
            assert loop.controller.margin.value >= 0.0
            least = min(least, gap(arm, loop.q[-1], person(*p)))
        if len(loop.v) > behind and np.abs(loop.v[-1 - behind]).max() > STANDS:
            least = min(least, gap(arm, loop.q[-1 - behind], person(*p)))
    assert least > CONFIG.separation.intrusion
    assert np.all(loop.accelerations <= 1.001)


@pytest.mark.parametrize("late", [LATE, LATE + StreamConfig().horizon])
def test_the_arm_goes_evenly_past_somebody_who_is_seen_now_and_then(arm: MotionArm, late: float) -> None:
    """The age of an observation counts, yet the arm does not hurry after each and brake before the next.

    In the motion node it is older, as setpoints are ahead by the horizon.
    """
    loop = Loop(arm)
    loop.run(MotionTarget(1, Path((PoseMove(OVER),))))
    first = len(loop.v)
    loop.controller.command(MotionTarget(2, Path((PoseMove(BESIDE),))))
    seen, step = person(1.25, 1.3), 0
    while loop.controller.status().state is not MotionState.REACHED:
        if step % EVERY == 0:
            loop.controller.observe([seen], loop.time - late)
        loop.step()
        step += 1
        assert loop.controller.margin.value >= 0.0 or not loop.controller.is_under_way
    speeds = np.linalg.norm(loop.v[first:], axis=1)
    ups_and_downs = np.abs(np.diff(speeds)).sum() / (2.0 * speeds.max())
    assert ups_and_downs < 1.3  # 1 if it gets faster once and slower once


@pytest.mark.parametrize("seed", range(3))
def test_the_noise_of_the_sensor_takes_no_margin_away(arm: MotionArm, seed: int) -> None:
    """Somebody walks past at 1.6 m/s; places and speeds have the noise that the sensor's filter leaves."""
    rng, v = np.random.default_rng(seed), CONFIG.separation.person_speed
    loop, step = Loop(arm), 0
    loop.controller = MotionController(arm, without_policies(), 0.0, arm.home)
    loop.controller.command(MotionTarget(1, Path((PoseMove(OVER), PoseMove(BESIDE)))))
    while loop.controller.status().state is not MotionState.REACHED:
        if step % EVERY == 0:
            at = person(0.9, 4.0 - v * (loop.time - LATE), -v + rng.normal(0.0, 0.04))
            noisy = replace(at, X_WO=Pose(at.X_WO.p + rng.normal(0.0, 0.006, 3)))
            loop.controller.observe([noisy], loop.time - LATE)
        loop.step()
        step += 1
        assert loop.controller.margin.value >= 0.0 or not loop.controller.is_under_way


def test_a_person_who_walks_through_the_way_is_kept_clear_of_and_the_move_is_finished(arm: MotionArm) -> None:
    """The arm waits, says for whom, makes room, and goes on; its margin holds while its reference moves."""
    loop, v = Loop(arm), 1.2
    loop.run(MotionTarget(1, Path((PoseMove(OVER),))))
    moved, reasons, gaps = loop.time, [], []
    loop.controller.command(MotionTarget(2, Path((PoseMove(pose(0.6, 0.9, 1.2)), PoseMove(BESIDE)))))
    while loop.time < moved + 12.0 and loop.controller.status().state is not MotionState.REACHED:
        now = person(0.9, 2.6 - v * (loop.time - moved), -v)
        late = replace(now, X_WO=Pose(now.X_WO.p - LATE * now.v_WO_W))
        loop.controller.observe([late], loop.time - LATE)
        loop.step()
        p = arm.chain.forward_matrix(loop.q[-1])[1]
        gaps.append(box_distance(p, np.eye(3), now.X_WO.p.copy(), 0.5 * SIZE)[0])
        reasons.append(loop.controller.status().reason)
        assert loop.controller.margin.value > -1e-3 or not loop.controller.is_under_way
    assert loop.controller.status().state is MotionState.REACHED
    assert min(gaps) > 0.1
    assert any("gives way" in reason and "person" in reason for reason in reasons)
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
        loop.controller.observe([person(OVER.p[0], y, 0.8 * is_walking)])
        loop.step()
    off = np.abs(loop.tool[first:, :2] - OVER.p[:2]).max()
    assert bool(off > 0.02) is is_left
    assert is_left or off < 0.002


def test_who_stands_in_the_way_is_waited_for_until_he_leaves(arm: MotionArm) -> None:
    loop = Loop(arm)
    loop.run(MotionTarget(1, Path((PoseMove(OVER),))))
    loop.controller.command(MotionTarget(2, Path((Line(BESIDE),))))
    for _ in range(750):
        loop.controller.observe([person(*BESIDE.p[:2])])
        loop.step()
    status = loop.controller.status()
    assert loop.tool[-1, 0] < BESIDE.p[0] - 0.4
    assert status.state is MotionState.MOVING
    assert "gives way" in status.reason
    loop.controller.observe([])
    while loop.time < 12.0 and loop.controller.status().state is not MotionState.REACHED:
        loop.step()
    assert loop.controller.status().state is MotionState.REACHED


def test_it_stands_while_nothing_is_heard_of_those_who_were_seen(arm: MotionArm) -> None:
    loop = Loop(arm)
    loop.controller.observe([person(5.0, 5.0)])
    loop.controller.command(MotionTarget(1, Path((PoseMove(OVER),))))
    while loop.time < 2.0 * CONFIG.separation.blind + 1.0:
        loop.step()
    assert np.abs(loop.v[-1]).max() < STANDS
    assert loop.controller.status().state is MotionState.MOVING
    loop.controller.observe([person(5.0, 5.0)])
    loop.step()
    assert np.abs(loop.v[-1]).max() > STANDS


def test_a_stop_is_not_slowed_down_by_who_is_near(arm: MotionArm) -> None:
    def stopped(*who: Obstacle) -> float:
        loop = Loop(arm)
        loop.controller = MotionController(arm, without_policies(), 0.0, arm.home)
        loop.controller.command(MotionTarget(1, Path((PoseMove(OVER),))))
        while loop.time < 0.5:
            loop.step()
        loop.controller.stop()
        loop.controller.observe(who)
        while not loop.controller.is_standing:
            loop.step()
        return loop.time

    near = replace(person(0.0, 0.0), X_WO=Pose(np.array([0.5, 0.5, 0.9])))
    assert stopped(near) == stopped()


def test_the_margin_is_measured_in_a_stop_and_is_nobody_s_while_the_arm_is_held(arm: MotionArm) -> None:
    loop = Loop(arm)
    loop.controller.command(MotionTarget(1, Path((PoseMove(OVER),))))
    while loop.time < 0.5:
        loop.step()
    loop.controller.stop()
    loop.controller.observe([person(*OVER.p[:2])])
    loop.step()
    assert loop.controller.is_under_way
    assert loop.controller.margin.who == "person"
    assert loop.controller.margin.value < loop.controller.margin.distance
    loop.controller.hold("the driver holds the arm")
    assert not loop.controller.margin.who


def test_keeping_clear_has_more_patience_than_being_stuck() -> None:
    stuck = StuckDetector(CONFIG.stuck)
    n = int(CONFIG.stuck.giving_way) * 10
    assert not any(stuck.update(0.1, 0.0, False, False, gives_way=True) for _ in range(n - 5))
    assert any(stuck.update(0.1, 0.0, False, False) for _ in range(15))
    stuck.restart()
    assert any("gave way" in stuck.update(0.1, 0.0, False, False, gives_way=True) for _ in range(n + 5))
