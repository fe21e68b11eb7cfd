"""The transitions of the machine as one table of states, events and next states (Algorithm 1).

Of the rows for a state and an event, the first whose guard holds is taken.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum

from pallet_fsm.states import BEFORE_REGRASP, CARRYING, HOLDING, MOVING, ROWS, State


class Event(Enum):
    """What can happen in a state."""

    SPAWNED = "box spawned"
    DETECTED = "box detected"
    REACHED = "target reached"
    GRIPPED = "gripper closed"
    RELEASED = "gripper open"
    ASSESSED = "assessed"
    SKIPPED = "box skipped"
    HALTED = "halted"
    NO_DETECTION = "no detection"
    WRONG_SIZE = "wrong size"
    BOX_CHANGED = "box changed"
    PLACE_CHANGED = "place changed"
    GRIP_FAILED = "grip failed"
    BOX_LOST = "box lost"
    WRONG_WEIGHT = "wrong weight"
    LIMIT_PASSED = "limit passed"
    MOTION_STUCK = "motion stuck"
    NOT_CLEAR = "move not clear"


Happening = tuple[Event, str]
"""An event, and its reason in words; empty where it needs none."""


class Guard(Enum):
    """A condition on which a row of the table may depend besides the event."""

    IS_UPRIGHT = "handling none"
    IS_FLIP = "handling flip"
    HAS_TRIES = "tries left"
    HAS_NO_TRIES = "no tries left"
    HAS_BOXES = "boxes left"
    IS_HOLDING = "box in hand"
    IS_FINISHED = "box placed or skipped"
    IS_ON_TABLE = "box on table B"
    IS_UNSEEN = "box to be looked for"
    IS_FROM_TABLE_A = "box from table A"
    HAS_OTHER_PLACE = "another place for it"


RESUME = None
"""As the next state of a row: go back to the state that the fault interrupted."""


@dataclass(frozen=True)
class Transition:
    """A row of the table; `guard` None means that the row always applies."""

    state: State
    event: Event
    next: State | None
    guard: Guard | None = None


# fmt: off
CYCLE = (
    Transition(State.SPAWN, Event.SPAWNED, State.DETECT),
    Transition(State.DETECT, Event.DETECTED, State.ABOVE_BOX),
    Transition(State.ABOVE_BOX, Event.REACHED, State.GRASP),
    Transition(State.GRASP, Event.GRIPPED, State.LIFT),
    Transition(State.LIFT, Event.REACHED, State.SAFE_PICK),
    Transition(State.SAFE_PICK, Event.REACHED, State.TRANSFER, Guard.IS_UPRIGHT),
    Transition(State.SAFE_PICK, Event.REACHED, State.SAFE_TABLE),
    Transition(State.SAFE_TABLE, Event.REACHED, State.LEAVE_TABLE, Guard.IS_FLIP),
    Transition(State.SAFE_TABLE, Event.REACHED, State.ROTATE),
    Transition(State.ROTATE, Event.REACHED, State.RELEASE_TABLE),
    Transition(State.RELEASE_TABLE, Event.RELEASED, State.STEP_BACK),
    Transition(State.STEP_BACK, Event.REACHED, State.RISE),
    Transition(State.RISE, Event.REACHED, State.ABOVE_TABLE),
    Transition(State.ABOVE_TABLE, Event.REACHED, State.REGRASP),
    Transition(State.REGRASP, Event.GRIPPED, State.LIFT_TABLE),
    Transition(State.LIFT_TABLE, Event.REACHED, State.LEAVE_TABLE),
    Transition(State.LEAVE_TABLE, Event.REACHED, State.TRANSFER),
    Transition(State.TRANSFER, Event.REACHED, State.ABOVE_PALLET),
    Transition(State.ABOVE_PALLET, Event.REACHED, State.PRE_DEPOSIT),
    Transition(State.PRE_DEPOSIT, Event.REACHED, State.DEPOSIT),
    Transition(State.DEPOSIT, Event.RELEASED, State.RETREAT),
    Transition(State.RETREAT, Event.REACHED, State.RETURN),
    Transition(State.RETURN, Event.REACHED, State.SPAWN, Guard.HAS_BOXES),
    Transition(State.RETURN, Event.REACHED, State.DONE),
)
# fmt: on

# fmt: off
SEEING = (
    Transition(State.DETECT, Event.NO_DETECTION, State.NO_DETECTION),
    Transition(State.DETECT, Event.WRONG_SIZE, State.WRONG_SIZE),
    Transition(State.NO_DETECTION, Event.ASSESSED, State.DETECT, Guard.HAS_TRIES),
    Transition(State.NO_DETECTION, Event.ASSESSED, State.SKIP_BOX),
    Transition(State.WRONG_SIZE, Event.ASSESSED, State.DETECT, Guard.HAS_TRIES),
    Transition(State.WRONG_SIZE, Event.ASSESSED, State.SKIP_BOX),
)
LOOKING_AGAIN = (
    Transition(State.ABOVE_BOX, Event.BOX_CHANGED, State.BOX_CHANGED),
    Transition(State.GRASP, Event.BOX_CHANGED, State.BOX_CHANGED),
    *(Transition(state, Event.BOX_CHANGED, State.BOX_CHANGED) for state in BEFORE_REGRASP),
    Transition(State.BOX_CHANGED, Event.ASSESSED, State.SKIP_BOX, Guard.HAS_NO_TRIES),
    Transition(State.BOX_CHANGED, Event.ASSESSED, State.SKIP_BOX, Guard.IS_ON_TABLE),
    Transition(State.BOX_CHANGED, Event.ASSESSED, State.RETREAT),
)
SCANNING = (
    *(Transition(row.state, Event.PLACE_CHANGED, State.PLACE_CHANGED) for row in ROWS.values()),
    Transition(State.PLACE_CHANGED, Event.ASSESSED, State.SAFE_STOP),
)
GRIPPING = (
    Transition(State.GRASP, Event.GRIP_FAILED, State.GRIP_FAILED),
    Transition(State.REGRASP, Event.GRIP_FAILED, State.GRIP_FAILED),
    Transition(State.GRIP_FAILED, Event.ASSESSED, State.SKIP_BOX, Guard.HAS_NO_TRIES),
    Transition(State.GRIP_FAILED, Event.ASSESSED, State.RISE, Guard.IS_ON_TABLE),
    Transition(State.GRIP_FAILED, Event.ASSESSED, State.RETREAT),
)
LOSING = (
    *(Transition(state, Event.BOX_LOST, State.BOX_LOST) for state in HOLDING),
    *(Transition(state, Event.LIMIT_PASSED, State.LIMIT_PASSED) for state in HOLDING),
    Transition(State.BOX_LOST, Event.ASSESSED, State.SAFE_STOP),
    Transition(State.LIMIT_PASSED, Event.ASSESSED, State.SAFE_STOP),
)
WEIGHING = (
    *(Transition(state, Event.WRONG_WEIGHT, State.WRONG_WEIGHT) for state in CARRYING),
    Transition(State.WRONG_WEIGHT, Event.ASSESSED, State.PUT_BACK, Guard.IS_FROM_TABLE_A),
    Transition(State.WRONG_WEIGHT, Event.ASSESSED, State.SAFE_STOP),
    Transition(State.PUT_BACK, Event.RELEASED, State.RETREAT, Guard.HAS_TRIES),
    Transition(State.PUT_BACK, Event.RELEASED, State.SKIP_BOX),
)
MOTION = (
    *(Transition(state, Event.MOTION_STUCK, State.MOTION_STUCK) for state in MOVING),
    *(Transition(state, Event.NOT_CLEAR, State.NOT_CLEAR) for state in MOVING),
    Transition(State.MOTION_STUCK, Event.ASSESSED, State.SAFE_STOP, Guard.HAS_NO_TRIES),
    Transition(State.MOTION_STUCK, Event.ASSESSED, State.RETREAT, Guard.IS_UNSEEN),
    Transition(State.MOTION_STUCK, Event.ASSESSED, RESUME),
    Transition(State.NOT_CLEAR, Event.ASSESSED, RESUME, Guard.HAS_OTHER_PLACE),
    Transition(State.NOT_CLEAR, Event.ASSESSED, State.SAFE_STOP, Guard.IS_HOLDING),
    Transition(State.NOT_CLEAR, Event.ASSESSED, State.SAFE_STOP, Guard.IS_FINISHED),
    Transition(State.NOT_CLEAR, Event.ASSESSED, State.SKIP_BOX),
)
# fmt: on
SKIPPING = (Transition(State.SKIP_BOX, Event.SKIPPED, State.RETREAT),)
HALTING = tuple(Transition(row.state, Event.HALTED, State.SAFE_STOP) for row in ROWS.values())

TRANSITIONS = (
    *CYCLE, *SEEING, *LOOKING_AGAIN, *SCANNING, *GRIPPING, *LOSING, *WEIGHING, *MOTION, *SKIPPING, *HALTING,
)  # fmt: skip
