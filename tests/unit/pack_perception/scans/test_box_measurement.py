"""A box on the conveyor is measured to some millimetres, and what is no box is doubted."""

import numpy as np
import pytest

from pack_core.motion.world import Obstacle
from pack_core.palletizing.cell import PICKING_TABLE, palletizing_cell
from pack_perception.scans.box_measurement import BoxMeasurementConfig, MeasuredBox, measure_box
from pack_perception.scans.rays import Rays
from unit.pack_perception.scans.closed_form import box_on, moved, scan_of

CELL = palletizing_cell("shift")
TABLE = next(block for block in CELL.furniture if block.name == PICKING_TABLE)
LEVEL, (X, Y) = CELL.picking_table.height, CELL.picking_table.centre
NOISE = 0.003


def measured(boxes: list[Obstacle], seed: int = 0) -> MeasuredBox:
    noise = np.random.default_rng(seed).normal(0.0, NOISE, len(CELL.scanner_rays(PICKING_TABLE)))
    scan = scan_of(CELL, PICKING_TABLE, (*CELL.furniture, *boxes), noise=noise)
    rays = Rays.of(scan, CELL.scanner_pose(PICKING_TABLE))
    spacing = CELL.scanner(PICKING_TABLE).spacing
    return measure_box(rays, TABLE, spacing, BoxMeasurementConfig())


@pytest.mark.parametrize("seed", range(12))
def test_size_and_place_are_measured_to_three_millimetres(seed: int) -> None:
    rng = np.random.default_rng(seed)
    size = np.sort(rng.uniform([0.13, 0.2, 0.3], [0.2, 0.3, 0.6]))[::-1]
    x, y, turn = X + rng.uniform(-0.15, 0.15), Y + rng.uniform(-0.05, 0.05), rng.uniform(-90.0, 90.0)
    box = moved(box_on(LEVEL, x, y, size), turn_deg=turn)
    found = measured([box], seed)
    assert found.doubt == ""
    assert found.X_WB is not None
    assert np.all(np.abs(found.size - size) < 0.003)
    assert np.linalg.norm(found.X_WB.p - box.X_WO.p) < 0.003


def test_an_empty_table_has_no_box() -> None:
    found = measured([])
    assert found.X_WB is None
    assert found.doubt == "there is nothing on the table"


def test_a_second_box_is_noticed() -> None:
    first, beside = box_on(LEVEL, X, Y, (0.3, 0.2, 0.2)), box_on(LEVEL, X + 0.3, Y, (0.2, 0.2, 0.1))
    assert measured([first, beside]).doubt == "there is more on the table than one box"


def test_a_top_with_a_dent_is_doubted() -> None:
    low, left, right = ((0.4, 0.3, 0.15), (0.15, 0.3, 0.2), (0.15, 0.3, 0.2))
    boxes = [box_on(LEVEL, X, Y, low), box_on(LEVEL, X - 0.125, Y, left), box_on(LEVEL, X + 0.125, Y, right)]
    assert measured(boxes).doubt.startswith("its top is not one level face")
