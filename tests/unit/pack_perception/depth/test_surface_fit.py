import numpy as np
import pytest

from pack_core.packing.cell import packing_cell
from pack_core.packing.objects import Box, Cylinder, ObjectModel
from pack_core.rotations import Array, Pose, angle_between, exp, from_yaw, multiply
from pack_perception.depth.shape_fit import FittedShape
from pack_perception.depth.surface_fit import (
    ConvexSurface,
    assigned,
    fit_surface,
    still_there,
    which_is_where,
)
from pack_perception.perception_config import SurfaceFitConfig

CONFIG = SurfaceFitConfig()
BOX = Box(name="box", mass=0.3, shape="box", size=(0.09, 0.06, 0.13))
CAN = Cylinder(name="can", mass=0.3, shape="cylinder", radius=0.034, height=0.11)


def surface_points(item: ObjectModel, X_WO: Pose, rng: np.random.Generator, count: int = 400) -> Array:
    """Points `(count, 3)` [m] of an upright object's top and of the sides towards x and y."""
    ways = np.abs(rng.normal(size=(count, 3)))
    surface = ConvexSurface.of(item)
    rates = ways @ surface.normals.T
    lengths = np.where(rates > 1e-9, surface.offsets / np.maximum(rates, 1e-9), np.inf).min(axis=1)
    return np.asarray(X_WO.apply(ways * lengths[:, None]))


def row(X_WO: Pose) -> Array:
    return np.concatenate([X_WO.p, X_WO.q])


def test_distances_from_a_box_are_those_of_its_faces() -> None:
    surface = ConvexSurface.of(BOX)
    assert len(surface.offsets) == 6
    distances, _ = surface.distances(np.array([[0.05, 0.0, 0.0], [0.0, 0.0, 0.0], [0.0, 0.0, 0.07]]))
    assert distances == pytest.approx([0.005, -0.03, 0.005])


def test_a_shifted_and_turned_box_is_found_again() -> None:
    rng = np.random.default_rng(1)
    true = Pose(np.array([0.5, 0.02, 0.065]), from_yaw(0.3))
    points = surface_points(BOX, true, rng) + rng.normal(0.0, 0.0005, (400, 3))
    expected = Pose(true.p + np.array([0.003, -0.004, 0.0]), multiply(exp([0.0, 0.0, 0.05]), true.q))
    found = fit_surface(ConvexSurface.of(BOX), points, row(expected), CONFIG)
    assert found[:3] == pytest.approx(true.p, abs=0.0007)
    assert angle_between(found[3:], true.q) < np.deg2rad(0.6)


def test_points_that_belong_to_something_else_hardly_count() -> None:
    rng = np.random.default_rng(2)
    true = Pose(np.array([0.5, 0.02, 0.065]), from_yaw(0.3))
    others = surface_points(BOX, true, rng, 60) + np.array([0.01, 0.0, 0.0])
    points = np.vstack([surface_points(BOX, true, rng), others])
    found = fit_surface(ConvexSurface.of(BOX), points, row(true), CONFIG)
    assert found[:3] == pytest.approx(true.p, abs=0.0007)


def test_bodies_side_by_side_are_still_there_until_a_surface_is_seen_within_them() -> None:
    rng, surface = np.random.default_rng(3), ConvexSurface.of(BOX)
    left, right = (Pose(np.array([x, 0.0, 0.065])) for x in (0.5, 0.5 + BOX.size[0]))
    can = Pose(np.array([0.5, 0.1, 0.055]))
    of_left, of_can = surface_points(BOX, left, rng), surface_points(CAN, can, rng)
    poses = np.stack([row(left), row(right)])
    # nothing is seen of the right one, which says nothing against it
    there, rest = still_there(np.vstack([of_left, of_can]), [surface, surface], poses, CONFIG.reach)
    assert there.tolist() == [True, True]
    assert rest == pytest.approx(of_can)
    behind = right.apply(rng.uniform(-0.01, 0.01, (50, 3)))
    there, rest = still_there(np.vstack([of_left, behind]), [surface, surface], poses, CONFIG.reach)
    assert there.tolist() == [True, False]
    assert rest == pytest.approx(behind)


def test_what_the_points_leave_open_stays_as_expected() -> None:
    true = Pose(np.array([0.5, 0.0, 0.055]), from_yaw(0.4))
    points = surface_points(CAN, true, np.random.default_rng(3))
    found = fit_surface(ConvexSurface.of(CAN), points, row(true), CONFIG)
    # a cylinder's yaw
    assert angle_between(found[3:], true.q) < np.deg2rad(0.5)


def test_a_point_belongs_to_the_nearer_body_or_to_none() -> None:
    poses = np.stack([row(Pose(np.array([0.4, 0.0, 0.055]))), row(Pose(np.array([0.48, 0.0, 0.055])))])
    points = np.array([[0.4, 0.0, 0.111], [0.48, 0.0, 0.109], [0.4, 0.0, 0.2]])
    first, second = assigned(points, [ConvexSurface.of(CAN)] * 2, poses, 0.012)
    assert first == pytest.approx(points[:1])
    assert second == pytest.approx(points[1:2])


def test_each_described_shape_is_found_where_it_stands() -> None:
    rng = np.random.default_rng(4)
    scene = packing_cell().scene
    poses = {
        item.name: Pose(np.array([0.4 + 0.1 * i, 0.0, item.half_extents[2]]), from_yaw(0.5 * i))
        for i, item in enumerate(scene.objects)
    }
    found = [
        FittedShape(item, poses[item.name], 1.0, surface_points(item, poses[item.name], rng))
        for item in reversed(scene.objects)
    ]
    where = which_is_where(found, scene.objects, CONFIG)
    assert where.keys() == poses.keys()
    for name, X_WO in where.items():
        assert X_WO.p == pytest.approx(poses[name].p, abs=0.0005)


def test_a_shape_that_is_nowhere_is_not_found() -> None:
    X_WO = Pose(np.array([0.5, 0.0, 0.055]))
    seen = FittedShape(CAN, X_WO, 1.0, surface_points(CAN, X_WO, np.random.default_rng(5)))
    tall = BOX.model_copy(update={"size": (0.06, 0.06, 0.18)})
    assert which_is_where([seen], [tall], CONFIG) == {}
