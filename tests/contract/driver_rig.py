"""A sender of setpoints beside a driver that is known by its topics alone.

Time is that of the driver's stamps, simulated or not. Only the last joint is moved, by a few degrees and
towards the middle of its range.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np
from diagnostic_msgs.msg import DiagnosticStatus
from trajectory_msgs.msg import JointTrajectory

from integration.harness import Graph
from pack_core.joints import JointSample, Setpoints
from pack_core.robots.seven_axis_arm import SevenAxisArm
from pack_core.ros.contracts import packing as contracts
from pack_core.ros.contracts import shared
from pack_core.ros.messages.conversions import from_stamp
from pack_core.ros.messages.joints import from_joint_state, to_trajectory
from pack_core.ros.node import CellNode

SENDER = "mpc"
"""Name of the node that sends setpoints in the cell; a driver may watch whether it is alive."""
MOVED = 6
"""The joint that is moved: the last one, which turns the tool about its own axis."""
SPEED = 0.2
"""Of the moved joint [rad/s]."""
HORIZON = 0.24
"""Length of a plan, as the cell's controller sends it [s]."""
ROWS = 11
PERIOD = 0.02
"""Between two messages of a stream [s]."""
AT_REST = 0.03
"""Speed below which the arm counts as resting [rad/s]; measured speeds have noise."""
START_TIME = 60.0
"""For which a driver may take until it is heard [s of wall clock]."""
PATIENCE = 5.0
"""For which a condition may take [s of the driver's time]."""


