"""Runs the machine's states as legs, one after the other, each with the obstacles that it may touch.

The alternatives of a leg are offered to the motion one by one until one is accepted. That one is followed
until the measured tool has reached its end (section 8.2).
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Sequence

import numpy as np

from pack_core.motion.moves import DEPART, DESCEND, RISE, TRANSIT
from pack_core.motion.target import MotionState, MotionStatus, MotionTarget, ReachTolerance
from pack_core.motion.world import CarriedBox, Obstacle
from pack_core.palletizing.cell import REORIENTATION_TABLE, PalletizingCell
from pack_core.palletizing.ports import PalletObservation, PursueTarget
from pack_core.rotations import Array, Pose, angle_between
from pack_core.tasks.move import MoveFollower
from pallet_fsm.blended_moves import BlendedMoves
from pallet_fsm.goals import Goals, Leg
from pallet_fsm.order_book import OrderBook, WorkItem
from pallet_fsm.palletizer_config import MoverConfig, PalletizerConfig
from pallet_fsm.states import ROWS, Check, Grip, Part, Place, Profile, State
from pallet_fsm.thesis_moves import ThesisMoves
from pallet_fsm.transitions import Event

TOLERANCES = {Check.PRECISE: ReachTolerance(0.002, 0.5, 1), Check.TRANSIT: ReachTolerance(0.005, 1.0, 3)}
"""The checkers of the thesis, section 8.2: distance [m], angle [deg], and for how many steps in a row."""


class TargetChecker:
    """Confirms that one target was reached.

    Orientations are compared by their angle: the norm of a unit error quaternion, which Eq. 5.5
    tests, is always one.

    Args:
        X_WT: target pose of the tool.
        check: which tolerance applies.
    """

    def __init__(self, X_WT: Pose, check: Check) -> None:
        self._X_WT, self._tolerance = X_WT, TOLERANCES[check]
        self._steps = 0

    def note(self, X_WT: Pose) -> bool:
        """Take a measured tool pose, and return whether the target is reached with it.

        The pose must be within the tolerance in a number of consecutive calls.
        """
        position = float(np.linalg.norm(X_WT.p - self._X_WT.p))
        angle = float(np.degrees(angle_between(X_WT.q, self._X_WT.q)))
        is_near = position <= self._tolerance.position and angle <= self._tolerance.orientation_deg
        self._steps = self._steps + 1 if is_near else 0
        return self._steps >= self._tolerance.steps


SPEED_WINDOW = 0.02
"""Least time between the two measurements that a speed is computed from [s]."""


class ToolSpeed:
    """Speed of the measured tool, over the last `SPEED_WINDOW` or since the last measurement before it.

    Attributes:
        value: the speed [m/s]; infinite before there are two measurements far enough apart in time.
    """

    def __init__(self) -> None:
        self._measured: deque[tuple[float, Array]] = deque()
        self.value = np.inf

    def note(self, time: float, p_WT: Array) -> None:
        """Take a measured position `(3,)` [m] at `time` [s]."""
        self._measured.append((time, p_WT))
        limit = time - SPEED_WINDOW + 1e-9
        while len(self._measured) > 1 and self._measured[1][0] <= limit:
            self._measured.popleft()
        first, p_first = self._measured[0]
        if first <= limit:
            self.value = float(np.linalg.norm(p_WT - p_first)) / (time - first)


class Mover:
    """Executes one leg at a time.

    Attributes:
        leg: the leg that is being executed; None between legs.
        reason: why the last leg failed; empty if it did not.
    """

    def __init__(self, profile: Profile, config: MoverConfig) -> None:
        self._profile, self._config = profile, config
        self._follower = MoveFollower(config.answer_time)
        self._rest: list[tuple[Leg, frozenset[str]]] = []
        self._refusals: list[str] = []
        self._ended = 0.0
        self._checker: TargetChecker | None = None
        self._speed = ToolSpeed()
        self._surroundings: tuple[CarriedBox | None, tuple[Obstacle, ...]] = (None, ())
        self.leg: Leg | None = None
        self.reason = ""

    def begin(
        self,
        legs: Sequence[tuple[Leg, frozenset[str]]],
        carried: CarriedBox | None,
        obstacles: tuple[Obstacle, ...],
        newest: MotionStatus,
        time: float,
    ) -> PursueTarget | Event:
        """Send the first of some alternative legs, each with the names of the obstacles it may touch.

        Args:
            legs: the alternatives, best first.
            carried: the box in the hand.
            obstacles: what must not be touched otherwise.
            newest: newest status of the motion, maybe of an earlier order.
            time: now [s].
        """
        self._rest, self._refusals, self.reason = list(legs), [], ""
        self._surroundings = carried, obstacles
        return self._offer(newest, time) or self._trouble(
            Event.NOT_CLEAR, "there is no way to hold the box so"
        )

    def follow(self, status: MotionStatus, state: State) -> Event | PursueTarget | None:
        """The event or the next target that the status leads to while the machine is in `state`."""
        move = None if self.leg is None else self._follower.stands(status, status.time)
        if self.leg is None or move is None:
            return None
        if move.state is MotionState.REFUSED:
            self._refusals.append(move.reason)
            return self._offer(status, status.time) or self._trouble(
                Event.NOT_CLEAR, "; ".join(self._refusals)
            )
        if move.state is MotionState.STUCK:
            return self._trouble(Event.MOTION_STUCK, move.reason)
        if state is self.leg.end:
            return self._arrive(move)
        return Event.REACHED if self._has_passed(move, state) else None

    def _offer(self, newest: MotionStatus, time: float) -> PursueTarget | None:
        if not self._rest:
            return None
        (self.leg, contacts), self._rest = self._rest[0], self._rest[1:]
        self._ended = float("inf")
        check = ROWS[self.leg.end].check or Check.TRANSIT
        self._checker, self._speed = TargetChecker(self.leg.X_WT, check), ToolSpeed()
        carried, obstacles = self._surroundings
        number = self._follower.begin(newest, time)
        return PursueTarget(
            MotionTarget(
                number,
                self.leg.move,
                carried,
                obstacles,
                contacts,
                TOLERANCES[check],
                is_checked=self.leg.is_checked,
            )
        )

    def _arrive(self, status: MotionStatus) -> Event | None:
        assert self._checker is not None
        is_there = self._checker.note(status.X_WT)
        self._speed.note(status.time, status.X_WT.p)
        if status.state is not MotionState.REACHED:
            return None
        self._ended = min(self._ended, status.time)
        if is_there and self._is_at_rest(status):
            self.leg = None
            return Event.REACHED
        if not is_there and status.time > self._ended + self._config.settling_time:
            error_mm = 1000.0 * status.position_error
            return self._trouble(Event.MOTION_STUCK, f"stopped {error_mm:.1f} mm from the target")
        return None

    def _is_at_rest(self, status: MotionStatus) -> bool:
        """Whether the arm is slow enough for the gripper, if that is to act, or has had its time for it."""
        assert self.leg is not None
        if ROWS[self.leg.end].grip not in (Grip.CLOSE, Grip.OPEN):
            return True
        is_slow = self._speed.value <= self._config.rest_speed
        return is_slow or status.time > self._ended + self._config.rest_time

    def _has_passed(self, status: MotionStatus, state: State) -> bool:
        if status.state is MotionState.HELD:
            return False
        if status.state is not MotionState.MOVING:
            return True
        running = PARTS.get(status.label, Part.NONE)
        return running > self._profile.parts.get(state, Part.NONE)

    def _trouble(self, event: Event, reason: str) -> Event:
        self.leg, self.reason = None, reason
        return event


PARTS = {
    DEPART: Part.DEPART,
    RISE: Part.CROSS,
    TRANSIT: Part.CROSS,
    DESCEND: Part.CROSS,
} | {part.name: part for part in Part}
"""The part of a blended move that each segment label of the motion stands for."""


class LegRunner:
    """Begins and follows the legs of the arm.

    Args:
        profile: how states become moves.
        book: the order's boxes.
        cell: the cell's physical facts.
        config: parameters.
        stop_after: gives the next state from a given one on at whose target the arm stops.

    Attributes:
        approach: approach direction of the tool at the end of the last leg, at table B; else None.
    """

    def __init__(
        self, profile: Profile, book: OrderBook, cell: PalletizingCell, config: PalletizerConfig,
        stop_after: Callable[[State], State],
    ) -> None:  # fmt: skip
        self._book, self._stop_after = book, stop_after
        self._leads_to_next = profile.is_blended  # the way back from the pallet is the one to the next box
        self._mover = Mover(profile, config.mover)
        goals = Goals(cell, config.poses)
        self._moves = (
            BlendedMoves(goals, config.blended, config.thesis)
            if profile.is_blended
            else ThesisMoves(goals, config.thesis)
        )
        self._touched: frozenset[str] = frozenset()
        self.approach: Array | None = None

    @property
    def reason(self) -> str:
        """Why the last leg failed; empty if it did not."""
        return self._mover.reason

    @property
    def end(self) -> State | None:
        """The state in which the present leg ends; None between legs."""
        return None if self._mover.leg is None else self._mover.leg.end

    def note_grip(self, state: State, item: WorkItem) -> None:
        """Note that the box was gripped at the state's target: it still touches what it stands on."""
        is_first = ROWS[state].place is Place.TABLE_A
        self._touched = frozenset({item.source if is_first else REORIENTATION_TABLE})

    def drop(self) -> None:
        """Give up the leg that runs; the next call of `follow` begins another one."""
        self._mover.leg = None

    def follow(self, state: State, item: WorkItem, seen: PalletObservation) -> Event | PursueTarget | None:
        """Begin a leg in `state` or follow the one that runs."""
        if self._mover.leg is None:
            return self._begin(state, item, seen)
        leg = self._mover.leg
        outcome = self._mover.follow(seen.motion, state)
        if outcome is Event.REACHED and self._mover.leg is None:
            self.approach = leg.approach
            self._touched = self._touched_at(leg.end, item)
        return outcome

    def _begin(self, state: State, item: WorkItem, seen: PalletObservation) -> Event | PursueTarget:
        target: WorkItem | None = item
        if self._leads_to_next and state in (State.RETREAT, State.RETURN):
            target = self._book.upcoming if item.is_finished else None
        legs = [
            (leg, self._touched | self._touched_at(leg.end, target))
            for leg in self._moves.legs(state, self._stop_after(state), target, seen.motion.X_WT)
        ]
        return self._mover.begin(legs, item.carried, self._book.obstacles(), seen.motion, seen.time)

    def _touched_at(self, end: State, item: WorkItem | None) -> frozenset[str]:
        """Names of the obstacles that the pad or its box touches, or nearly touches, where a leg ends."""
        row = ROWS[end]
        if item is None or row.place is None:
            return frozenset()
        if row.grip is Grip.CLOSE:  # the empty pad comes down on the box and touches nothing else
            return frozenset({item.name})
        return frozenset({item.name}) | self._standing_on(row.place, item)

    def _standing_on(self, place: Place, item: WorkItem) -> frozenset[str]:
        """Names of the obstacles that a box touches, or nearly touches, where it is put down."""
        if place is Place.PALLET:
            return self._book.beside(item)
        return frozenset({item.source if place is Place.TABLE_A else REORIENTATION_TABLE})
