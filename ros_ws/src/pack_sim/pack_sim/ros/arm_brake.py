"""The driver's STOP: brakes the arm at once and holds it, whatever the other nodes do."""

from __future__ import annotations

import time
from collections.abc import Callable
from threading import Lock

import numpy as np
from pack_interfaces.msg import ArmState
from pack_interfaces.srv import StopArm
from std_srvs.srv import Trigger

from pack_core.errors import MessageError
from pack_core.joints import JointSample
from pack_core.ros.contracts import shared
from pack_core.ros.messages.conversions import to_stamp
from pack_core.ros.node import CellNode

STANDING = 0.02
"""Largest speed of a joint that counts as standing [rad/s]: the servo's last swing is below it."""
REST_TIME = 0.05
"""The arm stands once it has been that slow for so long [s]; a swing passes through zero faster."""
IN_FLIGHT = 0.5
"""Setpoints that come this soon after a stop were sent before it and are no fault of their sender [s of
wall clock]."""


class ArmBrake:
    """Stops the arm on request and refuses setpoints until it is released.

    The services are of the driver itself and ask no other node. Stopping means that the driver forgets its
    setpoints: it then brakes as it does when they are lost, jerk-limited and within the joints' limits, and
    holds the arm. Gripper and pump keep what they hold.

    Args:
        node: the driver's node.
        drop: has the driver forget its setpoints.
        joints: gives what the joint sensors measure now.
        lock: held while `drop` and `joints` are called.
    """

    def __init__(
        self, node: CellNode, drop: Callable[[], None], joints: Callable[[], JointSample], lock: Lock
    ) -> None:
        self._node, self._drop, self._joints, self._lock = node, drop, joints, lock
        self._state = node.advertise(shared.ARM_STATE)
        self._is_stopped = self._is_standing = False
        self._reason, self._stops, self._stopped_at = "", 0, 0.0
        self._slow_since = 0.0
        for contract, serve in ((shared.STOP_ARM, self._on_stop), (shared.RESUME_ARM, self._on_resume)):
            node.create_service(contract.type, contract.name, serve)
        with lock:
            self._publish()

    @property
    def is_stopped(self) -> bool:
        """Whether the arm was stopped and not released since."""
        return self._is_stopped

    def check(self) -> bool:
        """Whether setpoints may be followed; those that were on their way at the stop are dropped silently.

        Raises:
            MessageError: the arm was stopped, long enough ago for the sender to know.
        """
        if self._is_stopped and time.monotonic() > self._stopped_at + IN_FLIGHT:
            raise MessageError(
                f"the arm was stopped ({self._reason}); call {shared.RESUME_ARM.name}, reset the cell, or "
                "send the next goal"
            )
        return not self._is_stopped

    def watch(self) -> None:
        """Tell once that the arm has come to rest after a stop; called under the lock after every tick."""
        if not self._is_stopped or self._is_standing:
            return
        joints = self._joints()
        if np.abs(joints.v).max() > STANDING:
            self._slow_since = joints.time
        elif joints.time - self._slow_since >= REST_TIME:
            self._is_standing = True
            self._publish()

    def release(self) -> None:
        """Follow setpoints again; called under the lock, also by a reset. Does nothing if not stopped."""
        if self._is_stopped:
            self._is_stopped = self._is_standing = False
            self._reason = ""
            self._node.get_logger().info("the arm follows setpoints again")
            self._publish()

    def _on_stop(self, request: StopArm.Request, response: StopArm.Response) -> StopArm.Response:
        with self._lock:
            self._drop()
            if self._is_stopped:
                response.message = f"the arm was stopped already: {self._reason}"
            else:
                self._begin(request.reason or "on request")
        response.success = True
        return response

    def _begin(self, reason: str) -> None:
        self._is_stopped, self._reason = True, reason
        self._stops, self._stopped_at = self._stops + 1, time.monotonic()
        self._slow_since = self._joints().time
        self._publish()
        self._node.get_logger().warning(f"the arm was stopped: {reason}")

    def _on_resume(self, _: Trigger.Request, response: Trigger.Response) -> Trigger.Response:
        with self._lock:
            response.success = self._is_stopped
            response.message = "" if self._is_stopped else "the arm was not stopped"
            self.release()
        return response

    def _publish(self) -> None:
        message = ArmState(
            is_stopped=self._is_stopped, is_standing=self._is_standing, reason=self._reason, stops=self._stops
        )
        message.header.stamp = to_stamp(self._joints().time)
        self._state.publish(message)
