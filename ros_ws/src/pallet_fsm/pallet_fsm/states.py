"""The states of the palletizing machine: the thesis's 21 (Table 8.1), the faults and the ends.

Every state is a row of data in `STEPS`. The profiles, the transitions for faults and the page of states are
derived from these rows, so that a new step is a row here, its transitions and its tool pose.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from enum import Enum, IntEnum

from pack_core.errors import ConfigError
from pack_core.motion.moves import Mode


class State(Enum):
    """The states; the values of the thesis's 21 steps are its numbers, those of all others are words."""

    SPAWN = 0
    DETECT = 1
    ABOVE_BOX = 2
    GRASP = 3
    LIFT = 4
    SAFE_PICK = 5
    SAFE_TABLE = 6
    ROTATE = 7
    RELEASE_TABLE = 8
    STEP_BACK = 9
    RISE = 10
    ABOVE_TABLE = 11
    REGRASP = 12
    LIFT_TABLE = 13
    LEAVE_TABLE = 14
    TRANSFER = 15
    ABOVE_PALLET = 16
    PRE_DEPOSIT = 17
    DEPOSIT = 18
    RETREAT = 19
    RETURN = 20
    PUT_BACK = "put back"
    NO_DETECTION = "no detection"
    WRONG_SIZE = "wrong size"
    BOX_CHANGED = "box changed"
    PLACE_CHANGED = "place changed"
    GRIP_FAILED = "grip failed"
    BOX_LOST = "box lost"
    WRONG_WEIGHT = "wrong weight"
    MOTION_STUCK = "motion stuck"
    LIMIT_PASSED = "limit passed"
    NOT_CLEAR = "not clear"
    SKIP_BOX = "skip box"
    SAFE_STOP = "safe stop"
    DONE = "done"

    @property
    def label(self) -> str:
        """Number and name, as in logs and drawings."""
        words = self.name.lower().replace("_", " ")
        return f"{self.value} {words}" if isinstance(self.value, int) else words


class Grip(Enum):
    """What the gripper does in a state; CLOSE and OPEN act once the target is reached."""

    CLOSE = "close"
    HOLD = "hold"
    OPEN = "open"
    EMPTY = "empty"


class Check(Enum):
    """Which checker confirms a state's target (section 8.2)."""

    PRECISE = "2 mm, 0.5 deg"
    TRANSIT = "5 mm, 1 deg, 3 steps"


class Shape(Enum):
    """How the tool moves to the state's target in the profile `thesis`."""

    FREE = "through free space"
    LINE = "along a straight line"


class Part(IntEnum):
    """The part of a blended move, from one stop of the arm to the next, that a state stands for; in order.

    In the profile `blended` a state whose part is NONE has no target of its own and is left as soon as it is
    entered; at the target of a FINAL state the arm stops.
    """

    NONE = -1
    DEPART = 0
    CROSS = 1
    APPROACH = 2
    FINAL = 3


class Place(Enum):
    """What a box stands on where the tool takes hold of it or lets it go."""

    TABLE_A = "picking table"
    TABLE_B = "reorientation table"
    PALLET = "pallet"


@dataclass(frozen=True)
class StateRow:
    """A line of Table 8.1.

    Attributes:
        state: the state that the row describes.
        what: what happens in it, in words, for the page of states.
        mode: mode of the motion, in the profile `thesis`; None: the arm has no target in this state.
        grip: what the gripper does.
        check: how exactly the target must be reached.
        shape: shape of the path to the target, in the profile `thesis`.
        part: part of a blended move, in the profile `blended`.
        place: what the box stands on, or nearly, at the target; the box and what is beside it may be touched.
        feeds: whether the next box may be sent for, in the profile `blended`, once table A is clear.
    """

    state: State
    what: str
    mode: Mode | None
    grip: Grip
    check: Check | None
    shape: Shape = Shape.FREE
    part: Part = Part.NONE
    place: Place | None = None
    feeds: bool = False


_FAST, _SLOW = Mode.FAST, Mode.SLOW
_CLOSE, _HOLD, _OPEN, _EMPTY = Grip.CLOSE, Grip.HOLD, Grip.OPEN, Grip.EMPTY
_PRECISE, _TRANSIT = Check.PRECISE, Check.TRANSIT
_FREE, _LINE = Shape.FREE, Shape.LINE
_NONE, _DEPART, _CROSS, _APPROACH, _FINAL = Part.NONE, Part.DEPART, Part.CROSS, Part.APPROACH, Part.FINAL
_TABLE_A, _TABLE_B, _PALLET = Place.TABLE_A, Place.TABLE_B, Place.PALLET

