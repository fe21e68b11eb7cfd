"""What each driver of the packing cell's arm must do, seen through its topics (docs/cells/packing/driver.md).

`pytest tests/contract` runs them against the simulator; the options of the group "driver" name another one.
With a real arm they MOVE IT: the last joint, by a few degrees. Hang nothing on the tool that may not turn.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable

import numpy as np
import pytest
from rclpy.event_handler import SubscriptionEventCallbacks
from std_msgs.msg import Empty
from trajectory_msgs.msg import JointTrajectory

from contract.driver_rig import MOVED, SPEED, DriverRig
from pack_core.joints import Setpoints
from pack_core.packing import topics
from pack_core.packing.scene import Scene
from pack_core.ros.contracts import packing as contracts
from pack_core.ros.contracts import shared
from pack_core.ros.contracts.contract import Contract
from pack_core.ros.messages.conversions import from_stamp
from pack_core.ros.messages.joints import from_joint_state, to_trajectory
from pack_core.ros.messages.packing import from_markers
from pack_core.ros.watch.peer_watch import ALIVE_QOS, alive_topic
from pack_core.topics import CLOCK_RATE

TURN = 0.06
"""By which the joint is turned [rad]."""
STOP = 0.2
"""Within which the arm must rest when no setpoints come any more [s]: 0.1 s of watchdog, and braking."""
OBEDIENT_STOP = 0.09
"""Within which the arm must rest when it is told to: before the watchdog would have noticed anything [s]."""
STILL = 0.005
"""By which an arm that is held may be off [rad]."""
TORQUE = 1.5
"""Feed-forward torque on the joint [N m]: more than its friction, an eighth of the smallest limit."""
DEFLECTION = 0.008
"""What that torque must turn the joint by, against the position gain [rad]."""
SLOW = 0.01
"""Speed below which the arm no longer coasts [rad/s]."""
COLUMNS = ("positions", "velocities", "effort")


def turned(rig: DriverRig, start: np.ndarray) -> float:
    """How far the moved joint has turned since, [rad], inwards positive."""
    return rig.inwards * float(rig.joints.q[MOVED] - start[MOVED])


def assert_held(rig: DriverRig, duration: float = 0.3) -> None:
    """The arm rests and stays for a while."""
    held = rig.joints.q
    begun = rig.time
    rig.wait(duration)
    away = max(np.abs(sample.q - held).max() for sample in rig.samples(begun))
    assert away < STILL, f"the arm moved by {away:.4f} rad while it should be held; allowed: {STILL}"


# What it says


@pytest.mark.parametrize(
    ("contract", "rate"),
    [
        (contracts.JOINT_STATES, topics.JOINT_RATE),
        (contracts.WRENCH, topics.WRENCH_RATE),
        (contracts.GRIPPER_STATE, topics.GRIPPER_RATE),
    ],
    ids=["joints", "wrench", "gripper"],
)
def test_it_speaks_at_the_rate_that_the_cell_expects(rig: DriverRig, contract: Contract, rate: float) -> None:
    mail = rig.graph.probe.mail[contract.name]
    begun = rig.time
    rig.wait_until(lambda: rig.time > begun + 0.3 and len(mail) > 12)
    gaps = np.diff([from_stamp(message.header.stamp) for message in mail])
    assert np.all(gaps > 0.0), "stamps must rise"
    assert np.median(gaps) == pytest.approx(1.0 / rate, rel=0.2)


def test_the_clock_is_that_of_its_stamps(rig: DriverRig) -> None:
    mail = rig.graph.probe.mail[shared.CLOCK.name]
    rig.graph.wait_until(lambda: len(mail) > 0.1 * CLOCK_RATE)
    clocks = np.array([from_stamp(message.clock) for message in mail])
    assert np.all(np.diff(clocks) > 0.0), "the clock must rise"
    assert np.median(np.diff(clocks)) == pytest.approx(1.0 / CLOCK_RATE, rel=0.2)
    assert abs(clocks[-1] - rig.time) < 0.05, "stamps and /clock are of two clocks"


def test_joint_states_are_of_the_cells_arm_finite_and_within_its_limits(rig: DriverRig) -> None:
    rig.wait(0.1)
    message = rig.graph.probe.last(contracts.JOINT_STATES)
    assert tuple(message.name) == rig.arm.joints
    sample = from_joint_state(message, rig.arm.joints)  # refuses what is not finite or of another size
    limits = rig.arm.limits
    assert np.all((limits.lower <= sample.q) & (sample.q <= limits.upper))
    assert np.all(np.abs(sample.v) <= limits.velocity)


def test_the_wrench_is_less_the_payloads_weight(rig: DriverRig) -> None:
    begun = len(rig.graph.probe.mail[contracts.WRENCH.name])
    rig.wait(0.3)
    heard = rig.graph.probe.mail[contracts.WRENCH.name][begun:]
    forces = [math.hypot(m.wrench.force.x, m.wrench.force.y, m.wrench.force.z) for m in heard]
    assert np.all(np.isfinite(forces))
    assert np.mean(forces) < 4.0, "nothing touches the object, so what is left is weight or bias"
    assert all(message.header.frame_id == "tip" for message in heard)


def test_its_force_sensor_was_set_to_zero_in_the_past_if_ever(rig: DriverRig) -> None:
    told = rig.graph.probe.mail[contracts.WRENCH_ZEROED.name]
    assert all(from_stamp(message.stamp) <= rig.time for message in told)


def test_it_says_that_it_is_alive(rig: DriverRig) -> None:
    alive: list[int] = []
    messages: list[Empty] = []
    callbacks = SubscriptionEventCallbacks(liveliness=lambda event: alive.append(event.alive_count))
    rig.graph.probe.create_subscription(
        Empty, alive_topic(rig.name), messages.append, ALIVE_QOS, event_callbacks=callbacks
    )
    rig.graph.wait_until(lambda: alive and alive[-1] == 1)
    rig.graph.wait_until(lambda: messages)


def test_it_reports_its_health_about_once_a_second(rig: DriverRig) -> None:
    rig.wait_for_report()
    begun = time.monotonic()
    for _ in range(3):
        rig.wait_for_report()
    # A busy machine may delay reports; who sends one with every joint state is done in a few milliseconds.
    assert time.monotonic() - begun > 1.0


def test_the_gripper_can_be_commanded(rig: DriverRig) -> None:
    # only whether it is offered: a command would drop what the gripper holds
    rig.graph.wait_until(rig.graph.probe.client_of(contracts.GRIPPER_COMMAND).service_is_ready)


def test_somebody_describes_the_cell_and_sees_its_objects(rig: DriverRig) -> None:
    rig.graph.wait_until(lambda: rig.graph.probe.last(contracts.DESCRIPTION))
    rig.graph.wait_until(lambda: rig.graph.probe.last(contracts.MARKERS))
    scene = Scene.from_yaml(rig.graph.probe.last(contracts.DESCRIPTION).data, "the driver's description")
    frame = from_markers(rig.graph.probe.last(contracts.MARKERS))
    assert set(frame.objects) <= {*scene.names, scene.new_object.name}


# What it does with setpoints


def test_it_follows_setpoints(rig: DriverRig) -> None:
    start = rig.joints
    rig.stream(rig.move(), lambda: turned(rig, start.q) > TURN)
    assert rig.time - start.time < TURN / SPEED + 1.0
    others = np.delete(rig.joints.q - start.q, MOVED)
    assert np.abs(others).max() < STILL


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_feed_forward_torque_pushes_and_without_it_the_arm_stays(rig: DriverRig, sign: float) -> None:
    rig.set_going()
    rig.wait_until(lambda: rig.speed < SLOW)
    start, begun = rig.joints.q, rig.time
    rig.stream(rig.stay(), lambda: rig.time > begun + 0.3)
    assert abs(turned(rig, start)) < STILL
    rig.stream(rig.stay(torque=sign * rig.inwards * TORQUE), lambda: sign * turned(rig, start) > DEFLECTION)


def test_it_stops_and_holds_when_setpoints_grow_stale(rig: DriverRig) -> None:
    sent = rig.set_going(horizon=0.5)
    rig.wait(STOP + 0.1)
    assert rig.time_to_rest(sent) < STOP
    assert_held(rig)


def test_it_holds_when_its_plan_has_run_out_however_often_it_is_sent(rig: DriverRig) -> None:
    rig.set_going()
    last = rig.move()()
    late = Setpoints(
        rig.time - 1.0, last.offsets, last.q + rig.inwards * TURN * np.eye(7)[MOVED], last.v, last.tau
    )
    begun = rig.time
    rig.stream(lambda: late, lambda: rig.time > begun + STOP + 0.1)
    assert rig.time_to_rest(begun) < STOP
    assert_held(rig)


def test_what_comes_last_counts_also_when_its_stamp_is_earlier(rig: DriverRig) -> None:
    # The cell's controller stamps plans with the time at which they will be in force, and a hold with the
    # time of a joint state, so a hold is stamped earlier than the plan that it ends.
    rig.set_going(horizon=0.5)
    joints = rig.joints
    hold = Setpoints(joints.time - 0.05, np.zeros(1), joints.q[None], np.zeros((1, 7)), np.zeros((1, 7)))
    begun = rig.time
    rig.stream(lambda: hold, lambda: rig.time > begun + STOP)
    assert rig.time_to_rest(begun) < OBEDIENT_STOP


def test_it_stops_when_the_sender_dies_and_follows_the_next_one(rig: DriverRig) -> None:
    rig.set_going(horizon=0.5)
    died = rig.time
    rig.kill_sender()
    rig.wait(STOP + 0.1)
    assert rig.time_to_rest(died) < STOP
    assert_held(rig)
    rig.start_sender()
    rig.set_going()


def test_joints_in_another_order_are_put_in_order(rig: DriverRig) -> None:
    rig.set_going()
    rig.wait_until(lambda: rig.speed < SLOW)
    begun, held = rig.time, rig.joints.q
    message = to_trajectory(rig.move()(), rig.arm.joints)
    message.joint_names = message.joint_names[::-1]
    for point in message.points:
        for column in COLUMNS:
            setattr(point, column, getattr(point, column)[::-1])
    rig.send_message(message)
    rig.wait(STOP)
    moved = np.max([np.abs(sample.q - held) for sample in rig.samples(begun)], axis=0)
    assert np.argmax(moved) == MOVED, f"the joints moved by {moved} rad; expected: joint {MOVED + 1} alone"
    assert moved[MOVED] > STILL


# What it refuses


def with_row(column: str, value: float) -> Callable[[JointTrajectory], None]:
    """Puts a value into the last row of a column, at the moved joint."""

    def spoil(message: JointTrajectory) -> None:
        getattr(message.points[-1], column)[MOVED] = value

    return spoil


def rename(message: JointTrajectory) -> None:
    message.joint_names = [f"other_{name}" for name in message.joint_names]


def repeat(message: JointTrajectory) -> None:
    message.joint_names = [message.joint_names[0], message.joint_names[0], *message.joint_names[2:]]


def shorten(message: JointTrajectory) -> None:
    for point in message.points:
        point.positions = point.positions[:6]


def empty(message: JointTrajectory) -> None:
    message.points = []


def stand_still_in_time(message: JointTrajectory) -> None:
    message.points[1].time_from_start = message.points[0].time_from_start


def stamp_by_another_clock(message: JointTrajectory) -> None:
    message.header.stamp.sec += 3600


BAD = {
    "not-finite": {
        **{f"{column} not a number": with_row(column, math.nan) for column in COLUMNS},
        "an infinite torque": with_row("effort", math.inf),
    },
    "beyond-limits": {column: with_row(column, 500.0) for column in COLUMNS},
    "other-joints": {"other names": rename, "a joint twice": repeat, "six positions": shorten},
    "times": {
        "no points": empty,
        "times that do not rise": stand_still_in_time,
        "stamped by another clock": stamp_by_another_clock,
    },
}


@pytest.mark.parametrize("kind", BAD)
def test_bad_setpoints_neither_move_nor_end_it_and_are_counted(rig: DriverRig, kind: str) -> None:
    rig.set_going()
    rig.wait_until(lambda: rig.speed < SLOW)
    rig.wait_for_report()
    refused = rig.refusals()
    for what, spoil in BAD[kind].items():
        begun, held = rig.time, rig.joints.q
        message = to_trajectory(rig.move()(), rig.arm.joints)
        spoil(message)
        # One at a time: of several at once the queue, which keeps the newest one, may lose some.
        rig.send_message(message)
        refused += 1
        rig.wait_until(lambda n=refused, end=begun + STOP: rig.refusals() >= n and rig.time > end)
        away = max(np.abs(sample.q - held).max() for sample in rig.samples(begun))
        assert away < STILL, f"setpoints with {what} moved the arm by {away:.4f} rad; allowed: {STILL}"
    rig.set_going()
