"""What a calibration may use of the cell: moves, the driver's joints and torques, gripper and camera.

Nothing else of the simulator is reached from here on: where things truly are stays unknown.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from pack_core.camera import LOOKING_DOWN
from pack_core.errors import PackError
from pack_core.joints import JointSample
from pack_core.motion.moves import Line, Move, Path, PoseMove
from pack_core.motion.target import MotionState, MotionTarget, ReachTolerance
from pack_core.motion.world import CarriedBox, Obstacle
from pack_core.palletizing.box_body import BoxBody
from pack_core.palletizing.cell import PalletizingCell
from pack_core.palletizing.view import Picture
from pack_core.rotations import Array, Pose, from_yaw, multiply
from pack_lockstep.driven_arm import DrivenArm
from pack_lockstep.palletizing.lockstep import PalletLockstepConfig
from pack_motion.arm.arms import load_arm
from pack_motion.controller import MotionController
from pack_motion.tracking.config import motion_set
from pack_sim.palletizing.overhead_camera import PalletCamera
from pack_sim.palletizing.simulator import PalletSimulator

LONGEST_MOVE = 60.0
"""A move that takes longer has failed [s]."""
UNEVEN = np.array([0.004, -0.003, 0.0])
"""By how much an operator misses the place where something is to be laid [m]."""
LOOSE = ReachTolerance(position=0.02, orientation_deg=2.0)
"""Way-points need not be reached exactly: what counts is what the joints report there."""


class CalibrationFailed(PackError):
    """The calibration cannot be finished; the text says why."""


class CalibrationRig:
    """The cell as an operator of a calibration has it.

    Args:
        simulator: stands in for driver, gripper and camera.
        camera: the overhead camera, open.
        known: the cell as it is known.
        config: parameters of the run.
    """

    def __init__(
        self,
        simulator: PalletSimulator,
        camera: PalletCamera,
        known: PalletizingCell,
        config: PalletLockstepConfig,
    ) -> None:
        self.known, self._simulator, self._camera, self._config = known, simulator, camera, config
        self.arm, q = load_arm("palletizing"), np.array(known.arm.home)
        self._motion = MotionController(self.arm, motion_set(config.motion), simulator.time, q)
        self._drive = DrivenArm(self._motion, simulator, q, config.period, self._fail)
        self._begin = simulator.time
        self._id = 0
        self.obstacles: tuple[Obstacle, ...] = ()
        self.carried: CarriedBox | None = None

    @property
    def seconds(self) -> float:
        """Simulated time since the start [s]."""
        return self._simulator.time - self._begin

    @property
    def period(self) -> float:
        """Time between two samples of the joints [s]."""
        return self._config.period

    def joints(self) -> JointSample:
        """What the driver reports now."""
        return self._simulator.joints()

    def tool(self) -> Pose:
        """X_WT by the reported joints."""
        return self.arm.chain.forward(self.joints().q)

    def go(self, X_WT: Pose, *, contacts: frozenset[str] = frozenset(), speed: float = 1.0) -> None:
        """Move to a pose of the tool, wherever the way is clear.

        Raises:
            CalibrationFailed: it is out of reach, not clear, or was not reached.
        """
        self._follow(Path((PoseMove(X_WT, speed=speed),)), contacts)

    def line(self, X_WT: Pose, speed: float = 0.25, *, contacts: frozenset[str] = frozenset()) -> None:
        """Move straight to a pose of the tool; raises CalibrationFailed."""
        self._follow(Path((Line(X_WT, speed, 0.5),)), contacts)

    def press(self, X_WT: Pose, speed: float, until: Callable[[JointSample], bool]) -> list[JointSample]:
        """Move straight and slowly towards a pose, and stop when `until` says so.

        Returns:
            All samples on the way, at every period.

        Raises:
            CalibrationFailed: the pose was reached, so nothing was there.
        """
        self._command(Path((Line(X_WT, speed, 0.1),)), frozenset(), is_checked=False)
        samples = [self.joints()]
        while not until(samples[-1]):
            if self._motion.status().state in (MotionState.REACHED, MotionState.STUCK):
                raise CalibrationFailed(
                    f"nothing was touched on the way to {np.round(X_WT.p, 3).tolist()} m; is it there?"
                )
            self._drive.advance()
            samples.append(self.joints())
        self._motion.stop()
        self.wait(0.15)
        return samples

    def wait(self, time: float) -> None:
        """Let simulated time pass [s]."""
        for _ in range(round(time / self._config.period)):
            self._drive.advance()

    def bring(self, body: BoxBody, X_WB: Pose) -> None:
        """The operator lays something on the picking table, some millimetres from where it was asked for."""
        self._simulator.lay(body, Pose(X_WB.p + UNEVEN, X_WB.q))
        self.wait(0.5)

    def take_away(self, name: str) -> None:
        """The operator takes something out of the cell."""
        self._simulator.remove(name)
        self.carried = None

    def grip(self, carried: CarriedBox) -> None:
        """Close the gripper; raises CalibrationFailed when it holds nothing."""
        self._simulator.gripper.close()
        end = self.seconds + 2.0
        while not self._simulator.gripper.is_closed:
            if self.seconds > end:
                reason = self._simulator.gripper.state.reason
                raise CalibrationFailed(f"the gripper holds nothing: {reason}")
            self.wait(self._config.period)
        self.wait(0.3)
        self.carried = carried

    def release(self) -> None:
        """Open the gripper."""
        self._simulator.gripper.open()
        self.wait(0.3)
        self.carried = None

    def look(self) -> tuple[Picture, JointSample]:
        """A picture, and the joints while it was taken."""
        self.wait(0.4)
        sample = self.joints()
        picture = self._camera.picture(self._simulator.snapshot())
        self.wait(float(np.mean(self._latency())))
        return picture, sample

    def _latency(self) -> tuple[float, float]:
        camera, usual = self.known.imperfections.camera, self._config.sight.latency
        return (usual, usual) if camera is None else camera.latency

    def _follow(self, move: Move, contacts: frozenset[str]) -> None:
        self._command(move, contacts, is_checked=True)
        end = self.seconds + LONGEST_MOVE
        while self._motion.status().state is not MotionState.REACHED:
            status = self._motion.status()
            if status.state in (MotionState.STUCK, MotionState.REFUSED) or self.seconds > end:
                raise CalibrationFailed(f"the arm did not arrive: {status.reason or status.state.value}")
            self._drive.advance()

    def _command(self, move: Move, contacts: frozenset[str], *, is_checked: bool) -> None:
        self._id += 1
        target = MotionTarget(
            self._id, move, self.carried, self.obstacles, contacts, LOOSE, is_checked=is_checked
        )
        answer = self._motion.command(target)
        if not answer.is_accepted:
            raise CalibrationFailed(f"the arm cannot go there: {answer.reason}")

    def _fail(self, reason: str) -> None:
        raise CalibrationFailed(reason)


def rotated_down(yaw: float) -> Array:
    """Orientation wxyz of a tool that points down, its x axis at a yaw [rad]."""
    return multiply(from_yaw(yaw), LOOKING_DOWN)