class DriverRig:
    """Sends to the driver and hears it.

    Args:
        graph: on the driver's domain.
        arm: that the driver drives.
        name: of the driver's node.

    Attributes:
        inwards: sign of the moved joint's way to the middle of its range.
    """

    def __init__(self, graph: Graph, arm: SevenAxisArm, name: str) -> None:
        self.graph, self.arm, self.name = graph, arm, name
        self.inwards = 1.0
        graph.probe.listen(
            contracts.JOINT_STATES, contracts.WRENCH, contracts.WRENCH_ZEROED, contracts.GRIPPER_STATE,
            contracts.MARKERS, contracts.DESCRIPTION, shared.DIAGNOSTICS, shared.CLOCK,
        )  # fmt: skip
        self.start_sender()

    def start_sender(self) -> None:
        """Start the node whose setpoints the driver takes."""
        self.sender = self.graph.start(partial(CellNode, SENDER))
        self._publisher = self.sender.advertise(contracts.SETPOINTS)

    def kill_sender(self) -> None:
        """End that node."""
        self.graph.stop(self.sender)

    def wait_for_driver(self) -> None:
        """Until the driver is heard, listens to setpoints, and its arm is at rest."""
        self.graph.wait_until(lambda: self.graph.probe.last(contracts.JOINT_STATES), START_TIME)
        self.graph.wait_until(lambda: self._publisher.get_subscription_count() > 0, START_TIME)
        self.wait_until(lambda: self.speed < AT_REST)
        # Decided once: the joint may come past the middle of its range while it is moved.
        limits, q = self.arm.limits, self.joints.q[MOVED]
        self.inwards = 1.0 if q < (limits.lower[MOVED] + limits.upper[MOVED]) / 2 else -1.0

    @property
    def joints(self) -> JointSample:
        """The newest joint state."""
        return from_joint_state(self.graph.probe.last(contracts.JOINT_STATES), self.arm.joints)

    @property
    def time(self) -> float:
        """The driver's time [s]."""
        return from_stamp(self.graph.probe.last(contracts.JOINT_STATES).header.stamp)

    @property
    def speed(self) -> float:
        """Speed of the fastest joint [rad/s]."""
        return float(np.abs(self.joints.v).max())

    def samples(self, after: float) -> list[JointSample]:
        """All joint states since a time [s], oldest first."""
        mail = self.graph.probe.mail[contracts.JOINT_STATES.name]
        newer = [message for message in mail if from_stamp(message.header.stamp) > after]
        return [from_joint_state(message, self.arm.joints) for message in newer]

    def time_to_rest(self, after: float) -> float:
        """From `after` to the last joint state in motion [s]."""
        moving = [s.time for s in self.samples(after) if np.abs(s.v).max() > AT_REST]
        return max([after, *moving]) - after

    def wait_until(self, condition: Callable[[], object]) -> None:
        """Spin until the condition holds; an AssertionError says that it did not within PATIENCE."""
        begun = self.time

        def is_decided() -> bool:
            assert self.time < begun + PATIENCE, f"waited {PATIENCE} s of the driver's time in vain"
            return bool(condition())

        self.graph.wait_until(is_decided, timeout=90.0)

    def wait(self, duration: float) -> None:
        """Spin for a while of the driver's time [s]."""
        begun = self.time
        self.wait_until(lambda: self.time >= begun + duration)

    def send(self, setpoints: Setpoints) -> None:
        """Send setpoints."""
        self.send_message(to_trajectory(setpoints, self.arm.joints))

    def send_message(self, message: JointTrajectory) -> None:
        """Send a message as it is."""
        self._publisher.publish(message)

    def stream(self, plan: Callable[[], Setpoints], until: Callable[[], object]) -> float:
        """Send what `plan` gives every PERIOD until the condition holds; when the last one was sent [s]."""
        sent = self.time

        def is_reached() -> bool:
            nonlocal sent
            if until():
                return True
            if self.time >= sent + PERIOD:
                sent = self.time
                self.send(plan())
            return False

        self.send(plan())
        self.wait_until(is_reached)
        return sent

    def move(self, horizon: float = HORIZON) -> Callable[[], Setpoints]:
        """Plans that turn the moved joint inwards at SPEED, from now and from here on."""
        start, speed = self.joints, self.inwards * SPEED

        def plan() -> Setpoints:
            now = self.time
            offsets = np.linspace(0.0, horizon, ROWS)
            q, v = np.tile(start.q, (ROWS, 1)), np.zeros((ROWS, 7))
            q[:, MOVED] += speed * (now - start.time + offsets)
            v[:, MOVED] = speed
            return Setpoints(now, offsets, q, v, np.zeros((ROWS, 7)))

        return plan

    def stay(self, torque: float = 0.0) -> Callable[[], Setpoints]:
        """Plans that hold the arm where it is now, with a feed-forward torque on the moved joint [N m]."""
        q = np.tile(self.joints.q, (2, 1))
        tau = np.zeros((2, 7))
        tau[:, MOVED] = torque
        return lambda: Setpoints(self.time, np.array([0.0, HORIZON]), q, np.zeros((2, 7)), tau)

    def set_going(self, horizon: float = HORIZON) -> float:
        """Stream a move until the arm follows it; when the last plan was sent [s]."""
        return self.stream(self.move(horizon=horizon), lambda: self.speed > 0.7 * SPEED)

    def status(self) -> DiagnosticStatus:
        """The driver's newest health; empty while none was heard."""
        mail = self.graph.probe.mail[shared.DIAGNOSTICS.name]
        own = [status for message in mail for status in message.status if status.name == self.name]
        return own[-1] if own else DiagnosticStatus()

    def refusals(self) -> int:
        """How many setpoints the driver has refused, as it says in /diagnostics."""
        counts: dict[str, Any] = {item.key: item.value for item in self.status().values}
        return int(counts.get(f"refused {contracts.SETPOINTS.name}", 0))

    def wait_for_report(self) -> None:
        """Until the driver has spoken in /diagnostics once more."""
        mail = self.graph.probe.mail[shared.DIAGNOSTICS.name]
        heard = len(mail)
        self.graph.wait_until(
            lambda: any(s.name == self.name for message in mail[heard:] for s in message.status)
        )
