"""What the cameras see is a matter of geometry."""

from __future__ import annotations

import mujoco
import numpy as np
import pytest

from pack_core.bodies import body_pose, set_object_poses
from pack_core.packing.cell import PackingCell, packing_cell
from pack_core.packing.markers import MarkerFrame
from pack_core.packing.model import ArmRole, HeldRole, build_model
from pack_core.packing.object_set import load_set
from pack_core.packing.objects import Cylinder
from pack_core.packing.scene import Scene
from pack_core.packing.scene_item import SceneItem
from pack_core.robots.panda import PANDA
from pack_core.rotations import Array, Pose
from pack_sim.packing.mocap import MocapConfig, MocapSystem

CELL = packing_cell()
HOME = np.array(CELL.robot.home)
RAISED = HOME + np.array([0.0, -0.5, 0.0, 0.0, 0.0, 0.0, 0.0])
CAN = Cylinder(name="can", shape="cylinder", radius=0.034, height=0.26, mass=0.4)
"""Stands 1 cm under the held object when the arm is at home."""
LOW = Cylinder(name="can", shape="cylinder", radius=0.03, height=0.04, mass=0.2)
OVERHEAD, BESIDE = (0.5, 0.0, 2.4), (1.5, 0.0, 0.35)


def scene_with(item: SceneItem) -> Scene:
    return CELL.scene.model_copy(update={"objects": [item]})


def cell_with(cameras: list[tuple[float, float, float]]) -> PackingCell:
    return CELL.model_copy(update={"mocap": CELL.mocap.model_copy(update={"cameras": cameras})})


def posed(
    scene: Scene, q: Array, held: HeldRole = HeldRole.RIGID, poses: dict[str, Pose] | None = None
) -> tuple[mujoco.MjModel, mujoco.MjData]:
    """The cell with the arm at `q` and the can in the middle of the container."""
    model = build_model(scene, CELL, timestep=0.001, arm=ArmRole.DRIVEN, held=held)
    data = mujoco.MjData(model)
    for name, angle in zip(PANDA.joints, q, strict=True):
        data.joint(name).qpos[0] = angle
    middle = Pose(np.array([0.5, 0.0, scene.objects[0].half_extents[2]]))
    set_object_poses(model, data, {scene.objects[0].name: middle, **(poses or {})})
    mujoco.mj_forward(model, data)
    return model, data


def frame_of(
    scene: Scene, q: Array, config: MocapConfig | None = None, cell: PackingCell = CELL
) -> MarkerFrame:
    mocap = MocapSystem(scene, cell, config or MocapConfig(), np.random.default_rng(0))
    return mocap.capture(*posed(scene, q), 0.0)


def markers_of(frame: MarkerFrame, name: str) -> set[int]:
    return set(frame.marker_index[frame.object_index == frame.objects.index(name)].tolist())


def test_an_object_under_the_held_object_is_not_seen_until_the_arm_rises() -> None:
    scene, top = scene_with(CAN), {0, 1, 2, 3}
    assert markers_of(frame_of(scene, HOME), "can").isdisjoint(top)
    assert markers_of(frame_of(scene, RAISED), "can") >= top


@pytest.mark.parametrize("item", load_set("household").objects, ids=lambda item: item.name)
def test_every_marker_of_every_shape_is_seen_while_nothing_is_in_the_way(item: SceneItem) -> None:
    """Beside the container none of an object's own surface hides a marker that is glued to it."""
    scene = scene_with(item)
    model, data = posed(scene, RAISED)
    set_object_poses(model, data, {item.name: Pose(np.array([0.5, 0.3, item.half_extents[2]]))})
    mujoco.mj_forward(model, data)
    frame = MocapSystem(scene, CELL, MocapConfig(), np.random.default_rng(0)).capture(model, data, 0.0)
    assert markers_of(frame, item.name) == set(range(6))


def test_the_held_object_is_tracked_on_the_cup_and_off_it_alike() -> None:
    scene = scene_with(CAN)
    held = scene.new_object.name
    model, data = posed(scene, HOME)
    free = posed(scene, HOME, HeldRole.FREE, {held: body_pose(data, held)})
    mocap = MocapSystem(scene, CELL, MocapConfig(), np.random.default_rng(0))
    p_WM = mocap.marker_positions(data)
    assert np.allclose(p_WM, mocap.marker_positions(free[1]))
    assert np.array_equal(mocap.visible_counts(model, data, p_WM), mocap.visible_counts(*free, p_WM))
    assert len(markers_of(frame_of(scene, HOME), held)) >= 3


