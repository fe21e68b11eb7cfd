"""Executes a leg: sends its alternatives to the motion one by one until one is accepted, then follows it."""

from __future__ import annotations

from collections.abc import Sequence

from pydantic import Field, NonNegativeFloat, PositiveFloat

from pack_core.config import Config
from pack_core.motion.target import MotionState, MotionStatus, MotionTarget
from pack_core.motion.world import CarriedBox, Obstacle
from pack_core.palletizing.ports import PursueTarget
from pallet_fsm.checkers import TOLERANCES, TargetChecker, ToolSpeed
from pallet_fsm.goals import Leg
from pallet_fsm.profile import Profile
from pallet_fsm.states import ROWS, Check, Grip, Part, State
from pallet_fsm.transitions import Event


class MoverConfig(Config):
    """How long the machine waits for the motion, and until when before the gripper acts."""

    answer_time: PositiveFloat = Field(
        default=10.0, description="longest time until the motion accepts or refuses a target [s]"
    )
    settling_time: PositiveFloat = Field(
        default=2.0, description="longest time from the end of a motion until its target is confirmed [s]"
    )
    rest_speed: PositiveFloat = Field(
        default=0.003,
        description="the gripper acts once the tool is slower: a box in it is pressed by an arm that still "
        "moves against what the box stands on [m/s]",
    )
    rest_time: NonNegativeFloat = Field(
        default=0.5, description="longest time that the gripper waits for that [s]"
    )


class Mover:
    """Executes one leg at a time.

    Attributes:
        leg: the leg that is being executed; None between legs.
        reason: why the last leg failed; empty if it did not.
    """

    def __init__(self, profile: Profile, config: MoverConfig) -> None:
        self._profile, self._config = profile, config
        self._id = 0
        self._rest: list[tuple[Leg, frozenset[str]]] = []
        self._refusals: list[str] = []
        self._sent, self._ended = 0.0, 0.0
        self._is_accepted = False
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
        time: float,
    ) -> PursueTarget | Event:
        """Send the first of some alternative legs, each with the names of the obstacles it may touch."""
        self._rest, self._refusals, self.reason = list(legs), [], ""
        self._surroundings = carried, obstacles
        return self._offer(time) or self._trouble(Event.NOT_CLEAR, "there is no way to hold the box so")

    def follow(self, status: MotionStatus, state: State) -> Event | PursueTarget | None:
        """The event or the next target that the status leads to while the machine is in `state`."""
        if self.leg is None or status.id != self._id:
            return self._wait(status.time)
        # Refused after it was accepted: the rest of the move was planned anew after an interruption.
        if status.state is MotionState.REFUSED and self._is_accepted:
            return self._trouble(Event.MOTION_STUCK, f"interrupted, and no way on: {status.reason}")
        if status.state is MotionState.REFUSED:
            self._refusals.append(status.reason)
            return self._offer(status.time) or self._trouble(Event.NOT_CLEAR, "; ".join(self._refusals))
        if status.state is MotionState.STUCK:
            return self._trouble(Event.MOTION_STUCK, status.reason)
        self._is_accepted = True
        if state is self.leg.end:
            return self._arrive(status)
        return Event.REACHED if self._has_passed(status, state) else None

    def _offer(self, time: float) -> PursueTarget | None:
        if not self._rest:
            return None
        (self.leg, contacts), self._rest = self._rest[0], self._rest[1:]
        self._id, self._sent, self._ended, self._is_accepted = self._id + 1, time, float("inf"), False
        check = ROWS[self.leg.end].check or Check.TRANSIT
        self._checker, self._speed = TargetChecker(self.leg.X_WT, check), ToolSpeed()
        carried, obstacles = self._surroundings
        return PursueTarget(
            MotionTarget(self._id, self.leg.move, carried, obstacles, contacts, TOLERANCES[check])
        )

    def _wait(self, time: float) -> Event | None:
        if self.leg is not None and time > self._sent + self._config.answer_time:
            return self._trouble(Event.MOTION_STUCK, "the motion does not answer")
        return None

    def _arrive(self, status: MotionStatus) -> Event | None:
        assert self._checker is not None
        is_there = self._checker.look(status.X_WT)
        self._speed.look(status.time, status.X_WT.p)
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
    "depart": Part.DEPART,
    "rise": Part.CROSS,
    "transit": Part.CROSS,
    "descend": Part.CROSS,
} | {part.name: part for part in Part}
"""The part of a blended move that each segment label of the motion stands for."""
