"""Points of the upper surfaces of known bodies, seen without errors, and what a look makes of them."""

from collections.abc import Callable, Sequence

import mujoco
import numpy as np
import pytest

from pack_core.bodies import set_object_poses
from pack_core.packing.cell import packing_cell
from pack_core.packing.depth import points_of
from pack_core.packing.free_space import footprint
from pack_core.packing.model import ArmRole, HeldRole, build_model
from pack_core.packing.object_set import load_set
from pack_core.packing.objects import Box, Capsule, Cylinder, ObjectModel
from pack_core.rotations import Array, Pose, from_yaw, yaw_of
from pack_perception.depth.height_map import Mask, halves, height_map, regions
from pack_perception.depth.look import SeenShape, look_at, off_container
from pack_perception.depth.seen_region import overlap
from pack_perception.depth.sight_lines import SightLines
from pack_perception.perception_config import DepthLookConfig, HeightMapConfig
from pack_sim.packing.camera_rays import CameraRays

CELL = packing_cell()
CONTAINER = CELL.scene.container
CONFIG = DepthLookConfig()
BOX = Box(name="box", mass=0.3, shape="box", size=(0.09, 0.06, 0.11))
CAN = Cylinder(name="can", mass=0.3, shape="cylinder", radius=0.034, height=0.11)
BLIND = SightLines(CELL.depth.cameras(), np.zeros((2, CELL.depth.height, CELL.depth.width)), CONFIG.behind)
ROLL = Capsule(name="roll", mass=0.1, shape="capsule", radius=0.02, length=0.12, axis="x")


def seen(items: Sequence[ObjectModel], places: Sequence[tuple[float, float, float]]) -> SightLines:
    """What the cameras measure of objects at x, y and yaw, with errors of a micrometre.

    Without any, points of the walls' inner faces would fall inside or outside in rows, as they are rounded.
    """
    scene = CELL.scene.model_copy(update={"objects": list(items)})
    model = build_model(scene, CELL, timestep=0.001, arm=ArmRole.ABSENT, held=HeldRole.ABSENT)
    data = mujoco.MjData(model)
    poses = {
        item.name: Pose(np.array([x, y, item.half_extents[2]]), from_yaw(yaw))
        for item, (x, y, yaw) in zip(items, places, strict=True)
    }
    set_object_poses(model, data, poses)
    mujoco.mj_forward(model, data)
    cameras = CELL.depth.cameras()
    images = np.stack([CameraRays(camera).cast(model, data).depth for camera in cameras])
    images *= 1.0 + 1e-6 * np.random.default_rng(0).standard_normal(images.shape)
    return SightLines(cameras, images, CONFIG.behind)


def points_in(sight: SightLines) -> Array:
    """All points that were measured `(n, 3)` [m]."""
    return np.concatenate([points_of(c, i) for c, i in zip(sight.cameras, sight.images, strict=True)])


def look_without(hidden: Callable[[Array], Mask], sight: SightLines) -> list[SeenShape]:
    """What a look finds where the pixels of some points are lost, from left to right."""
    images = sight.images.copy()
    for camera, image in zip(sight.cameras, images, strict=True):
        image[image > 0.0] *= ~hidden(points_of(camera, image))
    rest = SightLines(sight.cameras, images, CONFIG.behind)
    return sorted(look_at(points_in(rest), rest, CONTAINER, CONFIG), key=lambda fit: fit.X_WO.p[0])


def look(items: Sequence[ObjectModel], places: Sequence[tuple[float, float, float]]) -> list[SeenShape]:
    return look_without(lambda points: np.zeros(len(points), dtype=bool), seen(items, places))


@pytest.mark.parametrize("yaw", [0.0, 0.4, 1.2])
def test_a_box_is_found_with_its_size_and_heading(yaw: float) -> None:
    (fit,) = look([BOX], [(0.5, 0.01, yaw)])
    assert isinstance(fit.item, Box)
    assert sorted(fit.item.size[:2]) == pytest.approx([0.06, 0.09], abs=0.002)
    assert fit.item.size[2] == pytest.approx(0.11, abs=0.0005)
    assert fit.X_WO.p == pytest.approx([0.5, 0.01, 0.055], abs=0.001)
    assert np.sin(2.0 * (yaw_of(fit.X_WO.q) - yaw)) == pytest.approx(0.0, abs=0.04)


