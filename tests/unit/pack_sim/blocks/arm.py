"""Drives the simulated arm along straight lines of its tool, for tests of what the physics does."""

import numpy as np

from pack_core.blocks.cell import BlocksCell
from pack_core.blocks.model import TOOL, arm_model
from pack_core.joints import Setpoints
from pack_core.kinematics.chain import chain_from_model
from pack_core.kinematics.parallel_axes import ParallelAxes
from pack_core.robots.ur10e import JOINTS, LIMITS
from pack_core.rotations import Pose, conjugate, exp, from_yaw, log, multiply
from pack_sim.blocks.simulator import BlocksSimulator

ROW = 0.004


def tool_down(x: float, y: float, z: float, yaw: float) -> Pose:
    return Pose(np.array([x, y, z]), multiply(from_yaw(yaw), np.array([0.0, 1.0, 0.0, 0.0])))


class TestArm:
    """Follows quintic lines between poses, in the branch of the cell's look-out."""

    __test__ = False

    def __init__(self, cell: BlocksCell, simulator: BlocksSimulator) -> None:
        chain = chain_from_model(arm_model(cell), JOINTS, TOOL)
        self._inverse = ParallelAxes(chain, LIMITS.lower, LIMITS.upper)
        self._q = np.array(cell.robot.look)
        self._branch = self._inverse.branch(self._q)
        self._simulator = simulator
        self.X_WT = chain.forward(self._q)

    def move(self, X_WG: Pose, duration: float) -> None:
        """To a pose, as the tool's own line."""
        times = ROW * np.arange(round(duration / ROW) + 1)
        s = times / times[-1]
        shares = 10 * s**3 - 15 * s**4 + 6 * s**5
        q = np.array([self._solve(self._between(X_WG, share)) for share in shares])
        v = np.gradient(q, ROW, axis=0)
        v[[0, -1]] = 0.0
        reference = Setpoints(self._simulator.time, times, q, v, a=np.gradient(v, ROW, axis=0))
        timestep = self._simulator.config.timestep
        for _ in range(round(times[-1] / timestep)):
            self._simulator.accept(reference)
            self._simulator.step()
        self.X_WT = X_WG

    def wait(self, duration: float) -> None:
        for _ in range(round(duration / self._simulator.config.timestep)):
            self._simulator.step()

    def _solve(self, X_WT: Pose) -> np.ndarray:
        q = self._inverse.follow(X_WT, self._q, self._branch)
        assert q is not None, f"out of reach: {X_WT}"
        self._q = q
        return q

    def _between(self, X_WG: Pose, share: float) -> Pose:
        turn = log(multiply(conjugate(self.X_WT.q), X_WG.q))
        p = self.X_WT.p + share * (X_WG.p - self.X_WT.p)
        return Pose(p, multiply(self.X_WT.q, exp(share * turn)))
