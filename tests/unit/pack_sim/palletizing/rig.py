"""A palletizing cell that is moved: joint moves and straight lines within the arm's limits."""

from __future__ import annotations

import numpy as np
import ruckig

from pack_core.joints import Setpoints
from pack_core.kinematics.chain import chain_from_model
from pack_core.kinematics.spherical_wrist import SphericalWrist
from pack_core.palletizing.boxes import BoxBody
from pack_core.palletizing.cell import PalletizingCell, palletizing_cell
from pack_core.palletizing.model import build_model
from pack_core.robots.kr210 import JERK_LIMITS, LIMITS
from pack_core.robots.surface_gripper import TOOL
from pack_core.rotations import Array, Pose, from_yaw, multiply
from pack_sim.palletizing.simulator import PalletSimulator, PalletSimulatorConfig

PERIOD = 0.004
"""Of references [s]."""
AHEAD = 4
"""Rows of each."""
ACCELERATION = 0.8
"""Of lines [m/s^2]; no joint needs more than it may anywhere in the cell."""
OVER_TABLE = np.array([-2.2265, -1.4325, 1.8754, 0.0, 1.1278, -2.2265])
"""Joint positions with the pad down over the middle of the picking table."""


class Rig:
    """A simulator with a hand on its arm."""

    def __init__(self, cell: PalletizingCell | None = None) -> None:
        self.cell = cell or palletizing_cell()
        self.simulator = PalletSimulator(self.cell, PalletSimulatorConfig())
        self.chain = chain_from_model(build_model(self.cell), LIMITS.names, TOOL)
        self._inverse = SphericalWrist(self.chain, LIMITS.lower, LIMITS.upper)
        self.errors: list[float] = []
        """Distance between the commanded and the true tool at every step [m]."""

    def wait(self, duration: float) -> None:
        for _ in range(round(duration / self.simulator.config.timestep)):
            self.simulator.step()

    def move(self, q: Array, until: float = np.inf) -> None:
        """Fastest joint move; its references end after `until` [s]."""
        move = ruckig.InputParameter(6)
        move.current_position, move.target_position = self._q().tolist(), list(q)
        move.max_velocity, move.max_acceleration = LIMITS.velocity.tolist(), LIMITS.acceleration.tolist()
        move.max_jerk = JERK_LIMITS.tolist()
        plan = ruckig.Trajectory(6)
        ruckig.Ruckig(6).calculate(move, plan)
        times = np.arange(0.0, min(plan.duration, until) + PERIOD, PERIOD)
        rows = [plan.at_time(min(t, plan.duration)) for t in times]
        self._follow(times, *(np.array([row[k] for row in rows]) for k in range(3)))

    def go_over_table(self, p_WT: Array, yaw: float = 0.0) -> None:
        self.move(self._solve(down(p_WT, yaw), OVER_TABLE))

    def go_over_pallet(self, p_WT: Array, yaw: float = 0.0) -> None:
        self.move(self._solve(down(p_WT, yaw), np.array(self.cell.arm.home)))

    def line(self, p_WT: Array, speed: float = 0.25) -> None:
        """Straight to a position with at most `speed` [m/s], the orientation kept."""
        start = self.chain.forward(self._q())
        length = float(np.linalg.norm(p_WT - start.p))
        duration = max(1.875 * length / speed, np.sqrt(5.8 * length / ACCELERATION))
        times = np.arange(0.0, duration + PERIOD, PERIOD)
        s = np.clip(times / duration, 0.0, 1.0)
        share = s**3 * (10.0 - 15.0 * s + 6.0 * s**2)
        qs, q = [], self._q()
        for x in share:
            q = self._solve(Pose(start.p + x * (p_WT - start.p), start.q), q)
            qs.append(q)
        v = np.gradient(np.array(qs), PERIOD, axis=0)
        self._follow(times, np.array(qs), v, np.gradient(v, PERIOD, axis=0))

    def pick(self, name: str) -> None:
        """Take a box off the picking table, and lift it."""
        X_WB = self.simulator.truth().objects[name].X_WO
        top = above(X_WB.p, float(self._box(name).half_extents[2]))
        yaw = float(2 * np.arctan2(X_WB.q[3], X_WB.q[0]))
        self.go_over_table(above(top, 0.1), yaw)
        self.line(above(top, 0.001))
        self.simulator.gripper.close()
        self.wait(0.1)
        self.line(above(top, 0.1))

    def _box(self, name: str) -> BoxBody:
        return next(box for box in self.simulator.boxes if box.name == name)

    def _q(self) -> Array:
        return self.simulator.reference()[0]

    def _solve(self, X_WT: Pose, near: Array) -> Array:
        q = self._inverse.follow(X_WT, near, self._inverse.branch(near))
        assert q is not None, X_WT
        return q

    def _follow(self, times: Array, q: Array, v: Array, a: Array) -> None:
        start = self.simulator.time
        for i in range(len(times) - 1):
            rows = slice(i, i + AHEAD)
            self.simulator.accept(
                Setpoints(start + times[i], times[rows] - times[i], q[rows], v[rows], a=a[rows])
            )
            for _ in range(2):
                self.simulator.step()
                wanted = self.chain.forward(self._q()).p
                self.errors.append(float(np.linalg.norm(wanted - self.simulator.tool_pose().p)))


def down(p_WT: Array, yaw: float = 0.0) -> Pose:
    """The pad down at a place."""
    return Pose(p_WT, multiply(from_yaw(yaw), [0.0, 1.0, 0.0, 0.0]))


def above(p_W: Array, height: float) -> Array:
    """A point so much higher [m]."""
    return p_W + np.array([0.0, 0.0, height])
