"""Leads an arm by setpoints or trajectories, for drivers of arms that are led along positions.

As in `driver_rig`, time is that of the driver's stamps, and only the last joint is moved, towards the middle
of its range.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np
from pack_interfaces.msg import ArmState
from pack_interfaces.srv import StopArm
from std_srvs.srv import Trigger
from trajectory_msgs.msg import JointTrajectory

from contract.driver_rig import AT_REST, PATIENCE, START_TIME
from integration.harness import Graph
from pack_core.joints import JointSample, Setpoints
from pack_core.ros.contracts import motion as contracts
from pack_core.ros.contracts import shared
from pack_core.ros.messages.conversions import from_stamp
from pack_core.ros.messages.joints import from_joint_state, to_trajectory
from pack_core.ros.node import CellNode
from pack_core.rotations import Array
from pack_motion.arm.arm import load_arm
from pack_motion.ros.trajectory_client import TrajectoryClient

SENDER = "motion"
"""Name of the node that leads the arm in the cell; a driver may watch whether it is alive."""
PERIOD, HORIZON = 0.02, 0.2
"""Between messages of setpoints, and how far they reach [s]: a busy machine may halt who sends them."""
STEP = 0.01
"""Between rows of setpoints [s]."""
TOLERANCE = 0.01
"""For which a joint may lag at its velocity limit [s]; the cells ask for less by default."""


class PositionRig:
    """Sends to the driver and hears it.

    Args:
        graph: on the driver's domain.
        cell: whose arm it is.
        name: of the driver's node in /diagnostics.
        action: of a driver that takes trajectories; empty: setpoints are sent.

    Attributes:
        rejected: why trajectories were rejected.
        aborted: why trajectories were given up.
    """

    def __init__(self, graph: Graph, cell: str, name: str, action: str) -> None:
        self.graph, self.name, self.arm = graph, name, load_arm(cell)
        self.rejected: list[str] = []
        self.aborted: list[str] = []
        limits = self.arm.limits
        graph.probe.listen(contracts.JOINT_STATES, shared.ARM_STATE, shared.DIAGNOSTICS, shared.CLOCK)
        self.sender = graph.start(partial(CellNode, SENDER))
        self._client = None
        if action:
            self._client = TrajectoryClient(
                self.sender, action, limits.names, TOLERANCE * limits.velocity,
                self.rejected.append, self.aborted.append,
            )  # fmt: skip
        else:
            self._publisher = self.sender.advertise(contracts.SETPOINTS)

    @property
    def takes_trajectories(self) -> bool:
        """Whether the driver takes whole trajectories."""
        return self._client is not None

    def close(self) -> None:
        """End what the graph does not."""
        if self._client is not None:
            self._client.close()

    def wait_for_driver(self) -> None:
        """Until the driver is heard, takes commands, is not stopped, and its arm is at rest."""
        self.graph.wait_until(lambda: self.graph.probe.last(contracts.JOINT_STATES), START_TIME)
        self.graph.wait_until(self._is_heard, START_TIME)
        self.graph.wait_until(lambda: self.arm_state is not None, START_TIME)
        if self.arm_state.is_stopped:
            self.resume()
        self.wait_until(lambda: self.speed < AT_REST)
        limits, q = self.arm.limits, self.joints.q[-1]
        self.inwards = 1.0 if q < (limits.lower[-1] + limits.upper[-1]) / 2 else -1.0

    def _is_heard(self) -> bool:
        return self._client.is_there if self._client else self._publisher.get_subscription_count() > 0

    @property
    def joints(self) -> JointSample:
        """The newest joint state."""
        return from_joint_state(self.graph.probe.last(contracts.JOINT_STATES), self.arm.limits.names)

    @property
    def time(self) -> float:
        """The driver's time [s]."""
        return from_stamp(self.graph.probe.last(contracts.JOINT_STATES).header.stamp)

    @property
    def speed(self) -> float:
        """Speed of the fastest joint [rad/s]."""
        return float(np.abs(self.joints.v).max())

    @property
    def arm_state(self) -> ArmState:
        """What the driver has said last of its arm."""
        return self.graph.probe.last(shared.ARM_STATE)

    def samples(self, after: float) -> list[JointSample]:
        """All joint states since a time [s], oldest first."""
        mail, names = self.graph.probe.mail[contracts.JOINT_STATES.name], self.arm.limits.names
        return [from_joint_state(m, names) for m in mail if from_stamp(m.header.stamp) > after]

    def wait_until(self, condition: Callable[[], object], patience: float = PATIENCE) -> None:
        """Spin until the condition holds; an AssertionError says that it did not in the driver's time [s]."""
        begun = self.time

        def is_decided() -> bool:
            assert self.time < begun + patience, f"waited {patience} s of the driver's time in vain"
            return bool(condition())

        self.graph.wait_until(is_decided, timeout=90.0)

    def wait(self, duration: float) -> None:
        """Spin for a while of the driver's time [s]."""
        begun = self.time
        self.wait_until(lambda: self.time >= begun + duration, duration + PATIENCE)

    def turn(self, angle: float, duration: float) -> Callable[[float], tuple[Array, Array, Array]]:
        """The way that turns the last joint inwards from here, now: positions, velocities, accelerations.

        It is the quintic from rest to rest, of q(s) = 10 s^3 - 15 s^4 + 6 s^5.
        """
        start = self.joints

        def way(time: float) -> tuple[Array, Array, Array]:
            s = min(max((time - start.time) / duration, 0.0), 1.0)
            q, v, a = start.q.copy(), np.zeros(len(start.q)), np.zeros(len(start.q))
            q[-1] += self.inwards * angle * s**3 * (10.0 - 15.0 * s + 6.0 * s**2)
            v[-1] = self.inwards * angle * 30.0 * s**2 * (1.0 - s) ** 2 / duration
            a[-1] = self.inwards * angle * 60.0 * s * (1.0 - s) * (1.0 - 2.0 * s) / duration**2
            return q, v, a

        return way

    def begin(self, angle: float, duration: float) -> Callable[[], object]:
        """Begin a move of `turn`; what is to be called until it is over, as setpoints have to be sent."""
        way, begun = self.turn(angle, duration), self.time
        if self._client is not None:
            offsets = np.linspace(0.0, duration, max(round(duration / 0.02), 1) + 1)
            self._client.send(rows_of(way, begun, offsets))
            return lambda: None
        sent = begun

        def go_on() -> None:
            nonlocal sent
            if self.time >= sent + PERIOD:
                sent = self.time
                self.send(to_trajectory(self.setpoints(way), self.arm.limits.names))

        return go_on

    def setpoints(self, way: Callable[[float], tuple[Array, Array, Array]]) -> Setpoints:
        """Setpoints of a way, from now to the horizon."""
        return rows_of(way, self.time, np.arange(0.0, HORIZON + 1e-9, STEP))

    def send(self, message: JointTrajectory) -> None:
        """Send setpoints as they are."""
        self._publisher.publish(message)

    def send_trajectory(self, trajectory: Setpoints) -> None:
        """Send a trajectory as it is."""
        assert self._client is not None
        self._client.send(trajectory)

    def follow(self, go_on: Callable[[], object], until: Callable[[], object]) -> None:
        """Lead the arm until a condition holds."""
        self.wait_until(lambda: (go_on(), until())[1])

    def halt(self) -> None:
        """Lead the arm no longer: without setpoints it brakes, and of trajectories it is told."""
        if self._client is not None:
            self._client.cancel()

    def stop(self) -> None:
        """Stop the arm, by its driver's service."""
        assert self.graph.call(shared.STOP_ARM, StopArm.Request(reason="contract test")).success

    def resume(self) -> None:
        """Release the arm."""
        assert self.graph.call(shared.RESUME_ARM, Trigger.Request()).success

    def refusals(self) -> int:
        """How many setpoints the driver has refused, as it says in /diagnostics, or trajectories."""
        if self._client is not None:
            return len(self.rejected)
        mail = self.graph.probe.mail[shared.DIAGNOSTICS.name]
        own = [status for message in mail for status in message.status if status.name == self.name]
        counts: dict[str, Any] = {item.key: item.value for item in own[-1].values} if own else {}
        return int(counts.get(f"refused {contracts.SETPOINTS.name}", 0))


def rows_of(way: Callable[[float], tuple[Array, Array, Array]], time: float, offsets: Array) -> Setpoints:
    """Setpoints on a way."""
    q, v, a = (np.array(column) for column in zip(*(way(time + o) for o in offsets), strict=True))
    return Setpoints(time, offsets, q, v, a=a)
