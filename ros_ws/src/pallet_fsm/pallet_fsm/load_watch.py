"""What the machine expects of the load in its hand: that it weighs what the order says.

A gripper that reports a hold may hold nothing, two boxes or another one. The first part of the way after each
grip tells, as the arm must lift what is there.
"""

from __future__ import annotations

from pack_core.palletizing.cell import REJECT_TABLE, PalletizingCell
from pack_core.palletizing.ports import PalletObservation
from pallet_fsm.hand_scale import HandScale
from pallet_fsm.order_book import WorkItem
from pallet_fsm.palletizer_config import WeighingConfig


class LoadWatch:
    """Weighs each box once after each grip.

    Args:
        config: how long, and what counts as another weight.
        cell: the cell's physical facts.
    """

    def __init__(self, config: WeighingConfig, cell: PalletizingCell) -> None:
        self._config = config
        self._scale = HandScale(cell)
        self._item: WorkItem | None = None
        self._has_torques = False

    @property
    def is_weighing(self) -> bool:
        """Whether a box was gripped of which the weight is about to be known."""
        return self._item is not None and self._has_torques

    def observe(self, seen: PalletObservation) -> None:
        """Take note of the joints."""
        if self._config.window == 0.0:
            return
        for sample in seen.samples:
            self._has_torques = True
            self._scale.note(sample)

    def take(self, item: WorkItem) -> None:
        """Weigh a box that was just gripped, on the way that follows."""
        assert item.X_TB is not None
        self._item, item.weighed = item, None
        self._scale.put_on(item.dims, item.X_TB)

    def let_go(self) -> None:
        """The hand is empty from now on."""
        self._item = None
        self._scale.take_off()

    def fault(self) -> str:
        """What is wrong with the load, in words; empty where nothing is, or nothing is known yet.

        It is said once.
        """
        item, mass = self._item, self._scale.mass
        if item is None or mass is None or self._scale.seconds < self._config.window:
            return ""
        self._item, item.weighed = None, mass
        told = item.box.weight
        allowed = self._config.tolerance + self._config.share * told
        if item.deck == REJECT_TABLE:  # nobody knows what is in a box that is rejected
            return ""
        if abs(mass - told) <= allowed:
            return ""
        if mass < allowed:
            return (
                f"the gripper reports a hold, but the hand is empty: {mass:.1f} kg instead of {told:.1f} kg"
            )
        return (
            f"the hand holds {mass:.1f} kg instead of {told:.1f} kg; allowed: {allowed:.1f} kg more or less"
        )
