"""Moves that pick, place and push blocks: paths of the tool, and the obstacles that they are checked against.

The tool frame T is between the finger tips, z out of the gripper, and the fingers close along its x. It
points down at a heading, that of its x axis.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from block_fsm.executor_config import ExecutorConfig
from pack_core.blocks.cell import BlocksCell
from pack_core.blocks.gripper import GripperFootprint
from pack_core.blocks.plan import PickPlace, Push
from pack_core.blocks.planar import QUARTER, PlanarPose, wrapped
from pack_core.blocks.problem import CUBE, CUBES, BlockSize, BlockSizes
from pack_core.motion.moves import JointMove, Line, Path, PoseMove
from pack_core.motion.world import CarriedBox, Obstacle
from pack_core.rotations import POINTING_DOWN, Array, Pose, from_yaw, multiply, yaw_of

TABLE = "table"
THICKNESS = 0.04
"""Of the table's top [m]."""
TOUCHING = 0.001
"""Blocks that are seen this near to each other may touch [m]."""
CORNERS = np.array([[1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0], [1.0, -1.0]])
"""Of a rectangle of half an edge 1, seen from above `(4, 2)`."""


class TableObstacles:
    """Makes the obstacles that a move is checked against.

    Args:
        cell: whose table it is.
        sizes: of the blocks that are not cubes, by id.
    """

    def __init__(self, cell: BlocksCell, sizes: BlockSizes = CUBES) -> None:
        (x, y), size = cell.table.centre, cell.table.size
        self._table = Obstacle(TABLE, Pose(np.array([x, y, -0.5 * THICKNESS])), np.array([*size, THICKNESS]))
        self._sizes = sizes

    def among(self, poses: Mapping[str, PlanarPose], without: str = "") -> tuple[Obstacle, ...]:
        """The table and the blocks at these poses but for one."""
        blocks = (
            Obstacle(name, pose.pose(0.5 * self._size(name).z), np.array(self._size(name)))
            for name, pose in poses.items() if name != without
        )  # fmt: skip
        return (self._table, *blocks)

    def carried(self, X_WT: Pose, block: str, pose: PlanarPose) -> CarriedBox:
        """A block that goes with the tool from where both are now."""
        size = self._size(block)
        return CarriedBox(X_WT.inverse() @ pose.pose(0.5 * size.z), np.array(size))

    def beside(self, block: str, poses: Mapping[str, PlanarPose]) -> frozenset[str]:
        """The table and the other blocks that a block may touch where it stands."""
        others = [name for name in poses if name != block]
        near = {name for name in others if self._gap(block, name, poses) < TOUCHING}
        return frozenset({TABLE, *near})

    def _size(self, block: str) -> BlockSize:
        return self._sizes.get(block, CUBE)

    def _gap(self, a: str, b: str, poses: Mapping[str, PlanarPose]) -> float:
        """Between two blocks on the table [m]: from the corners of one to the sides of the other."""
        return min(self._reach(a, b, poses), self._reach(b, a, poses))

    def _reach(self, a: str, b: str, poses: Mapping[str, PlanarPose]) -> float:
        at, to = poses[a], poses[b]
        half_a, half_b = (0.5 * np.array(self._size(block)[:2]) for block in (a, b))
        corners = at.p + (half_a * CORNERS) @ _turn(at.yaw).T
        beyond = np.maximum(np.abs((corners - to.p) @ _turn(to.yaw)) - half_b, 0.0)
        return float(np.linalg.norm(beyond, axis=1).min())


def _turn(yaw: float) -> Array:
    c, s = np.cos(yaw), np.sin(yaw)
    return np.array([[c, -s], [s, c]])


TOUCH_DISTANCE = 0.01
"""Length of the last segment above the table, which is slow where a block is put down [m]."""
CARRY_CLEARANCE = 0.015
"""Between a carried block and the tallest one, at least [m]."""