def test_a_marker_that_one_camera_sees_is_not_published() -> None:
    scene, cell = scene_with(LOW), cell_with([OVERHEAD, BESIDE])
    one = frame_of(scene, RAISED, MocapConfig(min_cameras=1), cell)
    assert len(markers_of(one, "can")) >= 3
    assert np.all(one.cameras[one.object_index == 0] == 1)
    assert markers_of(frame_of(scene, RAISED, MocapConfig(min_cameras=2), cell), "can") == set()


def test_the_container_hides_what_is_behind_its_wall() -> None:
    scene, cell = scene_with(LOW), cell_with([BESIDE, BESIDE])
    mocap = MocapSystem(scene, cell, MocapConfig(), np.random.default_rng(0))
    behind, above = [0.62, 0.0, 0.05], [0.62, 0.0, 0.14]
    counts = mocap.visible_counts(*posed(scene, RAISED), np.array([behind, above]))
    assert counts.tolist() == [0, 2]


@pytest.mark.parametrize("obstacle", ["panda_link4", "panda_link6", "tool", CELL.scene.new_object.name])
def test_arm_pump_and_held_object_hide_what_is_behind_them(obstacle: str) -> None:
    scene = scene_with(LOW)
    model, data = posed(scene, HOME)
    geoms = np.flatnonzero(model.geom_bodyid == model.body(obstacle).id)
    p_WM, p_WG = np.array([0.52, 0.0, LOW.height + 0.004]), data.geom_xpos[geoms[0]]
    p_WC = p_WG + 0.8 * (p_WG - p_WM)
    cell = cell_with([(float(p_WC[0]), float(p_WC[1]), float(p_WC[2]))] * 2)
    mocap = MocapSystem(scene, cell, MocapConfig(), np.random.default_rng(0))
    counts = []
    for alpha in (1.0, 0.0):
        model.geom_rgba[:, 3] = 0.0
        model.geom_rgba[geoms, 3] = alpha
        counts.append(int(mocap.visible_counts(model, data, p_WM[None])[0]))
    assert counts == [0, 2]


def test_without_side_markers_only_tops_are_seen() -> None:
    scene = scene_with(LOW)
    bare = CELL.mocap.model_copy(update={"has_side_markers": False})
    mocap = MocapSystem(
        scene, CELL.model_copy(update={"mocap": bare}), MocapConfig(), np.random.default_rng(0)
    )
    model, data = posed(scene, RAISED)
    frame = mocap.capture(model, data, 0.0)
    assert markers_of(frame, "can") == markers_of(frame, scene.new_object.name) == {0, 1, 2, 3}
    np.testing.assert_allclose(frame.p_WM[:4, 2], LOW.height + 0.004, atol=0.002)
    assert markers_of(frame_of(scene, RAISED), "can") > {0, 1, 2, 3}


def test_a_point_outside_the_field_of_view_is_not_seen() -> None:
    scene = scene_with(LOW)
    mocap = MocapSystem(scene, CELL, MocapConfig(), np.random.default_rng(0))
    assert mocap.visible_counts(*posed(scene, RAISED), np.array([[6.0, 6.0, 0.1]])).tolist() == [0]


def test_noise_has_the_configured_size_and_is_centred() -> None:
    scene, config = scene_with(LOW), MocapConfig(noise_std=0.001)
    mocap = MocapSystem(scene, CELL, config, np.random.default_rng(3))
    model, data = posed(scene, RAISED)
    truth = mocap.marker_positions(data)
    frames = [mocap.capture(model, data, 0.0) for _ in range(300)]
    seen = truth[frames[0].marker_index + 6 * frames[0].object_index]
    errors = np.array([frame.p_WM - seen for frame in frames])
    assert errors.std() == pytest.approx(config.noise_std, rel=0.05)
    assert abs(errors.mean()) < 0.05 * config.noise_std


def test_the_same_seed_gives_the_same_frame() -> None:
    first, second = (frame_of(scene_with(LOW), HOME) for _ in range(2))
    assert np.array_equal(first.p_WM, second.p_WM)


def test_frames_come_at_the_rate_and_as_late_as_configured() -> None:
    config = MocapConfig(rate=120.0, latency=0.010)
    scene = scene_with(LOW)
    mocap = MocapSystem(scene, CELL, config, np.random.default_rng(0))
    model, data = posed(scene, RAISED)
    delays = []
    for step in range(1000):
        time = 0.001 * step
        mocap.update(model, data, time)
        delays += [time - frame.time for frame in mocap.due(time)]
    assert len(delays) in (118, 119, 120)
    assert np.allclose(delays, config.latency, atol=1e-9)
