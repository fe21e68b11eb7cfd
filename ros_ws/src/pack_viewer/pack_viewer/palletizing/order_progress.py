"""How far an order has come, from the states that the machine enters."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from html import escape
from typing import Any

import mujoco
import numpy as np
from viser import GlbHandle, SceneApi

from pack_core.palletizing.cell import PALLETS
from pack_viewer.fragments import BLUE, RED, boxed, chips
from pack_viewer.geom_meshes import box_glb
from pack_viewer.model_scene import scene_name
from pallet_fsm.states import ENDS, FAULTS, ROWS, STEPS, State

CUBE, TEXT = 1, 9
"""Types of visualization_msgs/Marker: a box, and the text over it that names it."""
COLOUR = (0.34, 0.71, 0.91, 0.22)
"""Of a place that is to be filled: red, green, blue, opacity."""


class OrderPlaces:
    """The places of an order; each is hidden once its box stands there."""

    def __init__(self, scene: SceneApi) -> None:
        self._scene = scene
        self._handles: dict[str, GlbHandle] = {}
        self._model = mujoco.MjSpec().compile()

    @property
    def count(self) -> int:
        """How many boxes the order has; 0 while none is known."""
        return len(self._handles)

    def set(self, markers: Sequence[Any]) -> None:
        """Take up a cell's goal markers: a box, then its name, again and again."""
        self.clear()
        boxes = [marker for marker in markers if marker.type == CUBE and marker.scale.x > 0.0]
        names = [str(marker.text) for marker in markers if marker.type == TEXT]
        for name, marker in zip(names, boxes, strict=False):
            half = 0.5 * np.array([marker.scale.x, marker.scale.y, marker.scale.z])
            p, q = marker.pose.position, marker.pose.orientation
            self._handles[name] = self._scene.add_glb(
                f"/places/{scene_name(name)}", box_glb(self._model, half, rgba=COLOUR),
                position=(p.x, p.y, p.z), wxyz=(q.w, q.x, q.y, q.z), cast_shadow=False, receive_shadow=False,
            )  # fmt: skip

    def take(self, names: Collection[str]) -> None:
        """Hide the places of boxes that stand there, and no others."""
        for name, handle in self._handles.items():
            if handle.visible == (name in names):
                handle.visible = name not in names

    def clear(self) -> None:
        """There is no order."""
        for handle in self._handles.values():
            handle.remove()
        self._handles = {}


STEP_LABELS = tuple(row.state.label for row in STEPS)
FAULT_LABELS = tuple(state.label for state in (*FAULTS, State.SKIP_BOX))
END_LABELS = tuple(state.label for state in ENDS)
WHAT = {row.state.label: row.what for row in ROWS.values()}
WRONG = {*FAULT_LABELS, State.SAFE_STOP.label}
SHOWN = 12
"""Boxes whose times are listed."""


class OrderProgress:
    """Follows the machine through one order, or a shift, in which it may end and begin again.

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

    def enter(self, state: str, box: str, place: str, reason: str, time: float) -> None:
        """The machine entered a state at `time` [s], with the box in work, which goes to `place`."""
        before, last = self._state, self._box
        is_next = state == STEP_LABELS[0] and last != box and before not in END_LABELS
        if is_next and last in self.placed:
            self._took[last] = time - self._began[last]  # a box's cycle ends where the next one's begins
        if before == State.RETREAT.label and box == last and box in self.placed:
            self._took[box] = time - self._began[box]  # the last box of an order has no successor
        if box != self._box or (state == STEP_LABELS[0] and self._state in END_LABELS):
            self._visited = []
        self._state, self._box, self._reason = state, box, reason
        self._visited.append(state)
        self._began.setdefault(box, time)
        if state in WRONG:
            self._failed[state] = reason
        was_set_down = before == State.DEPOSIT.label and state == State.RETREAT.label and place in PALLETS
        if was_set_down and box not in self.placed:
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

    @property
    def is_under_way(self) -> bool:
        """Whether an order has begun and has not ended."""
        return bool(self._state) and self._state not in END_LABELS

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
