"""What the packing page shows of depth cameras: images with outlines, and seen shapes beside true ones."""

from collections.abc import Iterator

import numpy as np
import pytest
from std_msgs.msg import String
from viser import ViserServer

from pack_core.joints import JointSample
from pack_core.packing import topics
from pack_core.packing.cell import packing_cell
from pack_core.packing.seen_deviations import SeenDeviations
from pack_core.robots.panda import PANDA
from pack_core.ros.messages.camera import to_depth_image
from pack_core.ros.messages.joints import to_joint_state
from pack_core.ros.messages.scene import to_scene
from pack_core.rotations import Pose
from pack_core.states import ObjectState, SceneState
from pack_viewer.news import News
from pack_viewer.packing.depth_panel import DARKEST, depths_of, picture_of, sizes_of
from pack_viewer.packing.packing_scene import BOTH, TRUTH, PackingScene
from pack_viewer.web_server import open_server

CELL = packing_cell()
TOLD = CELL.scene
BOX = TOLD.objects[2]
SEEN = TOLD.model_copy(update={"objects": [BOX.model_copy(update={"name": "seen_1"})]})
HERE, THERE = (Pose(np.array([0.5, y, BOX.half_extents[2]])) for y in (0.02, -0.03))
CAMERA = CELL.depth.cameras()[0]


def test_the_outline_is_around_the_object_and_nothing_measured_is_black() -> None:
    depth = np.full((CAMERA.height, CAMERA.width), 0.9)
    depth[:, :50] = 0.0
    picture = picture_of(depth, CAMERA, SEEN, {"seen_1": HERE})
    assert not picture[:, :50].any()
    outlined = np.argwhere((picture != DARKEST).any(axis=-1) & (depth > 0.0))[:, ::-1]
    corners = CAMERA.project(HERE.apply(BOX.hull()))
    assert outlined.min(axis=0) == pytest.approx(corners.min(axis=0), abs=1.0)
    assert outlined.max(axis=0) == pytest.approx(corners.max(axis=0), abs=1.0)


def test_depths_are_read_from_whole_images_alone() -> None:
    message = to_depth_image(1.0, np.full((4, 6), 0.25), "depth_1")
    assert depths_of(message) == pytest.approx(np.full((4, 6), 0.25))
    message.height = 5
    assert depths_of(message) is None


def test_sizes_stand_with_their_deviations_once_a_look_has_told_them() -> None:
    known = SeenDeviations(position=(0.001, 0.002, 0.0005), size=(0.002, 0.004, 0.001), yaw=0.01)
    sizes = sizes_of(SEEN, {"seen_1": known})
    assert "90 ± 2.0 x 60 ± 4.0 x 130 ± 1.0 mm, place ± 2.0 mm, ± 0.6°" in sizes
    assert sizes_of(SEEN, {}) == ""


@pytest.fixture
def server() -> Iterator[ViserServer]:
    opened = open_server(0, "seen")
    yield opened
    opened.stop()


def test_seen_shapes_are_drawn_or_true_ones_or_both(server: ViserServer) -> None:
    scene = PackingScene(server.scene)
    joints = JointSample(1.0, *np.zeros((3, 7)))
    poses = {topics.SCENE: {"seen_1": HERE}, topics.TRUTH: {BOX.name: THERE}}
    messages = {
        topic: [to_scene(SceneState(1.0, {name: ObjectState(X) for name, X in found.items()}))]
        for topic, found in poses.items()
    }
    messages |= {
        topics.DESCRIPTION: [String(data=SEEN.to_yaml())],
        topics.SIM_DESCRIPTION: [String(data=TOLD.to_yaml())],
        topics.JOINT_STATES: [to_joint_state(joints, PANDA.joints)],
    }
    scene.update(News(messages, 1.0))
    assert scene.drawn is not None
    assert scene.drawn.body("seen_1").position == pytest.approx(HERE.p)
    scene.draw_from(TRUTH)
    scene.update(News({}, 1.1))
    assert scene.drawn.body(BOX.name).position == pytest.approx(THERE.p)
    scene.draw_from(BOTH)
    scene.update(News({}, 1.2))
    assert scene.drawn.body("seen_1").position == pytest.approx(HERE.p)
    assert scene.true is not None
    assert scene.true.body(BOX.name).position == pytest.approx(THERE.p)
