"""What is done with one object: picked up, set down, let go, or put aside."""

from __future__ import annotations

import numpy as np

from pack_core.packing.cell import PackingCell
from pack_core.packing.free_space import base_height, is_packed
from pack_core.packing.scene import Scene
from pack_core.rotations import Array, Pose, conjugate, from_yaw, multiply, rotate, yaw_of
from pack_core.tasks.steps import Steps
from pack_mpc.filling.cup_moves import CupMoves
from pack_mpc.filling.fill_config import FillConfig
from pack_mpc.filling.requests import UsePump
from pack_mpc.task.stages import UP


class ObjectHandling:
    """Handles the object that was handed over last.

    Args:
        moves: of the cup; their scene has the object as its new one.
        cell: the cell's physical facts.
        config: speeds, heights and forces.
    """

    def __init__(self, moves: CupMoves, cell: PackingCell, config: FillConfig) -> None:
        self._moves, self._cell, self._config = moves, cell, config
        self._port = moves.port

    @property
    def _scene(self) -> Scene:
        """The cell as described last."""
        return self._moves.scene

    def pick(self) -> Steps[str]:
        """Grip the object that was handed over, and lift it a little; returns why it failed, if it did."""
        item, config = self._scene.new_object, self._config
        found = yield from self._search(config.first_sight_time)
        if not found:  # the arm may be what hides it
            yield from self._moves.go_over(item, self._cell.hand_over.pose_of(item))
            found = yield from self._search(config.sight_time)
        if not found:
            return f"no camera has seen '{item.name}' at the hand-over place"
        yield from self._moves.go_over(item, self._X_WO)
        for _ in range(config.grip_tries):
            if not self._moves.is_over(self._X_WO):
                yield from self._moves.go_over(item, self._X_WO)
            refusal = yield from self._touch()
            if not refusal:
                break
            yield from self._moves.rise(config.approach)
        else:
            return f"could not be gripped: {refusal}"
        yield from self._moves.rise(config.lift, speed=config.carry_speed)
        return "" if self._is_gripped else "slipped off the cup when it was lifted"

    def _search(self, longest: float) -> Steps[bool]:
        """Wait at most `longest` [s] until the cameras have seen the object; returns whether they have."""
        name = self._scene.new_object.name
        return (yield from self._port.wait(lambda: name in self._port.seen.scene.objects, longest))

    def _touch(self) -> Steps[str]:
        """Come down until the cup touches the object, then close the pump and wait for the vacuum."""
        config = self._config
        touches = self._moves.contact()
        yield from self._moves.down(config.approach + config.overshoot, touches)
        refusal = yield from self._port.ask(UsePump(close=True), str)
        if not refusal:
            found = yield from self._port.wait(lambda: self._is_gripped, config.sight_time)
            refusal = "" if found else "no vacuum was seen"
        return refusal

    def set_down(self, goal: Pose | None) -> Steps[str]:
        """Bring the packed object the last millimetres to its place and down to the base.

        Returns:
            Why it must not be let go there; empty if it stands or leans safely.
        """
        config = self._config
        yield from self._port.wait(lambda: False, config.calm_time)
        aside = np.zeros(3)
        if goal is not None:
            aside[:2] = goal.p[:2] - self._X_WO.p[:2]
            aside *= min(1.0, config.shift / max(float(np.linalg.norm(aside)), 1e-9))
        resists = self._moves.contact(config.press_force)
        way = aside - np.array([0.0, 0.0, max(self._height, 0.0) + config.settle])
        goal_xy = self._X_WO.p[:2] + aside[:2]

        def stands() -> bool:
            missing = float(np.linalg.norm(goal_xy - self._X_WO.p[:2]))
            return missing < config.standing and self._height < config.standing

        yield from self._moves.move(
            [way], self._moves.gentle(config.set_down_speed), until=lambda: resists() or stands()
        )
        X_WN = self._X_WO
        tilt = float(np.rad2deg(np.arccos(np.clip(rotate(X_WN.q, UP)[2], -1.0, 1.0))))
        if not is_packed(self._scene, X_WN):
            return "it is not between the walls"
        if self._height > config.release_height:
            return f"its lower end is {1e3 * self._height:.0f} mm over the base"
        if tilt > config.release_tilt_deg:
            return f"it is tilted by {tilt:.0f} degrees"
        return ""

    def release(self) -> Steps[str]:
        """Open the pump, draw back without dragging, and see where the object rests.

        Returns:
            What was not as it should be, in words; while the pump holds the object, why it does.
        """
        item, config = self._scene.new_object, self._config
        if refusal := (yield from self._let_go()):
            return refusal
        drags = self._moves.contact(config.retreat_force)
        dragged = False

        def note() -> bool:
            nonlocal dragged
            dragged |= drags()
            return False

        yield from self._moves.rise(config.clearance, note, speed=config.carry_speed)
        state = self._port.state_of(item.name)
        is_still = float(np.linalg.norm(state.v_WO_W)) < config.rest_speed
        if not is_packed(self._scene, state.X_WO):
            return "it is not in the container"
        noted = ["" if is_still else "it was still moving", "the cup dragged" if dragged else ""]
        return ", ".join(filter(None, noted))

    def take_out(self) -> Steps[None]:
        """Raise the held object straight up until it is over everything, tilted as it is and if upright.

        Where the way up leads out of the arm's reach, the object is first drawn up and to the arm's base,
        upright, as a tilted cup takes away from the reach.
        """
        config = self._config
        for _ in range(config.draws):
            if self._moves.reaches(self._depth):
                break
            # Not level: the stretched arm, which stands at the origin, can hardly begin to move along itself.
            inward = -self._moves.cup.p[:2] / np.linalg.norm(self._moves.cup.p[:2])
            way = config.draw * np.array([*inward, 1.0])
            resists = self._moves.contact(config.press_force)
            yield from self._moves.move(
                [way], self._moves.gentle(config.draw_speed), self._upright()[0], until=resists
            )
        yield from self._moves.rise(self._depth, speed=config.carry_speed)

    @property
    def _depth(self) -> float:
        """How far the held object has to rise until it is over everything, also once it is upright [m]."""
        lowest = min(self._height, base_height(self._scene.new_object, self._upright()[1]))
        return max(self._scene.rim + self._config.clearance - lowest, 0.0)

    def put_aside(self) -> Steps[str]:
        """Carry the held object back to the hand-over place, upright, and let it go there.

        Returns:
            Why it is still held, if the arm could not bring it there; it is let go nowhere else.
        """
        item, config = self._scene.new_object, self._config
        yield from self.take_out()
        # tilted as it may have been between others, the arm could not reach the place
        q_WT, X_WN = self._upright()
        across = np.array([*(self._cell.hand_over.pose_of(item).p - X_WN.p)[:2], 0.0])
        yield from self._moves.move([across], self._moves.pace(config.carry_speed), q_WT)
        down = np.array([0.0, 0.0, -max(self._height - config.approach, 0.0)])
        yield from self._moves.move([down], self._moves.pace(config.carry_speed))
        touches = self._moves.contact()
        yield from self._moves.down(
            config.approach + config.overshoot, lambda: touches() or self._height < config.standing
        )
        if reason := self._missed():
            return reason
        if refusal := (yield from self._let_go()):
            return refusal
        yield from self._moves.rise(config.clearance)
        return ""

    def _let_go(self) -> Steps[str]:
        """Open the pump; returns why it still holds the object, if it does."""
        refusal = yield from self._port.ask(UsePump(close=False), str)
        if not refusal:
            found = yield from self._port.wait(lambda: not self._is_gripped, self._config.sight_time)
            refusal = "" if found else "the vacuum stayed"
        return f"the pump does not let go: {refusal}" if refusal else ""

    def _missed(self) -> str:
        """How far the held object is from where it may be put aside; empty if it is there."""
        item, config = self._scene.new_object, self._config
        centre = self._cell.hand_over.pose_of(item).p
        aside = float(np.linalg.norm((self._X_WO.p - centre)[:2]))
        if aside > config.aside_reach:
            return f"the arm could not carry it on, {1e3 * aside:.0f} mm from the hand-over place"
        height = self._height
        if height > config.release_height:
            return f"at the hand-over place its lower end stays {1e3 * height:.0f} mm over the table"
        return ""

    def _upright(self) -> tuple[Array, Pose]:
        """The cup's orientation q_WT at which the held object is upright, and where that is, X_WN.

        The cup stays where it is, and the object keeps its heading.
        """
        X_WN, X_WT = self._X_WO, self._moves.cup
        q_WT = multiply(multiply(from_yaw(yaw_of(X_WN.q)), conjugate(X_WN.q)), X_WT.q)
        return q_WT, Pose(X_WT.p, q_WT) @ X_WT.inverse() @ X_WN

    @property
    def _X_WO(self) -> Pose:
        """Where the object is seen."""
        return self._port.pose_of(self._scene.new_object.name)

    @property
    def _height(self) -> float:
        """Height of the object's lowest point over the table [m]."""
        return base_height(self._scene.new_object, self._X_WO)

    @property
    def _is_gripped(self) -> bool:
        return self._port.seen.is_gripped
