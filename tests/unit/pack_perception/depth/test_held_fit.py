"""What hangs on the cup, fitted to points of its sides."""

import numpy as np
import pytest

from pack_core.packing.cell import packing_cell
from pack_core.packing.objects import Box, Cylinder
from pack_core.rotations import POINTING_DOWN, Array, Pose, angle_between, exp, from_yaw, multiply
from pack_perception.depth.held_fit import HeldShape, held_shape
from pack_perception.perception_config import DepthConfig

CELL = packing_cell()
TOLD = CELL.scene.new_object
X_WT = Pose(np.array([0.5, 0.0, 0.45]), POINTING_DOWN)
"""The cup over the container, its z axis down."""
TILT = multiply(exp(np.array([0.02, -0.01, 0.0])), from_yaw(0.2))
BENEATH = np.array([[0.5 + 0.001 * i, 0.002 * j, 0.15] for i in range(-40, 40) for j in range(-20, 20)])
"""The top of something in the container."""


def box_sides(size: tuple[float, float, float], rng: np.random.Generator) -> Array:
    """Points of an upright box's sides, its middle at the origin `(n, 3)`."""
    half = 0.5 * np.array(size)
    p = rng.uniform(-half, half, (20000, 3))
    axis = rng.integers(2, size=len(p))
    p[np.arange(len(p)), axis] = rng.choice([-1.0, 1.0], len(p)) * half[axis]
    return p


def tube(radii: Array, height: float, rng: np.random.Generator) -> Array:
    """Points of the side of a body of revolution, whose radii are linear between heights that are even."""
    z, turn = rng.uniform(-0.5, 0.5, 20000) * height, rng.uniform(0.0, 2.0 * np.pi, 20000)
    r = np.interp(z, np.linspace(-0.5, 0.5, len(radii)) * height, radii)
    return np.column_stack([r * np.cos(turn), r * np.sin(turn), z])


def seen(points: Array, height: float, turn: Array, rng: np.random.Generator) -> HeldShape | None:
    """The fit of a body that hangs by its top, with errors of half a millimetre."""
    X_WN = Pose(X_WT.p - Pose(np.zeros(3), turn).apply([0.0, 0.0, 0.5 * height]), turn)
    p = X_WN.apply(points) + rng.normal(0.0, 0.0005, points.shape)
    return held_shape(np.concatenate([p, BENEATH]), CELL.depth.cameras(), X_WT, TOLD, DepthConfig())


def test_size_and_hang_of_a_box_that_leans() -> None:
    rng, size = np.random.default_rng(0), (0.08, 0.05, 0.16)
    found = seen(box_sides(size, rng), size[2], TILT, rng)
    assert found is not None
    assert isinstance(found.item, Box)
    # the points here are denser than pixels, half of whose distance is added at the lower end
    assert found.item.size == pytest.approx(size, abs=0.0015)
    X_WN = X_WT @ found.X_TN
    assert np.rad2deg(angle_between(X_WN.q, TILT)) < 0.3
    assert X_WN.p == pytest.approx(X_WT.p - Pose(np.zeros(3), TILT).apply([0.0, 0.0, 0.08]), abs=0.001)
    assert (found.item.name, found.item.mass) == (TOLD.name, TOLD.mass)


def test_a_can_is_a_cylinder_and_a_bottle_is_a_hull() -> None:
    rng, upright = np.random.default_rng(1), from_yaw(0.0)
    can = seen(tube(np.array([0.04, 0.04]), 0.12, rng), 0.12, upright, rng)
    assert can is not None
    assert isinstance(can.item, Cylinder)
    assert can.item.radius == pytest.approx(0.04, abs=0.0002)
    bottle = seen(tube(np.array([0.035, 0.035, 0.02, 0.02]), 0.14, rng), 0.14, upright, rng)
    assert bottle is not None
    assert bottle.item.shape == "mesh"
    assert 2.0 * bottle.item.half_extents == pytest.approx([0.07, 0.07, 0.14], abs=0.003)
    assert bottle.deviations.size[2] > can.deviations.size[2]


def test_nothing_is_measured_of_what_is_seen_from_one_side() -> None:
    rng, size = np.random.default_rng(2), (0.08, 0.05, 0.16)
    sides = box_sides(size, rng)
    assert seen(sides[sides[:, 0] > 0.0], size[2], from_yaw(0.0), rng) is None
    assert seen(sides[:0], size[2], from_yaw(0.0), rng) is None


def test_of_what_is_flatter_than_its_ends_are_left_out_nothing_is_measured() -> None:
    rng, size = np.random.default_rng(3), (0.08, 0.05, 0.018)
    assert seen(box_sides(size, rng), size[2], from_yaw(0.0), rng) is None
