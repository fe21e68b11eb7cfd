"""The node `relay`: the packing cell's setpoints for a joint trajectory controller with effort interfaces."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from pydantic import Field, PositiveFloat, field_validator

from pack_core.config import Config
from pack_core.errors import MessageError
from pack_core.joints import JointSample, Setpoints
from pack_core.ros.contracts import packing as contracts
from pack_core.ros.contracts.contract import NEWEST
from pack_core.ros.messages.serialized import JointStateReader
from pack_core.ros.messages.serialized_setpoints import TrajectoryReader, TrajectoryWriter
from pack_core.ros.node import CellNode
from pack_core.ros.packing import read_packing_cell
from pack_core.ros.run import run_node
from pack_core.ros.sole_publisher import SolePublisher
from pack_core.ros.stream import Stream, StreamReader
from pack_sim.packing.effort_relay import EffortRelay

SENDERS = "senders"
"""Name of the fault that more than one node sends setpoints."""
SENDER = "mpc"
"""The node whose setpoints are passed on; when it falls silent the arm is held."""
READ_PERIOD = 0.05
"""Longest time for which the reader waits for a message [s of wall clock]."""


class EffortRelayConfig(Config):
    """Parameters of the node `relay`."""

    joint_trajectory: str = Field(
        default=contracts.CONTROLLER_TRAJECTORY.name,
        description="topic from which the driver's joint trajectory controller takes trajectories",
    )
    watchdog: PositiveFloat = Field(default=0.1, description="age at which setpoints are stale [s]")

    @field_validator("joint_trajectory")
    @classmethod
    def _check_topic(cls, name: str) -> str:
        if not name.startswith("/"):
            raise ValueError(
                f"'{name}'; allowed: a name with its namespace, such as /CONTROLLER/joint_trajectory"
            )
        return name


class EffortRelayNode(CellNode):
    """Passes setpoints on as they come; looks at every joint state whether the arm is to be held."""

    def __init__(self, **kwargs: Any) -> None:
        super().__init__("relay", **kwargs)
        config, arm = self.read_parameters(EffortRelayConfig), read_packing_cell(self).robot.arm
        self._relay = EffortRelay(arm.limits, config.watchdog)
        self._sample: JointSample | None = None
        self._is_abandoned = False
        contract = contracts.CONTROLLER_TRAJECTORY
        self._trajectories = self.create_publisher(contract.type, config.joint_trajectory, contract.qos)
        self._writer = TrajectoryWriter(arm.joints)
        self._setpoint_reader, self._joint_reader = (
            TrajectoryReader(arm.joints, "tau"),
            JointStateReader(arm.joints),
        )
        self._joints = Stream(self, replace(contracts.JOINT_STATES, qos=NEWEST), raw=True)
        self._setpoints = Stream(self, contracts.SETPOINTS, raw=True, on_match=lambda: self._senders.check())
        self._senders = SolePublisher(self, self._setpoints.topic_name, self._on_senders)
        self._senders.track(SENDER)
        self._reader = StreamReader(self, (self._joints, self._setpoints), self._read, READ_PERIOD)
        self.watch((SENDER,), self._on_sender)

    @property
    def waits_for(self) -> str:
        if self._sample is None:
            return f"no {contracts.JOINT_STATES.name} yet: is the driver up?"
        if not self._trajectories.get_subscription_count():
            return (
                f"nobody takes trajectories at {self._trajectories.topic_name} yet: is the controller active?"
            )
        return ""

    def destroy_node(self) -> None:
        """Stop reading, then the node."""
        self._reader.end()
        super().destroy_node()

    def _read(self) -> None:
        for data in self._joints.take_all():
            self.guard(contracts.JOINT_STATES, self._on_joints, data)
        for data in self._setpoints.take_all():
            self.guard(contracts.SETPOINTS, self._on_setpoints, data)

    def _on_joints(self, data: bytes) -> None:
        self._sample = self._joint_reader.read(data)
        if self._is_abandoned:
            self._relay.drop()
        self._pass(self._relay.advance(self._sample))

    def _on_setpoints(self, data: bytes) -> None:
        if self._sample is None:
            raise MessageError(
                f"setpoints before the first {contracts.JOINT_STATES.name}; the driver tells no joints"
            )
        if self._is_abandoned:
            raise MessageError(f"setpoints of '{SENDER}', which has fallen silent since; the arm holds")
        if self._senders.trouble:
            raise MessageError(f"{self._senders.trouble}; allowed: one sender")
        self._pass(self._relay.accept(self._setpoint_reader.read(data), self._sample.time))

    def _pass(self, setpoints: Setpoints | None) -> None:
        if setpoints is not None:
            self._trajectories.publish(self._writer.write(setpoints))

    def _on_sender(self, _: str, is_alive: bool) -> None:
        self._is_abandoned = not is_alive

    def _on_senders(self, trouble: str) -> None:
        """Name those that send setpoints when they are more than one; the arm holds meanwhile."""
        if not trouble:
            self.health.faults.pop(SENDERS, None)
            return
        self.health.faults[SENDERS] = f"{trouble}; end all but one"
        self.get_logger().error(self.health.faults[SENDERS])
        self._relay.drop()

    def on_peer_end(self, peer: str) -> None:
        """Its publishers, which are still listed, count no more."""
        self._senders.forget(peer)
        super().on_peer_end(peer)


def main() -> int:
    """Entry point of `effort_relay_node`."""
    return run_node(EffortRelayNode)


if __name__ == "__main__":
    raise SystemExit(main())
