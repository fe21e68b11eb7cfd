import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from shapely import Polygon, affinity, box

from block_fsm.motions import TOUCHING, TableObstacles
from pack_core.blocks.cell import blocks_cell
from pack_core.blocks.planar import PlanarPose
from pack_core.blocks.problem import BlockSize

SIDE = 0.0508
SURROUNDINGS = TableObstacles(blocks_cell())
yaws = st.floats(-np.pi, np.pi)


def square(pose: PlanarPose) -> Polygon:
    half = SIDE / 2
    turned = affinity.rotate(box(-half, -half, half, half), pose.yaw, (0, 0), use_radians=True)
    return affinity.translate(turned, pose.x, pose.y)


@given(yaws, yaws, yaws, st.floats(0.045, 0.08))
def test_blocks_stand_beside_each_other_where_their_outlines_are_near(
    yaw_a: float, yaw_b: float, direction: float, distance: float
) -> None:
    a = PlanarPose(0.6, 0.1, yaw_a)
    b = PlanarPose(0.6 + distance * np.cos(direction), 0.1 + distance * np.sin(direction), yaw_b)
    gap = square(a).distance(square(b))
    if abs(gap - TOUCHING) > 1e-9:
        assert ("b" in SURROUNDINGS.beside("a", {"a": a, "b": b})) == (gap < TOUCHING)


def test_the_table_is_always_beside_a_block() -> None:
    assert SURROUNDINGS.beside("a", {"a": PlanarPose(0.6, 0.1)}) == {"table"}


def test_a_carried_block_is_where_the_tool_takes_it() -> None:
    block = PlanarPose(0.6, 0.1, 0.3)
    X_WT = PlanarPose(0.601, 0.1, 1.0).pose(0.03)
    carried = SURROUNDINGS.carried(X_WT, "a", block)
    assert np.allclose((X_WT @ carried.X_TB).p, [0.6, 0.1, SIDE / 2])


def test_oblong_blocks_touch_along_their_own_edges() -> None:
    """Of two blocks 40 by 70 mm, 41 mm apart, those touch that lie side by side, not those end to end."""
    size = BlockSize(0.04, 0.07, 0.045)
    table = TableObstacles(blocks_cell(), {"a": size, "b": size})
    for yaw, near in ((0.0, {"table"}), (np.pi / 2, {"table", "b"})):
        poses = {"a": PlanarPose(0.6, 0.0, yaw), "b": PlanarPose(0.6415, 0.0, yaw)}
        assert table.beside("a", poses) == near
    (_, a, _) = table.among(poses)
    assert a.X_WO.p[2] == pytest.approx(0.0225)
    assert np.allclose(a.size, size)
