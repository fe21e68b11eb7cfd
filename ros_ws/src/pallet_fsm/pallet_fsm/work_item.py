"""The box in work: what is known of it, growing from state to state."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass, field

import numpy as np

from pack_core.motion.world import CarriedBox
from pack_core.palletizing.orders.handling import Handling
from pack_core.palletizing.orders.layout_plan import PlannedBox
from pack_core.palletizing.orders.order import OrderBox
from pack_core.rotations import Array, Pose
from pallet_fsm.report import BoxOutcome
from pallet_fsm.states import State


@dataclass
class WorkItem:
    """A box on its way.

    Attributes:
        box: as ordered.
        plan: its regularised place and its insertion.
        X_WB: where it is believed to stand; None before it was detected and while it is in the hand.
        X_TB: how it hangs in the hand; None while it does not.
        approach: direction in which the tool held it when it stood it up on table B `(3,)`.
        outcome: what became of it.
        reason: why it was skipped or lost; empty otherwise.
        tries: faults of each kind so far.
    """

    box: OrderBox
    plan: PlannedBox
    X_WB: Pose | None = None
    X_TB: Pose | None = None
    approach: Array | None = None
    outcome: BoxOutcome = BoxOutcome.PENDING
    reason: str = ""
    tries: Counter[State] = field(default_factory=Counter)

    @property
    def name(self) -> str:
        """Of the box."""
        return self.box.id

    @property
    def dims(self) -> Array:
        """Edges as it arrives `(3,)` [m]."""
        return np.array(self.box.dims)

    @property
    def handling(self) -> Handling:
        """What it takes."""
        return self.box.turn.handling

    @property
    def is_finished(self) -> bool:
        """Whether nothing is to be done for it any more."""
        return self.outcome is not BoxOutcome.PENDING

    def finish(self, outcome: BoxOutcome, reason: str = "") -> None:
        """Nothing is to be done for it any more."""
        self.outcome, self.reason = outcome, reason

    @property
    def carried(self) -> CarriedBox | None:
        """The box in the hand, for the motion."""
        return None if self.X_TB is None else CarriedBox(self.X_TB, self.dims)

    def take(self, X_WT: Pose) -> None:
        """It hangs in the hand now: what was believed of it gives its pose in the tool's frame."""
        assert self.X_WB is not None
        self.X_TB, self.X_WB = X_WT.inverse() @ self.X_WB, None

    def let_go(self, X_WT: Pose, drop: float) -> None:
        """It stands where it was let go, `drop` [m] lower."""
        assert self.X_TB is not None
        X_WB = X_WT @ self.X_TB
        self.X_WB, self.X_TB = Pose(X_WB.p - np.array([0.0, 0.0, drop]), X_WB.q), None