def test_a_cylinder_is_found_with_its_radius() -> None:
    (fit,) = look([CAN], [(0.47, -0.03, 0.0)])
    assert isinstance(fit.item, Cylinder)
    assert fit.item.radius == pytest.approx(0.034, abs=0.0015)
    assert fit.X_WO.p == pytest.approx([0.47, -0.03, 0.055], abs=0.001)


def test_a_lying_capsule_is_found_with_its_length() -> None:
    (fit,) = look([ROLL], [(0.52, 0.02, 0.7)])
    assert isinstance(fit.item, Capsule)
    assert (fit.item.radius, fit.item.length) == pytest.approx((0.02, 0.12), abs=0.003)
    assert np.sin(yaw_of(fit.X_WO.q) - 0.7) == pytest.approx(0.0, abs=0.03)


def test_of_a_cylinder_whose_half_is_hidden_the_rest_tells_the_radius() -> None:
    sight = seen([CAN], [(0.5, 0.0, 0.0)])
    (fit,) = look_without(lambda points: (points[:, 1] < 0.002) & (points[:, 2] > 0.004), sight)
    assert isinstance(fit.item, Cylinder)
    assert fit.item.radius == pytest.approx(0.034, abs=0.003)
    assert fit.X_WO.p[:2] == pytest.approx([0.5, 0.0], abs=0.003)


def test_a_capsule_goes_on_behind_what_hides_a_part_of_it() -> None:
    sight = seen([ROLL], [(0.5, 0.0, 0.0)])
    (fit,) = look_without(lambda points: (points[:, 0] > 0.505) & (points[:, 0] < 0.525), sight)
    assert isinstance(fit.item, Capsule)
    assert fit.item.length == pytest.approx(0.12, abs=0.006)
    assert fit.X_WO.p[:2] == pytest.approx([0.5, 0.0], abs=0.003)


def test_a_capsule_that_something_hides_obliquely_is_one_object() -> None:
    sight = seen([ROLL], [(0.5, 0.0, 0.5)])
    across = np.array([1.0, 3.0]) / np.hypot(1.0, 3.0)
    (fit,) = look_without(lambda points: np.abs((points[:, :2] - [0.5, 0.0]) @ across) < 0.003, sight)
    assert isinstance(fit.item, Capsule)
    assert (fit.item.radius, fit.item.length) == pytest.approx((0.02, 0.12), abs=0.003)


def test_an_end_that_nobody_saw_is_where_the_shortest_capsule_has_it() -> None:
    sight = seen([ROLL], [(0.5, 0.0, 0.0)])
    (fit,) = look_without(lambda points: points[:, 0] > 0.52, sight)
    assert isinstance(fit.item, Capsule)
    assert fit.item.length == pytest.approx(0.08 + 0.02, abs=0.006)


def test_a_bottle_is_as_wide_as_below_its_cap() -> None:
    bottle = household("bottle_250")
    (fit,) = look([bottle], [(0.5, 0.0, 0.0)])
    assert fit.item.half_extents == pytest.approx(bottle.half_extents, abs=0.003)
    assert fit.X_WO.p == pytest.approx([0.5, 0.0, bottle.half_extents[2]], abs=0.003)


def test_a_camera_sees_through_what_is_free_alone() -> None:
    sight = seen([BOX], [(0.5, 0.0, 0.0)])
    above, within, on_base = np.array([[0.5, 0.0, 0.14], [0.5, 0.0, 0.05], [0.6, 0.05, 0.0]])
    assert sight.is_free(np.stack([above, within, on_base])).tolist() == [True, False, False]
    assert sight.sees(above, np.array([0.0, 0.0, 1.0]))
    assert not sight.sees(above, np.array([0.0, 0.0, -1.0]))


HOUSEHOLD = load_set("household")


def household(name: str) -> ObjectModel:
    return next(item for item in HOUSEHOLD.objects if item.name == name)


@pytest.mark.parametrize("name", ["pear", "apple", "mustard_bottle"])
def test_what_is_steep_is_found_to_its_widest_place(name: str) -> None:
    item = household(name)
    (fit,) = look([item], [(0.5, 0.0, 0.3)])
    assert fit.X_WO.p == pytest.approx([0.5, 0.0, item.half_extents[2]], abs=0.004)
    outline, true = footprint(fit.item, fit.X_WO), footprint(item, Pose(fit.X_WO.p, from_yaw(0.3)))
    assert outline.intersection(true).area / outline.union(true).area > 0.85


