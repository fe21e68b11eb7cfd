"""Plans are the same again when they come back from a file."""

import json

from pack_core.blocks.plan import PickPlace, Push, from_record, to_record
from pack_core.blocks.planar import PlanarPose


def test_actions_come_back_as_they_were() -> None:
    here, there = PlanarPose(0.1, -0.2, 1 / 3), PlanarPose(0.1 + 0.021 / 3, -0.2, 1 / 3)
    actions = (PickPlace("b1", there, here, grasp=1), Push("b2", here, there))
    assert from_record(json.loads(json.dumps(to_record(actions)))) == actions
