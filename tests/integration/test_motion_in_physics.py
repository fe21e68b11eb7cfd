"""The motion controller moves the simulated arm: how well it is followed, and what it avoids."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
import pytest

from pack_core.joints import Setpoints
from pack_core.motion.moves import UP, Line, Path, PoseMove, Retreat, Transfer
from pack_core.motion.target import MotionState, MotionTarget
from pack_core.motion.world import Obstacle
from pack_core.palletizing.cell import palletizing_cell
from pack_core.rotations import Array, Pose, angle_between, from_rpy
from pack_motion.arm.arm import load_arm
from pack_motion.controller import MotionController
from pack_motion.rmpflow.spheres import box_distance
from pack_motion.tracking.config import motion_set
from pack_sim.palletizing.simulator import PalletSimulator, PalletSimulatorConfig

PERIOD, STEPS = 0.004, 2
ARM = load_arm("palletizing")
ABOVE, AT = (Pose(np.array([-2.5, 2.5, z]), from_rpy((np.pi, 0.0, 0.2))) for z in (1.2, 0.95))
PLACE = Pose(np.array([0.0, 0.5, 0.5]), from_rpy((np.pi, 0.0, 1.2)))
World = Callable[[float], list[Obstacle]]


@dataclass
class Physics:
    """The controller and the simulator in lockstep, and errors of the tool against its reference."""

    position_mm: list[float] = field(default_factory=list)
    orientation_deg: list[float] = field(default_factory=list)
    tool: list[Array] = field(default_factory=list)

    def __post_init__(self) -> None:
        cell = palletizing_cell()
        self.simulator = PalletSimulator(cell, PalletSimulatorConfig())
        self.motion = MotionController(ARM, motion_set("shipped"), 0.0, np.array(cell.arm.home))

    def run(self, target: MotionTarget, world: World | None = None) -> MotionState:
        assert self.motion.command(target).is_accepted
        state = MotionState.MOVING
        while state not in (MotionState.REACHED, MotionState.STUCK):
            if world is not None:
                self.motion.observe(world(self.simulator.time))
            self._advance()
            state = self.motion.status().state
        return state

    def _advance(self) -> None:
        simulator, last = self.simulator, self.motion.commanded
        new = self.motion.step(simulator.time + PERIOD, simulator.joints())
        rows = [np.stack([getattr(last, name), getattr(new, name)]) for name in ("q", "v", "a")]
        simulator.accept(Setpoints(simulator.time, np.array([0.0, PERIOD]), *rows[:2], a=rows[2]))
        for _ in range(STEPS):
            simulator.step()
        self._compare()

    def _compare(self) -> None:
        told, is_at = self.simulator.reference()[0], self.simulator.joints().q
        X_told, X_at = ARM.chain.forward(told), ARM.chain.forward(is_at)
        self.position_mm.append(1000.0 * float(np.linalg.norm(X_told.p - X_at.p)))
        self.orientation_deg.append(float(np.rad2deg(angle_between(X_told.q, X_at.q))))
        self.tool.append(X_at.p)


@pytest.fixture
def physics() -> Physics:
    return Physics()


def test_a_transfer_is_followed_within_the_targets_and_no_reference_is_refused(physics: Physics) -> None:
    lines = (Line(AT, label="approach"),)
    back = (Line(PLACE, label="approach"),)
    hover, depart = Retreat(UP, (0.1, 0.5)), Retreat(UP, (0.1, 0.5))
    for k, move in enumerate((Transfer(lines, hover), Transfer(back, hover, depart))):
        assert physics.run(MotionTarget(k, move)) is MotionState.REACHED
    assert np.mean(physics.position_mm) < 0.3
    assert np.max(physics.position_mm) < 1.0
    assert np.mean(physics.orientation_deg) < 0.03
    assert np.max(physics.orientation_deg) < 0.10
    assert np.linalg.norm(physics.tool[-1] - PLACE.p) < 0.002


def test_an_obstacle_that_comes_along_is_kept_clear_of_in_physics(physics: Physics) -> None:
    size, v = np.full(3, 0.3), np.array([0.0, 0.25, 0.0])
    start = np.array([-0.25, 1.9, 1.65])
    gaps = []

    def world(time: float) -> list[Obstacle]:
        X_WO = Pose(start + time * v)
        if physics.tool:
            gaps.append(box_distance(physics.tool[-1].copy(), np.eye(3), X_WO.p.copy(), 0.5 * size)[0])
        return [Obstacle("cart", X_WO, size, v, is_moving=True)]

    assert physics.run(MotionTarget(1, Path((PoseMove(ABOVE),))), world) is MotionState.REACHED
    assert min(gaps) > 0.05
    assert min(gaps) < 0.6
    assert np.linalg.norm(physics.tool[-1] - ABOVE.p) < 0.002
    assert np.max(physics.position_mm) < 1.0