@pytest.mark.parametrize("name", ["pear", "mustard_bottle"])
def test_what_nobody_saw_of_a_body_lets_it_stand(name: str) -> None:
    (fit,) = look([household(name)], [(0.5, 0.0, 0.3)])
    hull = fit.item.hull()
    base = hull[hull[:, 2] < -fit.item.half_extents[2] + 1e-6, :2]
    # its centre of mass is over the middle half of its base
    assert np.all(np.abs(fit.item.centre_of_mass[:2]) < 0.5 * np.abs(base).max(axis=0))
    assert np.all(np.ptp(base, axis=0) > 0.45 * np.ptp(hull[:, :2], axis=0))


def test_of_a_round_body_one_side_says_how_it_goes_on() -> None:
    pear = household("pear")
    sight = seen([pear], [(0.5, 0.0, 0.0)])
    (fit,) = look_without(lambda points: (points[:, 1] < -0.008) & (points[:, 2] > 0.01), sight)
    assert fit.X_WO.p[:2] == pytest.approx([0.5, 0.0], abs=0.003)
    assert fit.item.half_extents[:2] == pytest.approx(pear.half_extents[:2], abs=0.003)


def test_a_flat_top_that_a_gap_cuts_is_one_object() -> None:
    sight = seen([BOX], [(0.5, 0.0, 0.0)])
    (fit,) = look_without(lambda points: (np.abs(points[:, 0] - 0.49) < 0.003) & (points[:, 2] > 0.02), sight)
    assert isinstance(fit.item, Box)
    assert sorted(fit.item.size[:2]) == pytest.approx([0.06, 0.09], abs=0.003)


def test_a_piece_that_something_cuts_off_a_top_belongs_to_it_however_small() -> None:
    sight = seen([BOX], [(0.5, 0.0, 0.0)])
    (fit,) = look_without(
        lambda points: (np.abs(points[:, 0] - 0.532) < 0.003) & (points[:, 2] > 0.02), sight
    )
    assert isinstance(fit.item, Box)
    assert sorted(fit.item.size[:2]) == pytest.approx([0.06, 0.09], abs=0.003)


def test_objects_of_one_height_that_touch_are_two() -> None:
    left, right = look([CAN, BOX], [(0.42, 0.0, 0.0), (0.42 + 0.034 + 0.0455, 0.0, 0.0)])
    assert isinstance(left.item, Cylinder)
    assert isinstance(right.item, Box)
    assert left.X_WO.p[:2] == pytest.approx([0.42, 0.0], abs=0.003)


def test_a_box_around_a_can_has_corners_that_are_seen_through_beside_its_top() -> None:
    sight = seen([CAN], [(0.5, 0.0, 0.0)])
    # of what is around it on the base nothing is measured, so that half way up nobody knows
    near = [
        np.linalg.norm(points_of(c, i)[:, :2] - [0.5, 0.0], axis=1)
        for c, i in zip(sight.cameras, sight.images, strict=True)
    ]
    for image, ways in zip(sight.images, near, strict=True):
        image[image > 0.0] *= (ways > 0.075) | (ways < 0.036)
    heights = height_map(points_in(sight), sight, CONTAINER, CONFIG.heights)
    (mask,) = regions(heights, CONFIG.heights)
    X_WO = Pose(np.array([0.5, 0.0, 0.055]))
    box = Box(name="box", mass=0.3, shape="box", size=(0.068, 0.068, 0.11))
    assert overlap([(CAN, X_WO)], mask, heights) > 0.98
    assert overlap([(box, X_WO)], mask, heights) < 0.93


def test_masses_follow_from_volumes() -> None:
    (fit,) = look([BOX], [(0.5, 0.0, 0.0)])
    assert isinstance(fit.item, Box)
    assert fit.item.mass == pytest.approx(CONFIG.shapes.density * np.prod(fit.item.size))


def test_an_empty_container_has_no_objects() -> None:
    assert look([], []) == []


def test_a_single_point_over_a_cell_does_not_raise_its_top() -> None:
    grid = np.stack(np.meshgrid(*[np.arange(0.4, 0.6, 0.001)] * 2), axis=-1).reshape(-1, 2) - [0.0, 0.5]
    flat = np.column_stack([grid, np.full(len(grid), 0.05)])
    heights = height_map(np.vstack([flat, [[0.5, 0.0, 0.15]]]), BLIND, CONTAINER, HeightMapConfig())
    assert np.nanmax(heights.tops) == pytest.approx(0.05)


