"""Sampled poses stand on the base, between the walls, turned no further than needed."""

import numpy as np
import pytest

from pack_core.errors import PackError
from pack_core.packing.free_space import base_height, footprint, is_inside
from pack_core.packing.objects import Box, Cylinder
from pack_core.packing.scene import Container
from pack_core.rotations import Pose, from_yaw, yaw_of
from pack_planner.placement.placement_evaluation import sample_near, sample_poses

CONTAINER = Container(size=(0.27, 0.22), height=0.12)
SQUARE = Box(name="square", shape="box", size=(0.065, 0.065, 0.18), mass=0.5)
LONG = Box(name="long", shape="box", size=(0.25, 0.05, 0.10), mass=0.5)
CAN = Cylinder(name="can", shape="cylinder", radius=0.04, height=0.11, mass=0.5)


def poses_of(item: Box | Cylinder, yaw: float = 0.0, n: int = 400) -> list[Pose]:
    rows = sample_poses(item, CONTAINER, n, yaw, np.random.default_rng(3))
    return [Pose(row[:3], row[3:]) for row in rows]


@pytest.mark.parametrize("item", [SQUARE, LONG, CAN], ids=lambda item: item.name)
def test_samples_stand_on_the_base_between_the_walls(item: Box | Cylinder) -> None:
    for X_WO in poses_of(item):
        assert base_height(item, X_WO) == pytest.approx(0.0, abs=1e-12)
        assert is_inside(footprint(item, X_WO), CONTAINER, 1e-9)


def test_samples_reach_every_wall() -> None:
    bounds = np.array([footprint(SQUARE, X_WO).bounds for X_WO in poses_of(SQUARE)])
    np.testing.assert_allclose(bounds[:, :2].min(axis=0), CONTAINER.lower, atol=0.005)
    np.testing.assert_allclose(bounds[:, 2:].max(axis=0), CONTAINER.upper, atol=0.005)


@pytest.mark.parametrize(("item", "most"), [(CAN, 0.0), (SQUARE, np.pi / 4), (LONG, np.pi / 2)])
def test_no_sample_turns_further_than_symmetry_needs(item: Box | Cylinder, most: float) -> None:
    start = 0.4
    turns = [yaw_of((Pose(np.zeros(3), from_yaw(-start)) @ X_WO).q) for X_WO in poses_of(item, start)]
    assert np.abs(turns).max() <= most + 1e-9
    assert np.ptp(turns) >= most * 0.9


@pytest.mark.parametrize(
    ("size", "message"),
    [
        ((0.30, 0.30, 0.10), r"'giant' is 0\.300 x 0\.300 m wide, the container 0\.270 x 0\.220"),
        ((0.05, 0.05, 0.24), r"'giant' is 0\.240 m tall.*less than 0\.240 m"),
    ],
)
def test_items_wider_or_taller_than_the_container_takes_are_refused(
    size: tuple[float, float, float], message: str
) -> None:
    with pytest.raises(PackError, match=message):
        poses_of(Box(name="giant", shape="box", size=size, mass=0.5))


@pytest.mark.parametrize("item", [SQUARE, LONG, CAN], ids=lambda item: item.name)
def test_poses_near_one_stand_between_the_walls_even_in_a_corner(item: Box | Cylinder) -> None:
    corner = Pose(np.array([*CONTAINER.upper, item.half_extents[2]]))
    for row in sample_near(corner, item, CONTAINER, 200, (0.02, 0.01), np.random.default_rng(5)):
        X_WO = Pose(row[:3], row[3:])
        assert base_height(item, X_WO) == pytest.approx(0.0, abs=1e-12)
        assert is_inside(footprint(item, X_WO), CONTAINER, 1e-9)


def test_poses_near_one_scatter_as_far_as_they_are_told() -> None:
    middle = Pose(np.array([*CONTAINER.centre, 0.09]), from_yaw(0.3))
    rows = sample_near(middle, SQUARE, CONTAINER, 4000, (0.006, 0.1), np.random.default_rng(5))
    yaws = [yaw_of(q) for q in rows[:, 3:]]
    np.testing.assert_allclose(rows[:, :2].mean(axis=0), middle.p[:2], atol=5e-4)
    np.testing.assert_allclose([*rows[:, :2].std(axis=0), np.std(yaws)], [0.006, 0.006, 0.1], rtol=0.06)
    assert np.mean(yaws) == pytest.approx(0.3, abs=0.01)
