"""The tool's targets in each state: one function for a state, or for several with the same target.

A new step needs a row in `states.py`, its transitions in `transitions.py` and an entry in `TARGETS`.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from pack_core.motion.moves import UP
from pack_core.rotations import Array, Pose
from pallet_fsm.goals import Goals, raised
from pallet_fsm.order_book import WorkItem
from pallet_fsm.palletizer_config import ThesisConfig
from pallet_fsm.report import BoxOutcome
from pallet_fsm.states import State


@dataclass(frozen=True)
class ToolTarget:
    """Where the tool shall be at the end of a state.

    Attributes:
        X_WT: pose of the tool.
        approach: horizontal approach direction of the tool where it stands a box up `(3,)`; None elsewhere.
    """

    X_WT: Pose
    approach: Array | None = None


@dataclass(frozen=True)
class Situation:
    """Everything that the target of a state depends on.

    Attributes:
        goals: finds tool poses over boxes and places.
        config: way-points and distances.
        box: the box in work; None where there is none.
        X_WT: present pose of the tool.
    """

    goals: Goals
    config: ThesisConfig
    box: WorkItem | None
    X_WT: Pose

    @property
    def item(self) -> WorkItem:
        """The box in work, in the states that need one."""
        assert self.box is not None
        return self.box


Finder = Callable[[Situation], list[ToolTarget]]


def targets_of(state: State, now: Situation) -> list[ToolTarget]:
    """The alternative targets of a state, best first, since box and tool are symmetric under some turns."""
    return TARGETS[state](now)


def _at(poses: list[Pose]) -> list[ToolTarget]:
    return [ToolTarget(X_WT) for X_WT in poses]


def _up(now: Situation) -> list[ToolTarget]:
    """Straight up from the present pose."""
    return _at([raised(now.X_WT, now.config.above * UP)])


def _up_turned(now: Situation) -> list[ToolTarget]:
    """Straight up, with the orientation in which the box on table B is gripped next; else as it is."""
    p = now.X_WT.p + now.config.above * UP
    return [*_at([Pose(p, X_WT.q) for X_WT in now.goals.grasps(now.item, now.X_WT)]), *_up(now)]


def _from_place(now: Situation) -> list[ToolTarget]:
    """Back to where the tool came from over a place, or up along the pallet's own vertical."""
    was_placed = now.box is not None and now.box.outcome is BoxOutcome.PLACED
    offset = _over_insertion(now) if was_placed else now.config.above * UP
    return _at([raised(now.X_WT, now.goals.in_world(offset))])


def _over_box(now: Situation) -> list[ToolTarget]:
    return _at([raised(X_WT, now.config.above * UP) for X_WT in now.goals.grasps(now.item, now.X_WT)])


def _on_box(now: Situation) -> list[ToolTarget]:
    return _at(now.goals.grasps(now.item, now.X_WT))


def _over_table(now: Situation) -> list[ToolTarget]:
    """The box over its place at the edge of table B, already turned as it will stand."""
    height = now.config.before_table * UP
    found = now.goals.stands(now.item, now.X_WT)
    return [ToolTarget(raised(stand.X_WT, height), stand.approach) for stand in found]


def _on_table(now: Situation) -> list[ToolTarget]:
    return [ToolTarget(stand.X_WT, stand.approach) for stand in now.goals.stands(now.item, now.X_WT)]


def _back(now: Situation) -> list[ToolTarget]:
    """Away from the box on table B, against the direction that the tool came from."""
    assert now.item.approach is not None
    return _at([raised(now.X_WT, -now.config.step_back * now.item.approach)])


def _safe_pick(now: Situation) -> list[ToolTarget]:
    return _safe(now.config.safe_pick, [now.X_WT])


def _safe_table(now: Situation) -> list[ToolTarget]:
    return _safe(now.config.safe_table, [now.X_WT])


def _leave_table(now: Situation) -> list[ToolTarget]:
    return _safe(now.config.safe_table, _turned_to_place(now))


def _safe_pallet(now: Situation) -> list[ToolTarget]:
    return _safe(now.config.safe_pallet, _turned_to_place(now))


def _return(now: Situation) -> list[ToolTarget]:
    return _safe(now.config.safe_pallet, [now.X_WT])


def _safe(point: tuple[float, float, float], turned: list[Pose]) -> list[ToolTarget]:
    """A safe position, with the orientation of each of some poses."""
    return _at([Pose(np.array(point), X_WT.q) for X_WT in turned])


def _turned_to_place(now: Situation) -> list[Pose]:
    """Tool poses with the orientation that is needed over the box's place; the present one without a box."""
    return [now.X_WT] if now.item.X_TB is None else now.goals.placements(now.item, now.X_WT)


def _over_place(now: Situation) -> list[ToolTarget]:
    offset = now.goals.in_world(_over_insertion(now), now.item.deck)
    return _at([raised(X_WT, offset) for X_WT in now.goals.placements(now.item, now.X_WT)])


def _close_over_place(now: Situation) -> list[ToolTarget]:
    offset = now.goals.in_world(now.config.final_height * UP, now.item.deck)
    return _at([raised(X_WT, offset) for X_WT in now.goals.placements(now.item, now.X_WT)])


def _on_place(now: Situation) -> list[ToolTarget]:
    return _at(now.goals.placements(now.item, now.X_WT))


def _over_insertion(now: Situation) -> Array:
    """From a box's place to `place_inter`, over where its insertion begins `(3,)` [m], in the pallet's axes.

    Eq. 6.6, p_start = c + L d.
    """
    return now.item.plan.insertion.offset(np.inf, now.config.above)


def _back_to_grip(now: Situation) -> list[ToolTarget]:
    """Where the box was gripped, and so much higher as boxes are let go over what they are put on."""
    assert now.item.X_WG is not None
    return _at([raised(now.item.X_WG, now.goals.drop * UP)])


TARGETS: dict[State, Finder] = {
    State.ABOVE_BOX: _over_box,
    State.GRASP: _on_box,
    State.LIFT: _up,
    State.SAFE_PICK: _safe_pick,
    State.SAFE_TABLE: _safe_table,
    State.ROTATE: _over_table,
    State.RELEASE_TABLE: _on_table,
    State.STEP_BACK: _back,
    State.RISE: _up_turned,
    State.ABOVE_TABLE: _over_box,
    State.REGRASP: _on_box,
    State.LIFT_TABLE: _up,
    State.LEAVE_TABLE: _leave_table,
    State.TRANSFER: _safe_pallet,
    State.ABOVE_PALLET: _over_place,
    State.PRE_DEPOSIT: _close_over_place,
    State.DEPOSIT: _on_place,
    State.RETREAT: _from_place,
    State.RETURN: _return,
    State.PUT_BACK: _back_to_grip,
}
"""What finds the tool's targets, for every state in which the arm moves."""
