"""Converts the machine's progress and outcome into messages."""

from __future__ import annotations

import json

from pack_interfaces.action import Palletize
from pack_interfaces.msg import PalletState

from pack_core.ros.messages.conversions import to_stamp
from pallet_fsm.machine import Visit
from pallet_fsm.palletizer import Palletizer
from pallet_fsm.report import BoxOutcome, OrderReport


def to_state(visit: Visit) -> PalletState:
    """The message about a state that was entered."""
    event = visit.event.value if visit.event else ""
    message = PalletState(state=visit.state.label, box=visit.box, event=event, reason=visit.reason)
    message.header.stamp = to_stamp(visit.time)
    return message


def to_feedback(session: Palletizer, elapsed: float) -> Palletize.Feedback:
    """The action feedback: present state, box, and number of placed boxes."""
    report = session.report()
    return Palletize.Feedback(
        state=session.machine.state.label, box=session.machine.visits[-1].box, placed=_placed(report),
        boxes=len(report.boxes), elapsed=elapsed,
    )  # fmt: skip


def to_result(report: OrderReport, elapsed: float) -> Palletize.Result:
    """The action result of an order that has ended."""
    return Palletize.Result(
        success=report.is_complete, message=message_of(report), placed=_placed(report),
        boxes=len(report.boxes), execution_time=elapsed, report=json.dumps(report.to_json()),
    )  # fmt: skip


def message_of(report: OrderReport) -> str:
    """Why not every box was placed; empty if every one was."""
    left_out = [f"box {box.name}: {box.reason}" for box in report.boxes if box.reason]
    return "; ".join(dict.fromkeys([text for text in (report.reason, *left_out) if text]))


def _placed(report: OrderReport) -> int:
    return sum(box.outcome is BoxOutcome.PLACED for box in report.boxes)
