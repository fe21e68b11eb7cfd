"""Where things of the preset `real` truly are."""

import numpy as np
import pytest

from pack_core.palletizing.cell import palletizing_cell
from pack_sim.palletizing.true_cell import true_cell

REAL = palletizing_cell("real")
PLACES = ("picking_table", "reorientation_table", "pallet")


def test_a_preset_without_such_errors_gives_the_cell_back() -> None:
    for preset in ("rigid", "elastic"):
        cell = palletizing_cell(preset)
        assert true_cell(cell, 3) is cell


@pytest.mark.parametrize("seed", range(5))
def test_furniture_and_camera_are_off_by_what_the_preset_says(seed: int) -> None:
    cell = true_cell(REAL, seed)
    for name in PLACES:
        off = getattr(cell, name).displacement
        assert np.linalg.norm(off.shift) == pytest.approx(0.003)
        assert np.rad2deg(np.linalg.norm(off.turn)) == pytest.approx(0.2)
    assert np.linalg.norm(cell.camera.displacement.shift) == pytest.approx(0.005)
    assert abs(cell.camera.focal_scale - 1.0) <= 0.005
    assert np.max(np.abs(cell.camera.centre_shift)) <= 12.0


def test_the_same_seed_is_the_same_cell_and_another_seed_another() -> None:
    assert true_cell(REAL, 4) == true_cell(REAL, 4)
    assert true_cell(REAL, 4).pallet.displacement != true_cell(REAL, 5).pallet.displacement
    shifts = {getattr(true_cell(REAL, 4), name).displacement.shift for name in PLACES}
    assert len(shifts) == len(PLACES)
