"""Boxes on a table that is neither level nor where it should be, seen by a camera that hangs elsewhere."""

import numpy as np
import pytest

from pack_core.palletizing.boxes import BoxBody, DetectionStatus, ExpectedBox
from pack_core.palletizing.cell import palletizing_cell
from pack_core.palletizing.imperfections import Displacement
from pack_core.rotations import Pose, angle_between, from_yaw
from pack_perception.boxes.box_vision import BoxVision, VisionConfig
from pack_perception.boxes.table_camera import TableCamera
from pack_sim.palletizing.overhead_camera import PalletCamera, PalletCameraConfig, Snapshot
from pack_sim.palletizing.true_cell import true_cell

BOX = BoxBody("a", (0.40, 0.30, 0.20), 5.0)
CONFIG = PalletCameraConfig(width=1920, shadows=False)


@pytest.mark.timeout(120)
def test_a_box_is_found_where_it_stands_by_whoever_knows_the_true_cell() -> None:
    nominal = palletizing_cell("real")
    cell = true_cell(nominal, 12)
    # Everything is displaced so far that not knowing it would be seen at once.
    far = Displacement.of([0.01, -0.02, 0.02, 0.03, -0.02, 0.05])
    cell = cell.model_copy(
        update={"picking_table": cell.picking_table.model_copy(update={"displacement": far})}
    )
    on_table = Pose(cell.picking_table.middle + np.array([0.05, -0.03, 0.1]), from_yaw(0.1))
    X_WB = cell.picking_table.displaced(on_table)
    with PalletCamera(cell, CONFIG, 12) as camera:
        picture = camera.picture(Snapshot(1.0, np.array(cell.arm.home), {BOX: X_WB}))
    seen_by = cell.overhead_camera.scaled(CONFIG.width)
    expected = ExpectedBox("a", BOX.size, 0.0)
    found = TableCamera(cell, BoxVision(VisionConfig()), seen_by).detect(picture, expected, 1.0).detection
    assert found.status is DetectionStatus.DETECTED
    assert found.X_WB is not None
    assert np.linalg.norm(found.X_WB.p - X_WB.p) < 0.0005
    assert np.degrees(angle_between(found.X_WB.q, X_WB.q)) < 0.1
    by_paper = TableCamera(nominal, BoxVision(VisionConfig()), nominal.overhead_camera.scaled(CONFIG.width))
    wrong = by_paper.detect(picture, expected, 1.0).detection
    assert wrong.X_WB is None or np.linalg.norm(wrong.X_WB.p - X_WB.p) > 0.005
