"""Moves of the profile `blended`: from one stop of the arm to the next, through the states between them."""

from __future__ import annotations

import numpy as np

from pack_core.motion.moves import UP, Line, Mode, Path, PoseMove, Retreat, Transfer
from pack_core.rotations import Array, Pose
from pallet_fsm.goals import Goals, Leg, raised
from pallet_fsm.order_book import WorkItem
from pallet_fsm.palletizer_config import BlendedConfig, Range, ThesisConfig
from pallet_fsm.states import Part, State
from pallet_fsm.targets import Situation, targets_of


class BlendedMoves:
    """Makes moves that are transfers: the motion searches the lengths of their first and last line.

    Args:
        goals: finds tool poses over boxes and places.
        config: speeds and distances.
        way_points: way-points for the states that have no move of their own here.
    """

    def __init__(self, goals: Goals, config: BlendedConfig, way_points: ThesisConfig) -> None:
        self._goals, self._config, self._way_points = goals, config, way_points

    def legs(self, state: State, stop: State, item: WorkItem | None, X_WT: Pose) -> list[Leg]:
        """The ways on from where the arm has stopped, best first.

        Args:
            state: the first state that the move goes through.
            stop: the state at whose target it ends.
            item: the box that the move is for; None: it goes to the safe position.
            X_WT: the present pose of the tool.
        """
        if state in (State.RETREAT, State.RETURN):  # straight to the next box, if it was found already
            home = self._home(X_WT)
            if item is None or item.X_WB is None:
                return home
            return self._to_grasp(state, State.GRASP, item, X_WT) + home
        assert item is not None
        match stop:
            case State.GRASP | State.REGRASP:
                return self._to_grasp(state, stop, item, X_WT)
            case State.RELEASE_TABLE:
                return self._to_table(item, X_WT)
            case State.DEPOSIT:
                return self._to_place(item, X_WT)
        return self._to_target(stop, item, X_WT)

    def _to_target(self, stop: State, item: WorkItem, X_WT: Pose) -> list[Leg]:
        """A transfer to a state's own target: for stops that need no lines of a shape of their own."""
        now = Situation(self._goals, self._way_points, item, X_WT)
        return [
            Leg(
                Transfer(
                    (self._line(target.X_WT, Part.FINAL, self._config.speed),), self._hover(), self._lift()
                ),
                target.X_WT, stop, target.approach,
            )
            for target in targets_of(stop, now)
        ]  # fmt: skip

    def _to_grasp(self, state: State, end: State, item: WorkItem, X_WT: Pose) -> list[Leg]:
        legs = []
        for depart in self._departs(state, item):
            for goal in self._goals.grasps(item, X_WT):
                line = self._line(goal, Part.FINAL, self._config.speed)
                legs.append(Leg(Transfer((line,), self._hover(), depart), goal, end))
        return legs

    def _departs(self, state: State, item: WorkItem) -> list[Retreat | None]:
        """The first lines that are tried: from a box on table B straight back or obliquely up, else up.

        The oblique ones are for places where the arm cannot fold far enough to go straight back. Up from the
        pallet is along its own vertical.
        """
        if state is State.STEP_BACK and item.approach is not None:
            length = self._config.step_back
            return [self._retreat(rise * UP - item.approach, length) for rise in (0.0, 0.5, 1.0)]
        if state is State.ABOVE_BOX:
            return [None]
        up = self._goals.in_world(UP) if state in (State.RETREAT, State.RETURN) else UP
        return [self._retreat(up, self._config.lift)]

    def _to_table(self, item: WorkItem, X_WT: Pose) -> list[Leg]:
        config, above = self._config, self._config.final_height * UP
        is_heavy = item.box.weight * item.box.turn.extents[2] > config.heavy
        share = config.gentle if is_heavy else 1.0
        return [
            Leg(
                Transfer(self._lines(stand.X_WT, above), self._hover(), self._lift(), acceleration=share),
                stand.X_WT, State.RELEASE_TABLE, stand.approach,
            )
            for stand in self._goals.stands(item, X_WT)
        ]  # fmt: skip

    def _to_place(self, item: WorkItem, X_WT: Pose) -> list[Leg]:
        """Along the planned insertion; where that is not clear, straight down onto the pallet."""
        config, insertion = self._config, item.plan.insertion
        hover = self._retreat(self._goals.in_world(UP, item.deck), config.hover)
        offsets = [insertion.offset(config.standoff, config.final_height), config.final_height * UP]
        return [
            Leg(Transfer(lines, hover, self._lift()), goal, State.DEPOSIT)
            for offset in offsets[: 2 if insertion.corridor > 0.0 else 1]
            for goal in self._goals.placements(item, X_WT)
            for lines in [self._lines(goal, self._goals.in_world(offset, item.deck))]
        ]

    def _home(self, X_WT: Pose) -> list[Leg]:
        """Up along the pallet's own vertical, then to the safe position; the lengths are searched if need be.

        Over the corner of the pallet that is farthest from its base the arm cannot reach the safe height.
        """
        safe, up = np.array(self._config.safe), self._goals.in_world(UP)
        goal = Pose(safe, X_WT.q)
        cross = PoseMove(goal, label=Part.CROSS.name)
        if X_WT.p[2] >= safe[2] - self._config.lift[0]:
            return [Leg(Path((cross,)), goal, State.RETURN)]
        config = self._config
        slow = Line(
            raised(X_WT, config.slow_length * up), min(config.speed, config.slow_speed), config.acceleration,
            exit_speed=config.slow_speed, label=Part.DEPART.name,
        )  # fmt: skip
        over = raised(X_WT, (safe[2] - X_WT.p[2]) / up[2] * up)
        lift = Line(over, config.speed, config.acceleration, label=Part.CROSS.name, mode=Mode.FAST)
        last = self._line(goal, Part.FINAL, config.speed)
        searched = Transfer((last,), self._hover(), self._retreat(up, config.lift))
        return [
            Leg(Path((slow, lift, cross)), goal, State.RETURN),
            Leg(searched, goal, State.RETURN),
        ]

    def _lines(self, goal: Pose, offset: Array) -> tuple[Line, Line]:
        """The line to a point offset from the goal, and the last line to the goal itself."""
        config = self._config
        return (
            Line(
                raised(goal, offset), config.speed, config.acceleration, exit_speed=config.final_speed,
                blend=config.corner, label=Part.APPROACH.name,
            ),
            self._line(goal, Part.FINAL, config.final_speed),
        )  # fmt: skip

    def _line(self, goal: Pose, part: Part, speed: float) -> Line:
        return Line(goal, speed, self._config.acceleration, label=part.name)

    def _lift(self) -> Retreat:
        return self._retreat(UP, self._config.lift)

    def _hover(self) -> Retreat:
        return self._retreat(UP, self._config.hover)

    def _retreat(self, direction: Array, lengths: Range) -> Retreat:
        config = self._config
        return Retreat(
            direction, lengths, config.speed, config.acceleration, config.pass_speed,
            config.slow_length, config.slow_speed,
        )  # fmt: skip
