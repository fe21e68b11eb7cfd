from collections.abc import Iterator

import cv2
import numpy as np
import pytest

from pack_core.blocks.planar import PlanarPose, turn_between
from pack_core.blocks.problem import CUBE, BlockSize
from pack_perception.tags.tag_vision import TagVision, TagVisionConfig
from pack_sim.blocks.overhead_camera import OverheadCamera
from pack_sim.blocks.simulator import BlocksSimulator
from unit.pack_perception.tags.scenes import CELL, photograph, scattered

TAGS = {f"b{number}": number for number in range(9)}
CAMERA = CELL.camera.pinhole
SCENES = 4


@pytest.fixture(scope="module")
def camera() -> Iterator[OverheadCamera]:
    with OverheadCamera(CELL, TAGS, timestep=0.001) as opened:
        yield opened


@pytest.fixture
def vision() -> TagVision:
    return TagVision(TagVisionConfig(), CELL.block, TAGS)


def test_every_block_of_random_scenes_is_found_within_the_stated_errors(
    camera: OverheadCamera, vision: TagVision
) -> None:
    for seed in range(SCENES):
        poses = scattered(TAGS, seed)
        sighting = vision.find(photograph(camera, TAGS, poses), CAMERA, 0.0)
        assert sighting.is_complete
        for name, pose in poses.items():
            assert sighting.poses[name].distance_to(pose) < 0.3e-3
            assert abs(np.rad2deg(turn_between(sighting.poses[name], pose))) < 0.7


def test_noise_and_blur_hide_no_block(camera: OverheadCamera, vision: TagVision) -> None:
    poses, rng = scattered(TAGS, 1), np.random.default_rng(1)
    blurred = cv2.GaussianBlur(photograph(camera, TAGS, poses), (0, 0), 1.0).astype(float)
    noisy = np.clip(blurred + rng.normal(0.0, 6.0, blurred.shape), 0, 255).astype(np.uint8)
    sighting = vision.find(noisy, CAMERA, 0.0)
    assert sighting.is_complete
    for name, pose in poses.items():
        assert sighting.poses[name].distance_to(pose) < 0.5e-3


def test_a_covered_tag_is_reported_missing(camera: OverheadCamera, vision: TagVision) -> None:
    poses = scattered(TAGS, 2)
    picture = photograph(camera, TAGS, poses).copy()
    u, v = CAMERA.project([*poses["b4"].p, CELL.block.edge]).round().astype(int)
    picture[v - 12 : v + 12, u - 12 : u + 12] = 90
    sighting = vision.find(picture, CAMERA, 3.0)
    assert sighting.missing == ("b4",)
    assert set(sighting.poses) == set(TAGS) - {"b4"}
    assert sighting.time == 3.0


def test_a_tag_that_is_there_twice_is_reported_and_its_pose_not_told(vision: TagVision) -> None:
    twins = {"one": 3, "other": 4}
    with OverheadCamera(CELL, {"one": 3, "other": 3}, timestep=0.001) as camera:
        poses = {"one": PlanarPose(0.6, 0.1, 0.3), "other": PlanarPose(0.7, -0.1, 1.0)}
        picture = photograph(camera, {"one": 3, "other": 3}, poses)
    sighting = TagVision(TagVisionConfig(), CELL.block, twins).find(picture, CAMERA, 0.0)
    assert sighting.doubled == ("one",)
    assert sighting.missing == ("other",)
    assert not sighting.poses


def test_a_tag_of_no_block_is_reported(camera: OverheadCamera) -> None:
    known = {name: number for name, number in TAGS.items() if name != "b7"}
    picture = photograph(camera, TAGS, scattered(TAGS, 3))
    sighting = TagVision(TagVisionConfig(), CELL.block, known).find(picture, CAMERA, 0.0)
    assert sighting.unknown == (7,)
    assert sighting.is_complete


def test_a_tag_at_another_height_is_taken_for_no_block(camera: OverheadCamera, vision: TagVision) -> None:
    picture = photograph(camera, TAGS, scattered(TAGS, 4))
    nearer = CELL.model_copy(
        update={"camera": CELL.camera.model_copy(update={"position": (0.65, 0.0, 1.3)})}
    ).camera.pinhole
    assert len(vision.find(picture, nearer, 0.0).missing) == len(TAGS)


def test_an_empty_picture_misses_every_block(vision: TagVision) -> None:
    sighting = vision.find(np.zeros((1080, 1920, 3), np.uint8), CAMERA, 0.0)
    assert sighting.missing == tuple(TAGS)


def test_a_block_that_nobody_knows_is_told_with_its_pose(camera: OverheadCamera) -> None:
    known = {name: number for name, number in TAGS.items() if number != 7}
    poses = scattered(TAGS, 0)
    sighting = TagVision(TagVisionConfig(), CELL.block, known).find(
        photograph(camera, TAGS, poses), CAMERA, 0.0
    )
    assert sighting.is_complete
    assert sighting.unknown == (7,)
    assert sighting.poses["tag 7"].distance_to(poses["b7"]) < 0.3e-3


def test_blocks_of_other_sizes_are_found_by_tags_that_fit_their_tops() -> None:
    """Of several heights and oblong: tags are square on every top, and each lies at its block's height."""
    sizes = {"b0": BlockSize(0.04, 0.06, 0.045), "b1": BlockSize(0.072, 0.04, 0.06), "b2": CUBE}
    tags = {name: number for number, name in enumerate(sizes)}
    poses = {
        "b0": PlanarPose(0.55, 0.1, 0.4), "b1": PlanarPose(0.7, -0.1, -1.2), "b2": PlanarPose(0.6, 0.0, 2.0),
    }  # fmt: skip
    vision = TagVision(TagVisionConfig(), CELL.block, tags, sizes)
    with OverheadCamera(CELL, tags, timestep=0.001, sizes=sizes) as camera:
        snapshot = BlocksSimulator(CELL, tags, poses, sizes=sizes).snapshot()
        sighting = vision.find(camera.picture(snapshot), CAMERA, 0.0)
    assert sighting.is_complete
    for name, pose in poses.items():
        assert sighting.poses[name].distance_to(pose) < 0.4e-3
        assert abs(np.rad2deg(turn_between(sighting.poses[name], pose))) < 0.9
