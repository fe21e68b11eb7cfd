"""What is done with one object: picked up, set down, let go, or put aside."""

from __future__ import annotations

import numpy as np

from pack_core.packing.cell import PackingCell
from pack_core.packing.free_space import base_height, is_packed
from pack_core.packing.scene_item import SceneItem
from pack_core.rotations import Array, Pose, conjugate, from_yaw, multiply, rotate, yaw_of
from pack_mpc.filling.cup_moves import CupMoves
from pack_mpc.filling.fill_config import FillConfig
from pack_mpc.filling.requests import UsePump
from pack_mpc.filling.steps import FillObservation, Steps, ask, wait
from pack_mpc.filling.tool_motion import legs
from pack_mpc.task.stages import UP


class ObjectHandling:
    """Handles the object that was handed over last.

    Args:
        moves: of the cup; their scene has the object as its new one.
        cell: the cell's physical facts.
        config: speeds, heights and forces.
    """

    def __init__(self, moves: CupMoves, cell: PackingCell, config: FillConfig) -> None:
        self._moves, self._cell, self._config, self._scene = moves, cell, config, moves.scene

    def pick(self, seen: FillObservation) -> Steps[tuple[str, FillObservation]]:
        """Grip the object that was handed over, and lift it a little; returns why it failed, if it did."""
        item, config = self._scene.new_object, self._config
        found, seen = yield from self._look_for(seen, config.first_sight_time)
        if not found:  # the arm may be what hides it
            seen = yield from self._moves.go_over(seen, item, self._cell.hand_over.pose_of(item))
            found, seen = yield from self._look_for(seen, config.sight_time)
        if not found:
            return f"no camera has seen '{item.name}' at the hand-over place", seen
        seen = yield from self._moves.go_over(seen, item, seen.scene.objects[item.name].X_WO)
        for _ in range(config.grip_tries):
            X_WN = seen.scene.objects[item.name].X_WO
            if not self._moves.is_over(seen, X_WN):
                seen = yield from self._moves.go_over(seen, item, X_WN)
            refusal, seen = yield from self._touch(seen)
            if not refusal:
                break
            seen = yield from self._moves.rise(seen, config.approach)
        else:
            return f"could not be gripped: {refusal}", seen
        seen = yield from self._moves.rise(seen, config.lift, speed=config.carry_speed)
        return "" if seen.is_gripped else "slipped off the cup when it was lifted", seen

    def _look_for(self, seen: FillObservation, longest: float) -> Steps[tuple[bool, FillObservation]]:
        """Wait at most `longest` [s] until the cameras have seen the object; returns whether they have."""
        name = self._scene.new_object.name
        return (yield from wait(seen, lambda s: name in s.scene.objects, longest))

    def _touch(self, seen: FillObservation) -> Steps[tuple[str, FillObservation]]:
        """Come down until the cup touches the object, then close the pump and wait for the vacuum."""
        config = self._config
        touches = self._moves.contact(seen)
        seen = yield from self._moves.down(seen, config.approach + config.overshoot, touches)
        refusal, seen = yield from ask(seen, UsePump(close=True), str)
        if not refusal:
            found, seen = yield from wait(seen, lambda s: s.is_gripped, config.sight_time)
            refusal = "" if found else "no vacuum was seen"
        return refusal, seen

    def set_down(self, seen: FillObservation, goal: Pose | None) -> Steps[tuple[str, FillObservation]]:
        """Bring the packed object the last millimetres to its place and down to the base.

        Returns:
            Why it must not be let go there; empty if it stands or leans safely.
        """
        item, config = self._scene.new_object, self._config
        _, seen = yield from wait(seen, _never, config.calm_time)
        aside = np.zeros(3)
        if goal is not None:
            aside[:2] = goal.p[:2] - seen.scene.objects[item.name].X_WO.p[:2]
            aside *= min(1.0, config.shift / max(float(np.linalg.norm(aside)), 1e-9))
        resists = self._moves.contact(seen, config.press_force)
        way = aside - np.array([0.0, 0.0, max(_height(seen, item), 0.0) + config.settle])
        goal_xy = seen.scene.objects[item.name].X_WO.p[:2] + aside[:2]

        def stands(s: FillObservation) -> bool:
            missing = float(np.linalg.norm(goal_xy - s.scene.objects[item.name].X_WO.p[:2]))
            return missing < config.standing and _height(s, item) < config.standing

        seen = yield from self._moves.move(
            seen, legs([way], config.set_down_speed), until=lambda s: resists(s) or stands(s)
        )
        X_WN = seen.scene.objects[item.name].X_WO
        tilt = float(np.rad2deg(np.arccos(np.clip(rotate(X_WN.q, UP)[2], -1.0, 1.0))))
        if not is_packed(self._scene, X_WN):
            return "it is not between the walls", seen
        if _height(seen, item) > config.release_height:
            return f"its lower end is {1e3 * _height(seen, item):.0f} mm over the base", seen
        if tilt > config.release_tilt_deg:
            return f"it is tilted by {tilt:.0f} degrees", seen
        return "", seen

    def release(self, seen: FillObservation) -> Steps[tuple[str, FillObservation]]:
        """Open the pump, draw back without dragging, and see where the object rests."""
        item, config = self._scene.new_object, self._config
        _, seen = yield from ask(seen, UsePump(close=False), str)
        _, seen = yield from wait(seen, lambda s: not s.is_gripped, config.sight_time)
        drags = self._moves.contact(seen, config.retreat_force)
        dragged = False

        def note(s: FillObservation) -> bool:
            nonlocal dragged
            dragged |= drags(s)
            return False

        seen = yield from self._moves.rise(seen, config.clearance, note, speed=config.carry_speed)
        state = seen.scene.objects[item.name]
        is_still = float(np.linalg.norm(state.v_WO_W)) < config.rest_speed
        if not is_packed(self._scene, state.X_WO):
            return "it is not in the container", seen
        noted = ["" if is_still else "it was still moving", "the cup dragged" if dragged else ""]
        return ", ".join(filter(None, noted)), seen

    def take_out(self, seen: FillObservation) -> Steps[FillObservation]:
        """Raise the held object straight up until it is over everything, tilted as it is and if upright."""
        item = self._scene.new_object
        lowest = min(_height(seen, item), base_height(item, self._upright(seen)[1]))
        missing = self._scene.rim + self._config.clearance - lowest
        return (yield from self._moves.rise(seen, max(missing, 0.0), speed=self._config.carry_speed))

    def put_aside(self, seen: FillObservation) -> Steps[tuple[str, FillObservation]]:
        """Carry the held object back to the hand-over place, upright, and let it go there.

        Returns:
            Why it is still held, if the arm could not bring it there; it is let go nowhere else.
        """
        item, config = self._scene.new_object, self._config
        seen = yield from self.take_out(seen)
        # tilted as it may have been between others, the arm could not reach the place
        q_WT, X_WN = self._upright(seen)
        across = np.array([*(self._cell.hand_over.pose_of(item).p - X_WN.p)[:2], 0.0])
        seen = yield from self._moves.move(seen, legs([across], config.carry_speed), q_WT)
        down = np.array([0.0, 0.0, -max(_height(seen, item) - config.approach, 0.0)])
        seen = yield from self._moves.move(seen, legs([down], config.carry_speed))
        touches = self._moves.contact(seen)
        seen = yield from self._moves.down(
            seen, config.approach + config.overshoot,
            lambda s: touches(s) or _height(s, item) < config.standing,
        )  # fmt: skip
        if reason := self._missed(seen):
            return reason, seen
        _, seen = yield from ask(seen, UsePump(close=False), str)
        _, seen = yield from wait(seen, lambda s: not s.is_gripped, config.sight_time)
        return "", (yield from self._moves.rise(seen, config.clearance))

    def _missed(self, seen: FillObservation) -> str:
        """How far the held object is from where it may be put aside; empty if it is there."""
        item, config = self._scene.new_object, self._config
        centre = self._cell.hand_over.pose_of(item).p
        aside = float(np.linalg.norm((seen.scene.objects[item.name].X_WO.p - centre)[:2]))
        if aside > config.aside_reach:
            return f"the arm could not carry it on, {1e3 * aside:.0f} mm from the hand-over place"
        height = _height(seen, item)
        if height > config.release_height:
            return f"at the hand-over place its lower end stays {1e3 * height:.0f} mm over the table"
        return ""

    def _upright(self, seen: FillObservation) -> tuple[Array, Pose]:
        """The cup's orientation q_WT at which the held object is upright, and where that is, X_WN.

        The cup stays where it is, and the object keeps its heading.
        """
        X_WN, X_WT = seen.scene.objects[self._scene.new_object.name].X_WO, self._moves.arm.cup(seen.joints.q)
        q_WT = multiply(multiply(from_yaw(yaw_of(X_WN.q)), conjugate(X_WN.q)), X_WT.q)
        return q_WT, Pose(X_WT.p, q_WT) @ X_WT.inverse() @ X_WN


def _never(_: FillObservation) -> bool:
    return False


def _height(seen: FillObservation, item: SceneItem) -> float:
    """Height of an object's lowest point over the table [m]."""
    return base_height(item, seen.scene.objects[item.name].X_WO)
