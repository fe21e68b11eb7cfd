"""How far an order has come, from the states that the machine enters."""

from __future__ import annotations

from html import escape

from pack_viewer.fragments import BLUE, RED, boxed, chips
from pallet_fsm.states import ENDS, FAULTS, STEPS, State

STEP_LABELS = tuple(row.state.label for row in STEPS)
FAULT_LABELS = tuple(state.label for state in (*FAULTS, State.SKIP_BOX))
END_LABELS = tuple(state.label for state in ENDS)
WHAT = {row.state.label: row.what for row in STEPS}
WRONG = {*FAULT_LABELS, State.SAFE_STOP.label}
SHOWN = 12
"""Boxes whose times are listed."""


class OrderProgress:
    """Follows the machine through an order.

    Attributes:
        placed: names of the boxes that were set down on the pallet, in order, each once.
    """

    def __init__(self) -> None:
        self._state = self._box = self._reason = ""
        self._visited: list[str] = []
        self._failed: dict[str, str] = {}
        self._began: dict[str, float] = {}
        self._took: dict[str, float] = {}
        self.placed: list[str] = []

    def enter(self, state: str, box: str, reason: str, time: float) -> None:
        """The machine entered a state at simulated time `time` [s], with the box in work."""
        before, last = self._state, self._box
        if state == STEP_LABELS[0] and last and last != box and last in self.placed:
            self._took[last] = time - self._began[last]  # a box's cycle ends where the next one's begins
        if before == State.RETREAT.label and box == last:
            self._took[box] = time - self._began[box]  # the last box of an order has no successor
        if box != self._box or (state == STEP_LABELS[0] and self._state in END_LABELS):
            self._visited = []
        if state == STEP_LABELS[0] and self._state in END_LABELS:  # another order begins
            self._failed, self._began, self._took, self.placed = {}, {}, {}, []
        self._state, self._box, self._reason = state, box, reason
        self._visited.append(state)
        self._began.setdefault(box, time)
        if state in WRONG:
            self._failed[state] = reason
        if state == State.RETREAT.label and box not in self.placed:
            self.placed.append(box)

    @property
    def is_fault(self) -> bool:
        """Whether the machine is in a state that it should not need."""
        return self._state in WRONG

    @property
    def note(self) -> str:
        """What the machine does or waits for, in words."""
        doing = self._reason or WHAT.get(self._state, "")
        return f"{doing}, box {self._box}" if doing and self._box else doing

    def placed_text(self, count: int = 0) -> str:
        """How many of `count` boxes (0: not known) are placed, and how long one took on average."""
        text = f"{len(self.placed)} of {count}" if count else str(len(self.placed))
        if not self._took:
            return text
        return f"{text}, {sum(self._took.values()) / len(self._took):.1f} s a box"

    def states_html(self) -> str:
        """The machine's states: the current one lit, those of this box ticked, faults with their reason."""
        steps = chips(STEP_LABELS, self._state, self._visited)
        others = chips((*FAULT_LABELS, *END_LABELS), self._state, (), self._failed)
        reasons = "".join(
            f'<div style="color:{RED}">✕ {escape(state)}: {escape(reason)}</div>'
            for state, reason in self._failed.items()
            if reason
        )
        return boxed(f"{steps}<hr style='opacity:.3'>{others}{reasons}")

    def cycles_html(self) -> str:
        """Seconds of each of the last boxes, as bars."""
        if not self._took:
            return ""
        longest = max(self._took.values())
        rows = "".join(
            '<div style="display:flex;gap:.5em">'
            f'<span style="flex:0 0 9em;overflow:hidden">{escape(box)}</span>'
            f'<span style="background:{BLUE};width:{45 * took / longest:.0f}%;height:1em"></span>'
            f'<span style="white-space:nowrap">{took:.1f} s</span></div>'
            for box, took in list(self._took.items())[-SHOWN:]
        )
        return boxed(f'<div style="opacity:.7">seconds a box</div>{rows}')
