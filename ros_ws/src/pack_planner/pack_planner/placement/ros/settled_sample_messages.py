"""Samples of Algorithm 1 as settled scenes, for the recorder."""

from __future__ import annotations

from collections.abc import Sequence

from pack_interfaces.msg import SettledSample as SettledSampleMessage
from pack_interfaces.msg import SettledSamples

from pack_core.packing.settled_sample import SettledSample
from pack_core.ros.messages.conversions import WORLD, to_pose, to_stamp


def to_settled_samples(time: float, samples: Sequence[SettledSample]) -> SettledSamples:
    """The message for samples of a placement that was planned for the scene at `time` [s]."""
    message = SettledSamples(samples=[_to_message(sample) for sample in samples])
    message.header.stamp, message.header.frame_id = to_stamp(time), WORLD
    return message


def _to_message(sample: SettledSample) -> SettledSampleMessage:
    return SettledSampleMessage(
        cost=sample.cost, rank=sample.rank, is_feasible=sample.is_feasible, names=list(sample.poses),
        poses=[to_pose(X_WO) for X_WO in sample.poses.values()],
    )  # fmt: skip
