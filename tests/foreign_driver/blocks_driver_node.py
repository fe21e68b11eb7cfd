"""The blocks cell with another driver: the arm takes trajectories, as below ros2_control, and no setpoints.

Physics, gripper and camera are the simulator's; what drives the arm is not. `python -m
foreign_driver.blocks_driver_node` starts it in place of the cell's `sim`.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np

from foreign_driver.controller_shell import ControllerShell
from foreign_driver.joint_trajectory_controller import JointTrajectoryController, Tolerances
from foreign_driver.trajectory_follower import TrajectoryFollower
from pack_core.robots.ur10e import LIMITS
from pack_core.ros.contracts.contract import Contract
from pack_sim.blocks.blocks_sim_node import BlocksSimNode
from pack_sim.blocks.simulator import BlocksSimulator
from pack_sim.ros.physics_node import run_sim_with_camera

CONTROLLER = "joint_trajectory_controller"
NOBODY = "nobody"
"""Whom this driver watches: it does not know who sends trajectories."""


class BlocksDriverNode(BlocksSimNode):
    """Node `sim` with a joint trajectory controller.

    Attributes:
        refusal: why trajectories are rejected; empty: they are not.
    """

    refusal = ""

    def __init__(self, **kwargs: Any) -> None:
        self.controller: JointTrajectoryController | None = None
        super().__init__(**kwargs)

    def start(
        self, setpoints: Contract, sender: str, joints: Sequence[str], services: Iterable[Any], factor: float,
        camera: Any = None,
    ) -> None:  # fmt: skip
        none = np.zeros(len(joints))
        self.controller = JointTrajectoryController(len(joints), Tolerances(none, none))
        self.shell = ControllerShell(
            self, CONTROLLER, LIMITS.names, self.controller, self.lock, self._refusal
        )
        self._drive(self._simulator)
        super().start(setpoints, NOBODY, joints, services, factor, camera)

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

    def _build(self, *args: Any) -> BlocksSimulator:
        simulator = super()._build(*args)
        if self.controller is not None:
            self.controller.stop()
            self._drive(simulator)
        return simulator

    def _drive(self, simulator: BlocksSimulator) -> None:
        assert self.controller is not None
        joints = simulator.joints()
        self.controller.begin(joints.time, joints.q, joints.v)
        simulator.follower = TrajectoryFollower(self.controller, self.shell.after_cycle)


def main() -> int:
    return run_sim_with_camera(BlocksDriverNode)


if __name__ == "__main__":
    raise SystemExit(main())
