"""Accuracy of tag perception over many random scenes, shadows and all."""

import numpy as np
import pytest

from pack_core.blocks.planar import turn_between
from pack_perception.tags.tag_vision import TagVision, TagVisionConfig
from pack_sim.blocks.overhead_camera import OverheadCamera
from unit.pack_perception.tags.scenes import CELL, photograph, scattered

SCENES = 100
TAGS = {f"b{number}": number for number in range(9)}


@pytest.mark.benchmark
@pytest.mark.timeout(3600)
@pytest.mark.parametrize("shadows", [False, True])
def test_every_block_is_found_within_the_stated_errors(shadows: bool) -> None:
    vision, scenes = TagVision(TagVisionConfig(), CELL.block, TAGS), SCENES // (4 if shadows else 1)
    distances, turns = [], []
    with OverheadCamera(CELL, TAGS, timestep=0.001, shadows=shadows) as camera:
        for seed in range(scenes):
            poses = scattered(TAGS, seed)
            sighting = vision.find(photograph(camera, TAGS, poses), CELL.camera.pinhole, 0.0)
            assert sighting.is_complete, (seed, sighting.missing, sighting.doubled)
            distances += [1000 * sighting.poses[name].distance_to(pose) for name, pose in poses.items()]
            turns += [abs(np.rad2deg(turn_between(sighting.poses[name], poses[name]))) for name in poses]
    assert len(turns) == scenes * len(TAGS)
    assert np.max(distances) <= 0.3
    assert np.max(turns) <= 0.7
