"""The skills of arm, gripper and camera: look, pick and place, push, each a sequence of requests.

Every method is a part of the executor's conversation: it yields requests and is sent their answers. Each move
is requested together with the obstacles that it is checked against.
"""

from __future__ import annotations

from collections.abc import Generator
from typing import Any

from block_fsm.deviation import Poses
from block_fsm.executor_config import ExecutorConfig
from block_fsm.motions import Motions, TableObstacles
from block_fsm.outcome import Blocked, Ended, ExitReason, Phase, Refused
from block_fsm.requests import ExecutorRequest, Look, MoveArm, MoveFingers, NoPicture
from block_fsm.task import RearrangeTask
from pack_core.blocks.block_sighting import BlockSighting
from pack_core.blocks.gripper import FingerCommand, FingerState, FingerStatus
from pack_core.blocks.plan import Action, PickPlace, Push
from pack_core.blocks.planar import PlanarPose
from pack_core.blocks.primitive_action import PrimitiveAction, primitives_of
from pack_core.motion.moves import Path
from pack_core.motion.target import MotionState, MotionStatus
from pack_core.motion.world import CarriedBox
from pack_core.rotations import Pose

Asking = Generator[ExecutorRequest, Any, None]


class Skills:
    """Looks at the table and carries out single actions.

    Args:
        task: sizes of blocks and gripper.
        config: patience.
        motions: makes the arm's paths.
        obstacles: makes what they are checked against.
        force: that blocks are held with [N].

    Attributes:
        phase: what is being done.
        seen: where the blocks are, as last seen, or as they were left since.
        failed_grasps: that held nothing, lost it, or held something of another width.
    """

    def __init__(
        self,
        task: RearrangeTask,
        config: ExecutorConfig,
        motions: Motions,
        obstacles: TableObstacles,
        force: float,
    ) -> None:
        self._config, self._motions, self._obstacles = config, motions, obstacles
        self._gripper, self._task, self._force = task.gripper, task, force
        self._opening, self._failed_in_a_row = task.gripper.max_opening, 0
        self.phase = Phase.IDLE
        self.seen: Poses = {}
        self.failed_grasps = 0

    def clear_view(self) -> Asking:
        """Go where the camera sees past the arm."""
        yield from self._move(self._motions.clear_view())

    def look(self) -> Asking:
        """Have a picture taken in which all blocks are seen.

        Raises:
            Ended: there was none.
        """
        self.phase, reason = Phase.PERCEIVE, ""
        for _ in range(self._config.looks):
            sighting: BlockSighting | NoPicture = yield Look()
            if isinstance(sighting, NoPicture):
                reason = sighting.reason
                continue
            self.seen, reason = sighting.poses, sighting.lacks
            if sighting.is_complete:
                return
        raise Ended(ExitReason.NOT_SEEN, reason)

    def carry_out(self, action: Action) -> Asking:
        """Do what an action says; the arm is out of sight afterwards.

        Raises:
            Refused: a move is not possible; the block stands where it stood, and is not held.
            Ended: a move failed, or too many grasps did.
        """
        yield from self._pick_and_place(action) if isinstance(action, PickPlace) else self._push(action)

    def _pick_and_place(self, action: PickPlace) -> Asking:
        grip, release = self._motions.grasps(action)
        grasp, place = primitives_of(action)
        self.phase, width = Phase.PICK, self._task.size(action.block)[action.grasp]
        wide = self._gripper.grasp_opening(width)
        yield from self._fingers(wide)
        try:
            yield from self._move(self._motions.approach(grip), primitive=grasp)
        except Blocked as blocked:
            yield from self._withdraw_from(blocked)
            return
        if held_instead := (yield from self._hold(action.block, width)):
            yield from self._let_go(grip, wide, action.block, action.start)
            self._note_grasp(held_instead)
            return
        self.phase = Phase.PLACE
        carried = self._obstacles.carried(grip, action.block, action.start)
        try:
            yield from self._move(self._motions.carry(grip, release), action.block, carried, primitive=place)
        except Refused:
            yield from self._let_go(grip, wide, action.block, action.start)
            raise
        except Blocked as blocked:
            yield from self._move(self._motions.carry(blocked.X_WT, grip), action.block, carried)
            yield from self._let_go(grip, wide, action.block, action.start)
            self._note_failure(ExitReason.MOTION_FAILED, str(blocked))
            return
        held_instead = yield from self._hold(action.block, width)
        yield from self._let_go(release, wide, action.block, action.end)
        self._note_grasp(held_instead)

    def _let_go(self, X_WT: Pose, opening: float, block: str, pose: PlanarPose) -> Asking:
        self.phase = Phase.RETREAT
        yield from self._fingers(opening)
        self.seen = {**self.seen, block: pose}
        yield from self._move(self._motions.retreat(X_WT), touched=block)

    def _push(self, action: Push) -> Asking:
        start, end = self._motions.pushes(action)
        (push,) = primitives_of(action)
        self.phase = Phase.PUSH
        yield from self._fingers(self._gripper.push_gap)
        is_behind, carried = False, self._obstacles.carried(end, action.block, action.end)
        try:
            yield from self._move(self._motions.approach(start), primitive=push)
            is_behind = True
            yield from self._move(self._motions.push(end), action.block, carried, primitive=push)
        except Blocked as blocked:
            yield from self._withdraw_from(blocked)
            return
        except Refused:
            if is_behind:  # a refused approach has moved nothing
                self.phase = Phase.RETREAT
                yield from self._move(self._motions.retreat(start))
            raise
        self._failed_in_a_row, self.phase = 0, Phase.RETREAT
        self.seen = {**self.seen, action.block: action.end}
        yield from self._move(self._motions.back_off(start, end), touched=action.block)

    def _withdraw_from(self, blocked: Blocked) -> Asking:
        """Go up from where something blocks the arm, with nothing in the fingers, and count it."""
        self.phase = Phase.RETREAT
        yield from self._move(self._motions.retreat(blocked.X_WT))
        self._note_failure(ExitReason.MOTION_FAILED, str(blocked))

    def _note_failure(self, reason: ExitReason, message: str) -> None:
        """Count an action that failed; raises Ended where too many did in a row."""
        self._failed_in_a_row += 1
        if self._failed_in_a_row >= self._config.grasps:
            raise Ended(reason, message)

    def _hold(self, block: str, width: float) -> Generator[ExecutorRequest, Any, str]:
        """Close the fingers on a block of a width [m]; in words what they hold instead, if they do."""
        state = yield from self._fingers(width - self._config.grasp_squeeze)
        if state.status is not FingerStatus.HOLDING:
            return f"held nothing where block '{block}' was seen"
        if abs(state.opening - width) <= self._config.width_tolerance:
            return ""
        return (
            f"held something {1e3 * state.opening:.1f} mm wide where block '{block}', which is "
            f"{1e3 * width:.1f} mm wide, was seen: another block with its tag, or one that lies askew"
        )

    def _note_grasp(self, held_instead: str) -> None:
        """Count a grasp that failed, once the fingers have let go; raises Ended if too many did in a row."""
        if not held_instead:
            self._failed_in_a_row = 0
            return
        self.failed_grasps += 1
        many = f"{self._config.grasps} grasps in a row failed"
        self._note_failure(ExitReason.NO_PROGRESS, f"{many}; the last one {held_instead}")

    def _move(
        self, path: Path, moved: str = "", carried: CarriedBox | None = None, *, touched: str = "",
        primitive: PrimitiveAction | None = None,
    ) -> Asking:  # fmt: skip
        """Along a path; `moved` goes with the fingers, `touched` is what they have just left.

        Raises:
            Refused: the move is not possible, and was for a `primitive` that can be done without.
            Blocked: the arm got stuck in a move for a `primitive`.
            Ended: it failed.
        """
        obstacles = self._obstacles.among(self.seen, without=moved)
        contacts = frozenset({touched}) if touched else frozenset()
        if carried is not None:
            contacts = self._obstacles.beside(moved, self.seen)
        status: MotionStatus = yield MoveArm(path, self._opening, obstacles, carried, contacts)
        if status.state is MotionState.REFUSED and primitive is not None:
            raise Refused(primitive, status.reason)
        if status.state is not MotionState.REACHED:
            where = "" if status.state is MotionState.REFUSED else f" in '{status.label}'"
            text = f"{status.state.value}{where}: {status.reason}"
            if status.state is MotionState.STUCK and primitive is not None:
                raise Blocked(status.X_WT, text)
            raise Ended(ExitReason.MOTION_FAILED, text)

    def _fingers(self, opening: float) -> Generator[ExecutorRequest, Any, FingerState]:
        state: FingerState = yield MoveFingers(FingerCommand(opening, self._force))
        self._opening = state.opening
        return state
