"""The states of the palletizing machine: the thesis's 21 (Table 8.1), the faults and the ends.

What a state is, is data: its speed, what the gripper does in it, and how its target is checked.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum

from pack_core.motion.moves import Mode


class State(Enum):
    """States by name; the values of the 21 steps are the thesis's numbers."""

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
    NO_DETECTION = "no detection"
    WRONG_SIZE = "wrong size"
    GRIP_FAILED = "grip failed"
    BOX_LOST = "box lost"
    MOTION_STUCK = "motion stuck"
    LIMIT_PASSED = "limit passed"
    NOT_CLEAR = "not clear"
    SKIP_BOX = "skip box"
    SAFE_STOP = "safe stop"
    DONE = "done"

    @property
    def label(self) -> str:
        """Number and name, as logs and drawings have them."""
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


@dataclass(frozen=True)
class StateRow:
    """A line of Table 8.1; without a mode the arm has no target of its own."""

    state: State
    what: str
    mode: Mode | None
    grip: Grip
    check: Check | None


_FAST, _SLOW = Mode.FAST, Mode.SLOW
_CLOSE, _HOLD, _OPEN, _EMPTY = Grip.CLOSE, Grip.HOLD, Grip.OPEN, Grip.EMPTY
_PRECISE, _TRANSIT = Check.PRECISE, Check.TRANSIT

# fmt: off
STEPS = (
    StateRow(State.SPAWN, "a box comes to table A", None, _EMPTY, None),
    StateRow(State.DETECT, "the camera finds it", None, _EMPTY, None),
    StateRow(State.ABOVE_BOX, "to over the box", _FAST, _EMPTY, _TRANSIT),
    StateRow(State.GRASP, "down to the box, grip it", _SLOW, _CLOSE, _PRECISE),
    StateRow(State.LIFT, "lift it off", _SLOW, _HOLD, _TRANSIT),
    StateRow(State.SAFE_PICK, "safe position over table A", _FAST, _HOLD, _TRANSIT),
    StateRow(State.SAFE_TABLE, "safe position over table B", _FAST, _HOLD, _TRANSIT),
    StateRow(State.ROTATE, "turn the box, to over its place at the edge of table B", _SLOW, _HOLD, _PRECISE),
    StateRow(State.RELEASE_TABLE, "set it down, let go", _SLOW, _OPEN, _PRECISE),
    StateRow(State.STEP_BACK, "back off horizontally", _SLOW, _EMPTY, _PRECISE),
    StateRow(State.RISE, "up, out of its reach", _SLOW, _EMPTY, _PRECISE),
    StateRow(State.ABOVE_TABLE, "to over the box's new top", _SLOW, _EMPTY, _PRECISE),
    StateRow(State.REGRASP, "down to it, grip it again", _SLOW, _CLOSE, _PRECISE),
    StateRow(State.LIFT_TABLE, "lift it off table B", _SLOW, _HOLD, _PRECISE),
    StateRow(State.LEAVE_TABLE, "safe position over table B", _FAST, _HOLD, _TRANSIT),
    StateRow(State.TRANSFER, "safe position over the pallet", _FAST, _HOLD, _TRANSIT),
    StateRow(State.ABOVE_PALLET, "to over the place, shifted against the insertion", _FAST, _HOLD, _TRANSIT),
    StateRow(State.PRE_DEPOSIT, "down to where the insertion begins", _SLOW, _HOLD, _PRECISE),
    StateRow(State.DEPOSIT, "insert the box, let go", _SLOW, _OPEN, _PRECISE),
    StateRow(State.RETREAT, "up from the box", _SLOW, _EMPTY, _PRECISE),
    StateRow(State.RETURN, "safe position over the pallet", _FAST, _EMPTY, _TRANSIT),
)
# fmt: on

ROWS = {row.state: row for row in STEPS}
FAULTS = (
    State.NO_DETECTION, State.WRONG_SIZE, State.GRIP_FAILED, State.BOX_LOST,
    State.MOTION_STUCK, State.LIMIT_PASSED, State.NOT_CLEAR,
)  # fmt: skip
ENDS = (State.SAFE_STOP, State.DONE)
