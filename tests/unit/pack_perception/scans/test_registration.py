"""A scanner that hangs askew is set right by the edges of its place, and no moved place is explained away."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pytest

from pack_core.motion.world import Obstacle
from pack_core.palletizing.cell import PalletizingCell, palletizing_cell
from pack_core.palletizing.scanner import SCANNED
from pack_core.rotations import Array
from pack_perception.scans.comparison import registered
from pack_perception.scans.rays import Rays
from pack_sim.palletizing.true_cell import true_cell
from unit.pack_perception.scans.closed_form import box_on, moved, scan_of

KNOWN = palletizing_cell("real")
PLACES = {block.name: block for block in KNOWN.furniture}
HEIGHT, SLACK = 0.02, 0.012


def standing(place: str) -> Obstacle:
    x, y, _ = PLACES[place].X_WO.p
    return box_on(PLACES[place].size[2], x + 0.1, y, (0.4, 0.3, 0.3))


def askew(seed: int) -> PalletizingCell:
    return KNOWN.model_copy(update={"scanners": true_cell(KNOWN, seed).scanners})


def corrected(
    true: PalletizingCell, place: str, blocks: Sequence[Obstacle], boxes: Sequence[Obstacle]
) -> tuple[Rays, Rays, Array]:
    """Rays as they are taken, as they are registered, and where they truly end `(n, 3)` [m]."""
    noise = np.random.default_rng(0).normal(0.0, 0.003, len(true.scanner_rays(place)))
    scan = scan_of(true, place, blocks, noise=noise)
    rays = Rays.of(scan, KNOWN.scanner_pose(place))
    ends_W = true.scanner_pose(place).apply(scan.points)
    return rays, registered(rays, PLACES[place], boxes, HEIGHT, SLACK), ends_W


def worst(rays: Rays, ends_W: Array) -> float:
    """Distance of the ends of rays from where they truly are, seen from above, 95 % of them [m]."""
    return float(np.quantile(np.linalg.norm((rays.ends_W - ends_W)[:, :2], axis=1), 0.95))


@pytest.mark.parametrize("place", SCANNED)
@pytest.mark.parametrize("seed", range(4))
def test_of_millimetres_of_a_scanner_that_hangs_askew_less_than_one_is_left(seed: int, place: str) -> None:
    box = standing(place)
    rays, found, ends_W = corrected(askew(seed), place, (PLACES[place], box), (box,))
    assert worst(rays, ends_W) > 0.001
    assert worst(found, ends_W) < 0.001


@pytest.mark.parametrize("place", SCANNED)
def test_a_place_that_somebody_pushed_is_not_taken_for_a_scanner_that_hangs_askew(place: str) -> None:
    box = standing(place)
    pushed = (moved(PLACES[place], x=0.03), moved(box, x=0.03))
    rays, found, _ = corrected(KNOWN, place, pushed, (box,))
    assert found is rays


def test_a_place_whose_edges_are_hidden_says_nothing() -> None:
    x, y, _ = PLACES["pallet"].X_WO.p
    cover = box_on(PLACES["pallet"].size[2], x, y, (1.3, 0.9, 0.2))
    rays, found, _ = corrected(KNOWN, "pallet", (PLACES["pallet"], cover), (cover,))
    assert found is rays
