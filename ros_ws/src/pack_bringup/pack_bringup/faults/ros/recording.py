"""How much a recording lacks whose recorder was killed."""

from __future__ import annotations

from pathlib import Path

from pack_bringup.faults.arm_record import ArmRecord
from pack_core.errors import BagError
from pack_core.ros.messages.conversions import from_stamp
from pack_evaluation.bag import read_bag

RECORDED = "/joint_states"


def lacking(bag: Path, arm: ArmRecord, struck_ns: int) -> float:
    """Simulated time before a moment of the wall clock that a recording lacks [s], if need be all of it."""
    try:
        messages = read_bag(bag.parent).of(RECORDED)
        newest = max((from_stamp(message.header.stamp) for message in messages), default=0.0)
    except BagError:
        newest = 0.0
    return max(0.0, arm.simulated(struck_ns) - newest)
