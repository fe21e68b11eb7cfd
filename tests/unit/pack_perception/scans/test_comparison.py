"""What a scan shows against what must stand there: nothing where all is well, and each change by its name."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pack_core.motion.world import Obstacle
from pack_core.palletizing.cell import PALLET, palletizing_cell
from pack_core.palletizing.scanner import PlaceScan
from pack_perception.scans.comparison import Finding, Oddity, ScannedScene, ScanTolerances, compare
from pack_perception.scans.rays import Rays
from unit.pack_perception.scans.closed_form import box_on, moved, scan_of

CELL = palletizing_cell()
DECK = next(block for block in CELL.furniture if block.name == PALLET)
LEVEL = CELL.pallet.deck_height
LEAST = 39.0
"""Rays to 25 cm^2 of the deck."""
NOISE = 0.003
RAYS = len(CELL.scanner_rays(PALLET))
BOX = box_on(LEVEL, 0.1, 0.5, (0.3, 0.2, 0.2))
SMALL = box_on(LEVEL, -0.3, 0.3, (0.1, 0.1, 0.1))
seeds = st.integers(0, 10_000)


def findings(
    expected: Sequence[Obstacle], true: Sequence[Obstacle], seed: int = 0, noise: float = NOISE
) -> tuple[Finding, ...]:
    """Of a noisy scan of the true boxes on the pallet."""
    errors = np.random.default_rng(seed).normal(0.0, noise, RAYS)
    return compared(scan_of(CELL, PALLET, (DECK, *true), noise=errors), expected)


def compared(scan: PlaceScan, expected: Sequence[Obstacle]) -> tuple[Finding, ...]:
    rays = Rays.of(scan, CELL.scanner_pose(PALLET))
    return compare(ScannedScene(rays, DECK, tuple(expected), LEAST), ScanTolerances())


@given(seed=seeds, x=st.floats(-0.4, 0.4), y=st.floats(0.3, 0.7), edge=st.floats(0.1, 0.5))
@settings(max_examples=15)
def test_a_box_in_its_place_is_never_called_moved(seed: int, x: float, y: float, edge: float) -> None:
    box = box_on(LEVEL, x, y, (edge, 0.15, 0.2))
    assert findings([box], [moved(box, 0.002, -0.002, 0.2)], seed) == ()


@given(
    seed=seeds, angle=st.floats(0.0, 2 * np.pi), way=st.floats(0.015, 0.1), box=st.sampled_from([BOX, SMALL])
)
@settings(max_examples=15)
def test_a_shift_of_15_mm_or_more_is_measured_within_3_mm(
    seed: int, angle: float, way: float, box: Obstacle
) -> None:
    shift = way * np.array([np.cos(angle), np.sin(angle)])
    (finding,) = findings([box], [moved(box, *shift)], seed)
    assert (finding.oddity, finding.box) == (Oddity.MOVED, "box")
    assert np.linalg.norm(finding.shift_W - shift) < 0.003
    assert abs(finding.turn_deg) < 3.0


@given(seed=seeds, turn=st.floats(4.0, 30.0), sign=st.sampled_from([-1, 1]))
@settings(max_examples=15)
def test_a_turn_of_a_few_degrees_is_measured_within_one(seed: int, turn: float, sign: int) -> None:
    (finding,) = findings([BOX], [moved(BOX, turn_deg=sign * turn)], seed)
    assert finding.oddity is Oddity.MOVED
    assert finding.turn_deg == pytest.approx(sign * turn, abs=1.0)
    assert np.linalg.norm(finding.shift_W) < 0.003


@pytest.mark.parametrize("turn", [7.0, -10.0, 20.0])
def test_of_a_box_of_100_mm_a_turn_of_7_degrees_is_seen(turn: float) -> None:
    for seed in range(10):
        (finding,) = findings([SMALL], [moved(SMALL, turn_deg=turn)], seed)
        assert finding.turn_deg == pytest.approx(turn, abs=3.0)


@given(seed=seeds)
@settings(max_examples=10)
def test_the_order_of_the_rays_and_lost_ones_make_no_difference(seed: int) -> None:
    rng = np.random.default_rng(seed)
    scan = scan_of(CELL, PALLET, (DECK, moved(BOX, x=0.05)))
    kept = rng.permutation(len(scan.points))[: int(0.99 * len(scan.points))]
    (finding,) = compared(PlaceScan(0.0, PALLET, scan.points[kept]), [BOX])
    assert finding.shift_W == pytest.approx([0.05, 0.0], abs=0.002)


def test_a_box_that_was_taken_is_gone() -> None:
    upper = box_on(LEVEL + 0.2, 0.1, 0.5, (0.2, 0.2, 0.15), "upper")
    assert [str(item) for item in findings([BOX, upper], [BOX])] == ["box upper is gone"]
    assert {(item.oddity, item.box) for item in findings([BOX, SMALL], [BOX])} == {(Oddity.MISSING, "box")}


def test_a_strange_thing_is_told_with_its_place_and_size() -> None:
    strange = box_on(LEVEL, -0.35, 0.6, (0.2, 0.15, 0.12))
    (finding,) = findings([BOX], [BOX, strange])
    assert finding.oddity is Oddity.FOREIGN
    assert finding.middle_W == pytest.approx([-0.35, 0.6], abs=0.015)
    assert finding.size == pytest.approx([0.2, 0.15, 0.12], abs=0.025)
    assert "0.6" in str(finding)


def test_a_strange_thing_on_top_of_a_box_is_seen_and_the_box_is_not_blamed() -> None:
    lying = box_on(LEVEL + 0.2, 0.1, 0.5, (0.1, 0.1, 0.08))
    (finding,) = findings([BOX], [BOX, lying])
    assert finding.oddity is Oddity.FOREIGN
    assert finding.size[2] == pytest.approx(0.28, abs=0.01)


@pytest.mark.parametrize("size", [(0.24, 0.16, 0.2), (0.3, 0.2, 0.15), (0.3, 0.2, 0.26)])
def test_a_box_of_another_size_in_its_place_is_not_taken_for_it(size: tuple[float, float, float]) -> None:
    found = findings([BOX], [box_on(LEVEL, 0.1, 0.5, size)])
    assert found
    assert "not of its size" in str(found[0]) or found[0].oddity is Oddity.FOREIGN


def test_a_box_that_another_one_covers_is_not_judged() -> None:
    cover = box_on(LEVEL + 0.2, 0.1, 0.5, (0.31, 0.21, 0.1), "cover")
    assert findings([BOX, cover], [moved(BOX, x=0.004), cover]) == ()


@pytest.mark.parametrize("step", [0.0, 0.015, 0.03, 0.05])
def test_neighbours_of_nearly_the_same_height_hide_an_edge_and_raise_no_alarm(step: float) -> None:
    beside = box_on(LEVEL, 0.1 + 0.302, 0.5, (0.3, 0.2, 0.2 + step), "beside")
    behind = box_on(LEVEL, 0.1, 0.5 + 0.202, (0.4, 0.2, 0.2 - step), "behind")
    boxes = [BOX, beside, behind]
    for seed in range(5):
        assert findings(boxes, boxes, seed) == ()


def test_what_is_beside_the_pallet_is_none_of_its_business() -> None:
    assert findings([BOX], [BOX, box_on(0.0, 0.72, 0.5, (0.1, 0.6, 0.5))]) == ()


@pytest.mark.parametrize("seed", range(5))
def test_a_box_pushed_against_one_as_high_is_the_only_one_that_was_moved(seed: int) -> None:
    pushed = box_on(LEVEL, -0.222, 0.559, (0.27, 0.197, 0.151), "pushed")
    low = box_on(LEVEL, -0.367, 0.253, (0.467, 0.305, 0.152), "low")
    beside = box_on(LEVEL, 0.05, 0.549, (0.27, 0.19, 0.16), "beside")
    upper = box_on(LEVEL + 0.152, -0.4, 0.245, (0.4, 0.29, 0.6), "upper")
    stands = moved(pushed, 0.0006, -0.0272, -0.4)
    (finding,) = findings([low, pushed, beside, upper], [low, stands, beside, upper], seed)
    assert finding.box == "pushed"
    assert finding.shift_W == pytest.approx([0.0006, -0.0272], abs=0.003)


@pytest.mark.parametrize("seed", range(5))
def test_between_higher_neighbours_that_hide_its_edges_a_box_was_moved_no_farther_than_must_be(
    seed: int,
) -> None:
    box = box_on(LEVEL, -0.1, 0.235, (0.197, 0.27, 0.151))
    walls = [
        box_on(LEVEL, -0.4, 0.245, (0.4, 0.29, 0.26), "left"),
        box_on(LEVEL, 0.307, 0.295, (0.585, 0.39, 0.22), "right"),
    ]
    (finding,) = findings([box, *walls], [moved(box, 0.006, 0.012), *walls], seed)
    assert finding.shift_W == pytest.approx([0.006, 0.012], abs=0.003)
