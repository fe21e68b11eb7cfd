"""A box of the order with all that is known about it while it is handled."""

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
    """A box of the order and its state.

    Attributes:
        box: the box as ordered.
        plan: its place in the layout and its insertion.
        X_WB: estimated pose where it stands; None before it was detected and while it is gripped.
        X_TB: pose in the tool's frame while it is gripped; None otherwise.
        approach: approach direction of the tool when it stood the box up on table B `(3,)`.
        outcome: what became of the box.
        reason: why it was skipped or lost; empty otherwise.
        tries: number of faults of each kind so far.
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
        """Name of the box."""
        return self.box.id

    @property
    def dims(self) -> Array:
        """Edges as it arrives `(3,)` [m]."""
        return np.array(self.box.dims)

    @property
    def handling(self) -> Handling:
        """How the box must be turned on its way."""
        return self.box.turn.handling

    @property
    def is_finished(self) -> bool:
        """Whether the box was placed, skipped or lost."""
        return self.outcome is not BoxOutcome.PENDING

    def finish(self, outcome: BoxOutcome, reason: str = "") -> None:
        """Note what became of the box; nothing more is done for it."""
        self.outcome, self.reason = outcome, reason

    @property
    def carried(self) -> CarriedBox | None:
        """The gripped box as the motion's collision checks need it; None while it is not gripped."""
        return None if self.X_TB is None else CarriedBox(self.X_TB, self.dims)

    def take(self, X_WT: Pose) -> None:
        """Note that the box was gripped: its estimated pose gives X_TB."""
        assert self.X_WB is not None
        self.X_TB, self.X_WB = X_WT.inverse() @ self.X_WB, None

    def let_go(self, X_WT: Pose, drop: float) -> None:
        """Note that the box was released: it stands `drop` [m] below the pose of its release."""
        assert self.X_TB is not None
        X_WB = X_WT @ self.X_TB
        self.X_WB, self.X_TB = Pose(X_WB.p - np.array([0.0, 0.0, drop]), X_WB.q), None