def test_a_region_ends_where_the_height_jumps() -> None:
    config = HeightMapConfig()
    grid = np.stack(np.meshgrid(*[np.arange(0.4, 0.6, 0.001)] * 2), axis=-1).reshape(-1, 2) - [0.0, 0.5]
    steps = np.column_stack([grid, np.where(grid[:, 0] < 0.5, 0.05, 0.06)])
    found = regions(height_map(steps, BLIND, CONTAINER, config), config)
    assert len(found) == 2
    assert not np.any(found[0] & found[1])


def test_tops_of_other_heights_that_cells_join_are_regions_of_their_own() -> None:
    config = HeightMapConfig()
    grid = np.stack(np.meshgrid(*[np.arange(0.4, 0.6, 0.001)] * 2), axis=-1).reshape(-1, 2) - [0.0, 0.5]
    x, y = grid.T
    # a ramp over a quarter of the edge, so flat that no cell jumps
    z = np.where(
        np.abs(y) < 0.03, np.clip(0.055 + (x - 0.5) / 1.5, 0.05, 0.06), np.where(x < 0.5, 0.05, 0.06)
    )
    found = regions(height_map(np.column_stack([grid, z]), BLIND, CONTAINER, config), config)
    assert len(found) == 2
    assert not np.any(found[0] & found[1])


def test_two_boxes_that_make_one_box_are_one() -> None:
    halves_of_box = [BOX.model_copy(update={"name": name, "size": (0.045, 0.06, 0.11)}) for name in "ab"]
    (fit,) = look(halves_of_box, [(0.4775, 0.0, 0.0), (0.5225, 0.0, 0.0)])
    assert isinstance(fit.item, Box)


def test_points_on_base_and_walls_are_left_out() -> None:
    (x, y), inner = CONTAINER.centre, CONTAINER.upper[0]
    on_base, on_wall, content = [x, y, 0.001], [inner + 0.004, y, 0.05], [x, y, 0.05]
    over_wall, outside = [inner + 0.004, y, CONTAINER.height + 0.02], [inner + 0.1, y, 0.05]
    points = np.array([on_base, on_wall, content, over_wall, outside])
    assert off_container(points, CONTAINER, CONFIG.on_wall).tolist() == [content, over_wall, outside]


def test_a_convex_region_is_not_halved() -> None:
    mask = np.zeros((40, 40), dtype=bool)
    mask[5:30, 8:25] = True
    assert halves(mask, 2.0) == []


def test_every_cell_goes_to_a_side_of_the_cut() -> None:
    mask = np.zeros((60, 24), dtype=bool)
    for first in (2, 21, 40):
        mask[first : first + 16, 2:20] = True
    mask[2:56, 8:13] = True  # three squares in a row, joined by bridges of five cells
    one, other = halves(mask, 2.0)
    assert np.array_equal(one | other, mask)
    assert min(one.sum(), other.sum()) > 0.25 * mask.sum()


def test_a_region_that_touches_itself_in_one_cell_is_not_halved() -> None:
    mask = np.zeros((40, 40), dtype=bool)
    mask[5:20, 5:20] = mask[20:32, 20:32] = True
    mask[3, 5:12] = mask[4, 8] = mask[33:36, 31] = True
    assert halves(mask, 1.0) == []


def test_of_a_few_points_nothing_is_made() -> None:
    rng = np.random.default_rng(0)
    line = np.column_stack([rng.uniform(0.45, 0.55, 20), np.zeros(20), np.full(20, 0.05)])
    assert look_at(line, BLIND, CONTAINER, CONFIG) == []


def test_an_end_that_nobody_saw_is_told_to_be_less_sure() -> None:
    sight = seen([BOX], [(0.5, 0.0, 0.0)])
    (whole,) = look_without(lambda points: np.zeros(len(points), dtype=bool), sight)
    (cut,) = look_without(lambda points: points[:, 0] > 0.53, sight)
    length, width, height = whole.deviations.size
    assert (length, width) == pytest.approx((np.sqrt(2.0) * CONFIG.spreads.box.end,) * 2, abs=0.0005)
    assert height == CONFIG.spreads.box.height
    # it ends at the wall at the latest, 0.105 m behind where it was seen to; sight lines end it before
    assert 4.0 * length < cut.deviations.size[0] < CONFIG.open_end * 0.105
    assert cut.deviations.position[0] == pytest.approx(0.5 * cut.deviations.size[0])
    assert cut.deviations.size[1] == pytest.approx(width, abs=0.0005)