class Motions:
    """Makes the paths of the tool for each part of an action.

    Args:
        config: heights and speeds.
        sizes: of the blocks that are not cubes, by id.
        gripper: how deep it reaches, and how it pushes.
        view: joint positions at which the camera sees past the arm `(6,)` [rad].
        X_WL: where the tool is there; the wrist turns from its heading as little as it can.
    """

    def __init__(
        self, config: ExecutorConfig, sizes: BlockSizes, gripper: GripperFootprint, view: Array, X_WL: Pose
    ) -> None:
        self._config, self._sizes, self._gripper = config, sizes, gripper
        self._tallest = max((size.z for size in sizes.values()), default=CUBE.z)
        self._view, self._neutral = view, yaw_of(X_WL.q)

    def grasps(self, action: PickPlace) -> tuple[Pose, Pose]:
        """X_WT at which a block is gripped, and at which it is let go."""
        turn = float(wrapped(action.place_yaw - action.pick_yaw))
        pick = min(
            (action.pick_yaw, action.pick_yaw + np.pi),
            key=lambda yaw: max(abs(self._off(yaw)), abs(self._off(yaw) + turn)),
        )
        depth = self._depth(action.block)
        return (
            self._tool(action.start, pick, depth),
            self._tool(action.end, pick + turn, depth + self._config.release_height),
        )

    def pushes(self, action: Push) -> tuple[Pose, Pose]:
        """X_WT from which a block is pushed, and at which it has arrived."""
        sides = (action.direction + QUARTER, action.direction - QUARTER)
        across = min(sides, key=lambda heading: abs(self._off(heading)))
        _, along = self._size(action.block).across_and_along(action.start, action.direction)
        behind, depth = 0.5 * along + 0.5 * self._gripper.finger_width, self._depth(action.block)
        start = action.start.moved(-behind - self._gripper.push_standoff, action.direction)
        return (
            self._tool(start, across, depth),
            self._tool(action.end.moved(-behind, action.direction), across, depth),
        )

    def clear_view(self) -> Path:
        """The path to where the camera sees past the arm."""
        return Path((self._home(),))

    def approach(self, X_WT: Pose) -> Path:
        """Over the blocks, then down to a pose between them."""
        speed = self._config.speed
        over = PoseMove(
            self._raised(X_WT, self._config.hover), speed.travel, speed.travel_acceleration, label="approach"
        )
        return Path((over, Line(X_WT, speed.descend, entry_speed=speed.descend, label="down")))

    def retreat(self, X_WT: Pose) -> Path:
        """Up from a pose between blocks, and out of the camera's sight; from above them at once."""
        is_above = X_WT.p[2] >= self._config.hover
        return Path((self._home(),) if is_above else (self._up(X_WT), self._home()))

    def carry(self, X_WT: Pose, X_WG: Pose) -> Path:
        """Up with a block, across, and down to where it is let go."""
        # The block reaches as far below the tips as they are above the table where it stands.
        speed, depth = self._config.speed, float(min(X_WT.p[2], X_WG.p[2]))
        height = max(self._config.carry_height, self._tallest + depth + CARRY_CLEARANCE)
        acceleration = speed.carry_acceleration
        near = self._raised(X_WG, X_WG.p[2] + TOUCH_DISTANCE)
        return Path((
            Line(self._raised(X_WT, height), speed.descend, acceleration, label="lift"),
            Line(self._raised(X_WG, height), speed.carry, acceleration, label="carry"),
            Line(near, speed.descend, acceleration, exit_speed=speed.touch, label="lower"),
            Line(X_WG, speed.touch, acceleration, label="touch"),
        ))  # fmt: skip

    def push(self, X_WG: Pose) -> Path:
        """The path from behind a block to the end of its push."""
        return Path((Line(X_WG, self._config.speed.push, label="push"),))

    def back_off(self, X_WT: Pose, X_WG: Pose) -> Path:
        """From the end of a push a little back, up, and out of the camera's sight."""
        along = X_WG.p - X_WT.p
        back = Pose(X_WG.p - self._config.back_off * along / np.linalg.norm(along), X_WG.q)
        return Path((Line(back, self._config.speed.push, label="back off"), self._up(back), self._home()))

    def _size(self, block: str) -> BlockSize:
        return self._sizes.get(block, CUBE)

    def _depth(self, block: str) -> float:
        """Height of the tips over the table where they grasp or push a block [m]."""
        return self._size(block).z - self._gripper.insertion

    def _home(self) -> JointMove:
        speed = self._config.speed
        return JointMove(self._view, speed.travel, speed.travel_acceleration, label="look")

    def _up(self, X_WT: Pose) -> Line:
        speed = self._config.speed.descend
        return Line(self._raised(X_WT, self._config.hover), speed, exit_speed=speed, label="up")

    def _off(self, heading: float) -> float:
        """Turn from the neutral heading [rad]."""
        return float(wrapped(heading - self._neutral))

    @staticmethod
    def _tool(at: PlanarPose, heading: float, height: float) -> Pose:
        return Pose(np.array([at.x, at.y, height]), multiply(from_yaw(heading), POINTING_DOWN))

    @staticmethod
    def _raised(X_WT: Pose, height: float) -> Pose:
        return Pose(np.array([X_WT.p[0], X_WT.p[1], height]), X_WT.q)