# fmt: off
STEPS = (
    StateRow(State.SPAWN, "a box comes to table A", None, _EMPTY, None),
    StateRow(State.DETECT, "the camera finds it", None, _EMPTY, None),
    StateRow(State.ABOVE_BOX, "to over the box",
             _FAST, _EMPTY, _TRANSIT, _FREE, _CROSS),
    StateRow(State.GRASP, "down to the box, grip it",
             _SLOW, _CLOSE, _PRECISE, _LINE, _FINAL, _TABLE_A),
    StateRow(State.LIFT, "lift it off",
             _SLOW, _HOLD, _TRANSIT, _LINE, _DEPART),
    StateRow(State.SAFE_PICK, "safe position over table A",
             _FAST, _HOLD, _TRANSIT),
    StateRow(State.SAFE_TABLE, "safe position over table B",
             _FAST, _HOLD, _TRANSIT),
    StateRow(State.ROTATE, "turn the box, to over its place at the edge of table B",
             _SLOW, _HOLD, _PRECISE, _FREE, _CROSS),
    StateRow(State.RELEASE_TABLE, "set it down, let go",
             _SLOW, _OPEN, _PRECISE, _LINE, _FINAL, _TABLE_B),
    StateRow(State.STEP_BACK, "back off horizontally",
             _SLOW, _EMPTY, _PRECISE, _LINE, _DEPART),
    StateRow(State.RISE, "up, out of its reach",
             _SLOW, _EMPTY, _PRECISE, _LINE),
    StateRow(State.ABOVE_TABLE, "to over the box's new top",
             _SLOW, _EMPTY, _PRECISE, _FREE, _CROSS),
    StateRow(State.REGRASP, "down to it, grip it again",
             _SLOW, _CLOSE, _PRECISE, _LINE, _FINAL, _TABLE_B),
    StateRow(State.LIFT_TABLE, "lift it off table B",
             _SLOW, _HOLD, _PRECISE, _LINE, _DEPART),
    StateRow(State.LEAVE_TABLE, "safe position over table B",
             _FAST, _HOLD, _TRANSIT),
    StateRow(State.TRANSFER, "safe position over the pallet",
             _FAST, _HOLD, _TRANSIT),
    StateRow(State.ABOVE_PALLET, "to over the place, shifted against the insertion",
             _FAST, _HOLD, _TRANSIT, _FREE, _CROSS, feeds=True),
    StateRow(State.PRE_DEPOSIT, "down to where the insertion begins",
             _SLOW, _HOLD, _PRECISE, _LINE, _APPROACH, _PALLET, feeds=True),
    StateRow(State.DEPOSIT, "insert the box, let go",
             _SLOW, _OPEN, _PRECISE, _LINE, _FINAL, _PALLET, feeds=True),
    StateRow(State.RETREAT, "up from the box",
             _SLOW, _EMPTY, _PRECISE, _LINE, _DEPART, feeds=True),
    StateRow(State.RETURN, "safe position over the pallet",
             _FAST, _EMPTY, _TRANSIT, feeds=True),
)
# fmt: on
"""The thesis's steps (Table 8.1)."""
PUT_BACK = StateRow(
    State.PUT_BACK,
    "back to where the box was gripped, let go",
    _SLOW,
    _OPEN,
    _PRECISE,
    _FREE,
    _FINAL,
    _TABLE_A,
)
"""The one step more: for a box that has not the weight that it should have."""

ROWS = {row.state: row for row in (*STEPS, PUT_BACK)}
MOVING = tuple(row.state for row in ROWS.values() if row.mode is not None)
"""States in which the arm has a target."""
HOLDING = tuple(row.state for row in ROWS.values() if row.grip in (Grip.HOLD, Grip.OPEN))
"""States in which the gripper holds a box."""
CARRYING = tuple(state for state in HOLDING if state is not State.PUT_BACK)
"""States in which a box is on its way; if it has not the weight that it should have it is put back."""
BEFORE_REGRASP = (State.STEP_BACK, State.RISE, State.ABOVE_TABLE, State.REGRASP)
"""States in which a box stands free on table B."""
FAULTS = (
    State.NO_DETECTION, State.WRONG_SIZE, State.BOX_CHANGED, State.PLACE_CHANGED, State.GRIP_FAILED,
    State.BOX_LOST, State.WRONG_WEIGHT, State.MOTION_STUCK, State.LIMIT_PASSED, State.NOT_CLEAR,
)  # fmt: skip
ENDS = (State.SAFE_STOP, State.DONE)


@dataclass(frozen=True)
class Profile:
    """One way to run the steps.

    Attributes:
        parts: part of a blended move that each state is; empty: every state is a move of its own with a stop.
        feeds_ahead: whether the next box is sent for and detected while this one is still in work; if not,
            that is done in states 0 and 1.
    """

    parts: Mapping[State, Part]
    feeds_ahead: bool

    @property
    def is_blended(self) -> bool:
        """Whether a move runs through several states."""
        return bool(self.parts)

    def stops_at(self, state: State) -> bool:
        """Whether the arm comes to rest at the state's target."""
        return self.parts.get(state, Part.FINAL) is Part.FINAL

    def mode(self, state: State) -> Mode | None:
        """The mode in which the arm moves in a state; None where it has no target or passes at once."""
        part = self.parts.get(state)
        if part is Part.NONE:
            return None
        return Mode.FAST if part is Part.CROSS else ROWS[state].mode


PROFILES = {
    "thesis": Profile({}, feeds_ahead=False),
    "blended": Profile({state: ROWS[state].part for state in MOVING}, feeds_ahead=True),
}


def profile_of(name: str) -> Profile:
    """The profile called `name`; raises ConfigError where there is none."""
    if name not in PROFILES:
        raise ConfigError(f"profile '{name}'; allowed: {', '.join(PROFILES)}")
    return PROFILES[name]
