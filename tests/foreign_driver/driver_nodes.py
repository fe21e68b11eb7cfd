"""Cells with another driver: the arm takes trajectories, as below ros2_control, and no setpoints.

Physics, gripper and camera are the simulator's; what drives the arm is not.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np

from foreign_driver.controller_shell import ControllerShell
from foreign_driver.effort_arm import EffortLaw, effort_controller
from foreign_driver.joint_trajectory_controller import JointTrajectoryController, Tolerances
from foreign_driver.trajectory_follower import TrajectoryFollower
from pack_core.ros.contracts.contract import Contract
from pack_sim.blocks.blocks_sim_node import BlocksSimNode
from pack_sim.packing.sim_node import PackingSimNode
from pack_sim.palletizing.pallet_sim_node import PalletSimNode
from pack_sim.ros.physics_node import PhysicsNode

CONTROLLER = "joint_trajectory_controller"
ACTION = f"/{CONTROLLER}/follow_joint_trajectory"
NOBODY = "nobody"
"""Whom such a driver watches: it does not know who sends trajectories."""


class TrajectoryDriven(PhysicsNode):
    """What makes a simulator's node one with a joint trajectory controller.

    Attributes:
        refusal: why trajectories are rejected; empty: they are not.
    """

    refusal = ""
    controller: JointTrajectoryController | None = None
    _simulated: Any = None

    @property
    def _simulator(self) -> Any:
        """The simulated cell; whichever the cell's node builds, the controller drives it."""
        return self._simulated

    @_simulator.setter
    def _simulator(self, simulator: Any) -> None:
        self._simulated = simulator
        if self.controller is not None:
            self.controller.stop()
            self._drive(simulator)

    def start(
        self, setpoints: Contract, sender: str, joints: Sequence[str], services: Iterable[Any], factor: float,
        camera: Any = None,
    ) -> None:  # fmt: skip
        self.controller = self._make_controller(len(joints))
        self.shell = ControllerShell(
            self, CONTROLLER, tuple(joints), self.controller, self.lock, self._refusal
        )
        self._drive(self._simulated)
        super().start(setpoints, NOBODY, joints, services, factor, camera)

    def _make_controller(self, n: int) -> JointTrajectoryController:
        return JointTrajectoryController(n, Tolerances(np.zeros(n), np.zeros(n)))

    def destroy_node(self) -> None:
        self.stop()
        self.shell.close()
        super().destroy_node()

    def _refusal(self) -> str:
        if self._brake.is_stopped:
            return "the robot is stopped"
        if self.controller is not None:
            self.controller.release()
        return self.refusal

    def _drive(self, simulator: Any) -> None:
        assert self.controller is not None
        joints = simulator.joints()
        self.controller.begin(joints.time, joints.q, joints.v)
        simulator.follower = TrajectoryFollower(self.controller, self.shell.after_cycle)


class BlocksDriverNode(TrajectoryDriven, BlocksSimNode):
    """The UR10e of the blocks cell."""


class PalletDriverNode(TrajectoryDriven, PalletSimNode):
    """The KR 210 of the palletizing cell."""


class PackingDriverNode(TrajectoryDriven, PackingSimNode):
    """The Panda of the packing cell, by effort: the node `relay` sends it trajectories."""

    def _make_controller(self, n: int) -> JointTrajectoryController:
        return effort_controller(n)

    def _drive(self, simulator: Any) -> None:
        super()._drive(simulator)
        simulator.controller = EffortLaw(simulator.cell.robot)
        simulator.follower = TrajectoryFollower(self.controller, self.shell.after_cycle, "tau")


NODES = {"packing": PackingDriverNode, "palletizing": PalletDriverNode, "blocks": BlocksDriverNode}
