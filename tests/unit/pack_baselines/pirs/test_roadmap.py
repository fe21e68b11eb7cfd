"""Edges of the roadmap cost what Eq. 1 says: C = alpha_1 [pick-and-place] + alpha_2 [push] + alpha_3 N_c."""

import numpy as np
import numpy.typing as npt
import pytest

from pack_baselines.pirs.geometry import Sizes
from pack_baselines.pirs.roadmap import (
    PUSHED,
    Prices,
    Way,
    cheapest_edge,
    grasps_at,
    shortest_way,
)
from pack_core.blocks.gripper import GripperFootprint
from pack_planner.rearrangement.footprints import outlines

SIDE = 0.0508
SHAPE = np.array([SIDE, SIDE, 0.0])
SIZES = Sizes.of(SHAPE, GripperFootprint())
PRICES = Prices(pick_place=1.0, push=1.5, collision=2.0)
START, AHEAD, ASIDE = (0.0, 0.0, 0.0), (0.06, 0.0, 0.0), (0.3, 0.25, 0.4)
BESIDE_X, BESIDE_Y = (SIDE + 0.004, 0.0, 0.0), (0.0, SIDE + 0.004, 0.0)
"""A block so near beside START that no finger fits between, along the axis of either grasp."""
Pose = tuple[float, float, float]


def blocks_at(*poses: Pose) -> npt.NDArray[np.float64]:
    return outlines(np.array(poses).reshape(-1, 3), SHAPE)


def edge(
    start: Pose, end: Pose, *blocks: Pose, fixed: int = 0, prices: Prices = PRICES, is_symmetric: bool = False
) -> tuple[float, int, int]:
    """Price, kind and blocks in the way of the cheapest edge; the blocks may be moved but for the `fixed`."""
    there, nodes = blocks_at(*blocks), np.array([start, end])
    picks, places = grasps_at(nodes, SIZES, there)
    movable = (1 << len(blocks)) - 1 & ~fixed
    price, kind, hit = cheapest_edge(
        nodes[0], nodes[1], picks[0], places[1], there, np.uint64(movable), np.uint64(fixed), is_symmetric,
        prices, SIZES,
    )  # fmt: skip
    return float(price), int(kind), int(hit)


def way(nodes: list[Pose], *blocks: Pose, prices: Prices = PRICES, fixed: int = 0) -> Way:
    movable = (1 << len(blocks)) - 1 & ~fixed
    return shortest_way(
        np.array(nodes), blocks_at(*blocks), np.uint64(movable), np.uint64(fixed), False, prices, SIZES
    )


def test_a_free_pick_and_place_costs_alpha_1() -> None:
    assert edge(START, ASIDE) == (1.0, 0, 0)


def test_a_block_that_hinders_one_grasp_only_costs_nothing() -> None:
    assert edge(START, ASIDE, BESIDE_X) == (1.0, 2 * 1 + 1, 0)
    assert edge(START, ASIDE, BESIDE_Y) == (1.0, 0, 0)


def test_every_block_in_collision_costs_alpha_3() -> None:
    """Both grasps hit one block at the start; the cheaper grasp hits one more or none at the end."""
    at_end = (ASIDE[0], ASIDE[1], 0.4)
    assert edge(START, ASIDE, BESIDE_X, BESIDE_Y)[0] == PRICES.pick_place + PRICES.collision
    price, _, hit = edge(START, ASIDE, BESIDE_X, BESIDE_Y, at_end)
    assert price == PRICES.pick_place + 2 * PRICES.collision
    assert hit.bit_count() == 2
    assert hit & 0b100


def test_a_block_hit_at_both_ends_counts_once() -> None:
    """After a step of a millimetre the same block is in the fingers' way as before."""
    near = (0.0, 0.001, 0.0)
    price, kind, hit = edge(START, near, BESIDE_X, (0.0, -SIDE - 0.006, 0.0), BESIDE_Y)
    assert (price, kind, hit) == (PRICES.pick_place + PRICES.collision, 0, 0b001)


def test_a_push_costs_alpha_2_where_no_grasp_is_free() -> None:
    """One block hinders the grasp along y at the start, another that along x at the end."""
    beyond_end = (AHEAD[0] + SIDE + 0.004, 0.0, 0.0)
    assert edge(START, AHEAD, BESIDE_Y, beyond_end, fixed=0b11) == (PRICES.push, PUSHED, 0)


@pytest.mark.parametrize(("alpha_2", "kind"), [(1.5, 0), (1.0, 0), (0.9, PUSHED)])
def test_where_both_are_possible_the_cheaper_action_is_the_edge(alpha_2: float, kind: int) -> None:
    prices = Prices(1.0, alpha_2, 2.0)
    assert edge(START, AHEAD, prices=prices) == (min(1.0, alpha_2), kind, 0)


@pytest.mark.parametrize("length", [0.5 * SIZES.min_push, 1.1 * SIZES.max_push])
def test_a_push_that_is_too_short_or_too_long_is_no_edge(length: float) -> None:
    assert edge(START, (length, 0.0, 0.0), prices=Prices(1.0, 0.1, 2.0)) == (1.0, 0, 0)


