"""How the empty cup gets about: over objects, down on them, and away from them."""

from __future__ import annotations

import numpy as np

from pack_core.packing.cell import PackingCell
from pack_core.packing.scene import Scene
from pack_core.packing.scene_item import SceneItem
from pack_core.rotations import POINTING_DOWN, Array, Pose, from_yaw, multiply, yaw_of
from pack_core.tasks.steps import Steps
from pack_mpc.filling.fill_config import FillConfig
from pack_mpc.filling.requests import FillCommand, FillPort, Until
from pack_mpc.filling.tool_motion import PERIOD, CupMotion, CupPace, ToolArm, lines
from pack_mpc.task.stages import nearest_heading

PAUSE = 0.1
"""Time after a motion until the arm has come to rest [s]."""
UNLED = 0.1
"""After so long without setpoints a driver stops the arm [s], docs/cells/packing/driver.md."""
STANDING, REST_TIME = 0.01, 0.5
"""Speed of joints below which the arm stands [rad/s], and the longest wait for it [s]."""


class CupMoves:
    """Motions of the cup through free space, and straight up and down, with or without an object.

    Args:
        port: the cell as the job has it.
        cell: the cell's physical facts.
        config: speeds and heights.
        scene: the cell as described.
        tallest: height of the tallest object that will be handed over [m].

    Attributes:
        port: the cell as the job has it.
        arm: the arm's kinematics.
        scene: to be replaced whenever the cell's description changes.
    """

    def __init__(
        self, port: FillPort, cell: PackingCell, config: FillConfig, scene: Scene, tallest: float
    ) -> None:
        self.port, self.arm, self.scene = port, ToolArm(cell), scene
        self._cell, self._config, self._tallest = cell, config, tallest

    def go_over(self, item: SceneItem, X_WN: Pose) -> Steps[None]:
        """Bring the empty cup over an object at X_WN, upright above everything on the way."""
        X_WT, config = self.cup, self._config
        # near the home heading, so that the last joint can turn either way afterwards
        yaw = nearest_heading(item, yaw_of(X_WN.q), self.arm.home_heading)
        q_WT = multiply(from_yaw(yaw), POINTING_DOWN)
        top = float(X_WN.p[2] + item.half_extents[2])
        goal = np.array([*X_WN.p[:2], top + config.approach])
        across = np.array([*(goal[:2] - X_WT.p[:2]), 0.0])
        if np.linalg.norm(across) < config.approach:
            ways = [goal - X_WT.p]
        else:
            travel = max(self._highest + config.clearance, goal[2], float(X_WT.p[2]))
            up, down = travel - float(X_WT.p[2]), float(goal[2]) - travel
            ways = [np.array([0.0, 0.0, up]), across, np.array([0.0, 0.0, down])]
        ways = [way for way in ways if np.linalg.norm(way) > 1e-4] or [np.zeros(3)]
        yield from self.move(ways, self.pace(config.speed), q_WT)

    def is_over(self, X_WN: Pose) -> bool:
        """Whether the cup is so nearly over an object at X_WN that it seals when it comes down."""
        aside = self.cup.p[:2] - X_WN.p[:2]
        return float(np.linalg.norm(aside)) < self._config.centring

    def make_way(self) -> Steps[None]:
        """Raise the empty cup where it stands in the way of what is handed over next."""
        p_WT = self.cup.p
        aside = float(np.linalg.norm(p_WT[:2] - np.array(self._cell.hand_over.centre)))
        missing = self._tallest + self._config.clearance - float(p_WT[2])
        if aside <= self._config.hand_over_reach and missing > 0.0:
            yield from self.rise(missing)

    def down(self, way: float, until: Until) -> Steps[None]:
        """Come down slowly, until a condition holds."""
        yield from self.move([np.array([0.0, 0.0, -way])], self.gentle(self._config.touch_speed), until=until)

    def rise(self, way: float, until: Until | None = None, speed: float | None = None) -> Steps[None]:
        """Rise straight up; what comes next need not wait for the arm to come to rest."""
        way_up = np.array([0.0, 0.0, way])
        yield from self.move([way_up], self.pace(speed or self._config.speed), until=until, pause=0.0)

    def reaches(self, height: float) -> bool:
        """Whether the arm can raise the cup straight up by a height [m]."""
        port, ways = self.port, [np.array([0.0, 0.0, height])]
        motion = self.arm.plan(
            port.q, port.time, lines(self.cup, ways, self.pace(self._config.speed), self._config)
        )
        raised = float((self.arm.cup(motion.q[-1]).p - self.cup.p)[2])
        return raised > height - self._config.approach

    def pace(self, speed: float) -> CupPace:
        """The pace of motions through free space at a speed [m/s]."""
        return CupPace(speed, self._config.acceleration)

    def gentle(self, speed: float) -> CupPace:
        """The pace of motions that end on a contact, whose start must not feel like one, at a speed [m/s]."""
        return CupPace(speed, self._config.touch_acceleration)

    def move(
        self,
        ways: list[Array],
        pace: CupPace,
        q_WT: Array | None = None,
        until: Until | None = None,
        pause: float = PAUSE,
    ) -> Steps[None]:
        """Go along displacements `(3,)` [m] and for `pause` [s] beyond, or until a condition holds."""
        port, last = self.port, self.port.time
        corners = self.cup.p + np.cumsum(ways, axis=0)
        motion = self.arm.plan(port.q, port.time, lines(self.cup, ways, pace, self._config, q_WT))
        while port.time < motion.end + pause:
            if until is not None and until():
                return
            if port.time - last > UNLED:
                # The driver has stopped the arm meanwhile: to go on by the clock would throw it ahead.
                yield from self._come_to_rest()
                left = self._ways_left(motion, corners, last)
                yield from self.move(left, pace, q_WT, until, pause)
                return
            last = port.time
            port.command = FillCommand(motion.setpoints(port.time))
            yield

    def _come_to_rest(self) -> Steps[None]:
        """Wait, without setpoints, until the driver has stopped the arm."""
        yield from self.port.wait(lambda: bool(np.all(np.abs(self.port.seen.joints.v) < STANDING)), REST_TIME)

    def _ways_left(self, motion: CupMotion, corners: Array, time: float) -> list[Array]:
        """Displacements from where the cup is over the corners that it had not passed at a time [s]."""
        cups = np.array([self.arm.cup(q).p for q in motion.q])
        passed = [int(np.argmin(np.linalg.norm(cups - corner, axis=1))) for corner in corners[:-1]]
        row = (time - motion.start) / PERIOD
        left = [corner for corner, at in zip(corners, [*passed, np.inf], strict=True) if at > row]
        return list(np.diff(np.array([self.cup.p, *left]), axis=0))

    @property
    def cup(self) -> Pose:
        """X_WT of the cup where the arm is."""
        return self.arm.cup(self.port.q)

    def contact(self, force: float | None = None) -> Until:
        """A condition: the external force has changed by more than `force` [N] from what it is now."""
        port, tare, limit = self.port, self.port.seen.force, force or self._config.touch_force
        return lambda: float(np.linalg.norm(port.seen.force - tare)) > limit

    @property
    def _highest(self) -> float:
        """Height of the tallest thing that the empty cup may meet [m]."""
        return max(self.scene.rim, 2.0 * float(self.scene.new_object.half_extents[2]))