def test_a_push_must_keep_the_yaw_and_follow_a_faces_normal() -> None:
    cheap = Prices(1.0, 0.1, 2.0)
    for end in ((0.06, 0.0, 0.1), (0.04, 0.04, 0.0)):
        assert edge(START, end, prices=cheap)[0] == 1.0
    for end in ((0.06, 0.0, 0.0), (0.0, -0.06, 0.0)):
        assert edge(START, end, prices=cheap) == (0.1, PUSHED, 0)


def test_a_block_that_must_stay_forbids_the_edge() -> None:
    price, kind, _ = edge(START, ASIDE, BESIDE_X, BESIDE_Y, fixed=0b11)
    assert price == np.inf
    assert kind == -1


def test_edges_have_a_direction() -> None:
    """A push needs room for the gripper behind the block: free on the way there, blocked on the way back."""
    cheap = Prices(1.0, 0.1, 2.0)
    behind_end = (AHEAD[0] + SIDE + 0.01, 0.0, 0.0)
    assert edge(START, AHEAD, behind_end, fixed=1, prices=cheap)[1] == PUSHED
    assert edge(AHEAD, START, behind_end, fixed=1, prices=cheap)[1] != PUSHED


def test_a_symmetric_block_may_be_turned_between_the_grasps() -> None:
    """Grasped along x at its start and along y at its end, which needs a quarter turn on the way."""
    c, s = np.cos(ASIDE[2]), np.sin(ASIDE[2])
    reach = SIDE + 0.004
    beside_end = (ASIDE[0] + c * reach, ASIDE[1] + s * reach, ASIDE[2])
    assert edge(START, ASIDE, BESIDE_Y, beside_end, fixed=0b11)[0] == np.inf
    assert edge(START, ASIDE, BESIDE_Y, beside_end, fixed=0b11, is_symmetric=True)[:2] == (1.0, 2 * 0 + 1)


@pytest.mark.parametrize(("alpha_3", "actions"), [(0.5, 1), (2.0, 2)])
def test_dear_collisions_make_a_regrasp_worth_it(alpha_3: float, actions: int) -> None:
    """Section V: for small alpha_3 one block is cleared away, for large alpha_3 the block is regrasped.

    One grasp is hindered at the start, the other at the end; a free pose between allows to change it. One
    action costs 1 + alpha_3, two cost 2.
    """
    c, s = np.cos(ASIDE[2]), np.sin(ASIDE[2])
    reach = SIDE + 0.004
    beside_end = (ASIDE[0] + c * reach, ASIDE[1] + s * reach, ASIDE[2])
    found = way([START, ASIDE, (-0.3, -0.2, 0.0)], BESIDE_Y, beside_end, prices=Prices(1.0, 1.5, alpha_3))
    assert len(found.grasps) == actions
    assert int(found.blocks).bit_count() == 2 - actions


def test_a_metre_of_the_way_costs_its_price_for_either_action() -> None:
    priced = Prices(1.0, 1.5, 2.0, distance=4.0)
    assert edge(START, ASIDE, prices=priced)[0] == pytest.approx(1.0 + 4.0 * np.hypot(0.3, 0.25))
    assert edge(START, AHEAD, prices=priced._replace(push=0.9))[:2] == pytest.approx(
        (0.9 + 4.0 * 0.06, PUSHED)
    )


def test_a_metre_of_pushing_costs_more_than_a_metre_of_carrying() -> None:
    """A push that is cheaper than a carry as such loses once 6 cm of pushing cost more than they differ."""
    prices = Prices(1.0, 0.9, 2.0, distance=4.0, push_length=1.0)
    assert edge(START, AHEAD, prices=prices)[:2] == pytest.approx((0.9 + 5.0 * 0.06, PUSHED))
    assert edge(START, AHEAD, prices=prices._replace(push_length=2.0))[:2] == pytest.approx((1.24, 0))


def test_with_a_price_of_distance_the_nearer_pose_between_is_taken() -> None:
    """A regrasp by way of one of two free poses, which cost the same by Eq. 1."""
    c, s = np.cos(ASIDE[2]), np.sin(ASIDE[2])
    reach = SIDE + 0.004
    beside_end = (ASIDE[0] + c * reach, ASIDE[1] + s * reach, ASIDE[2])
    far, near = (-0.3, -0.2, 0.0), (0.12, 0.12, 0.0)
    nodes = [START, ASIDE, far, near]
    found = [
        way(nodes, BESIDE_Y, beside_end, prices=Prices(1.0, 1.5, 8.0, distance=price), fixed=0b11).poses[1]
        for price in (0.0, 1.0)
    ]
    np.testing.assert_array_equal(found, [far, near])


def test_no_way_has_no_edges() -> None:
    assert len(way([START, ASIDE], BESIDE_X, BESIDE_Y, fixed=0b11).grasps) == 0
