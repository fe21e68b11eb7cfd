"""Calibration files, and what a cell may do without one."""

from pathlib import Path

import numpy as np
import pytest

from pack_core.camera import LensDistortion
from pack_core.errors import ConfigError
from pack_core.packing.depth_calibration import DepthCalibration, load_depth_calibration
from pack_core.palletizing.calibration import (
    CalibratedCamera,
    CellCalibration,
    EstimatedNumber,
    FitResiduals,
    KnownCell,
    PlacingError,
    known_cell,
    load_calibration,
)
from pack_core.palletizing.cell import palletizing_cell
from pack_core.palletizing.imperfections import NOWHERE, Displacement
from pack_core.robots.joint_properties import GearCompensation

FOUND = CellCalibration(
    preset="real",
    camera=CalibratedCamera(
        displacement=Displacement(shift=(0.001, 0.0, 0.002)), focal_scale=1.004, centre_shift=(3.0, -2.0),
        lens=LensDistortion(k1=-0.08),
    ),
    picking_table=Displacement(turn=(0.001, 0.0, 0.0)), reorientation_table=NOWHERE,
    pallet=Displacement(shift=(0.003, 0.0, 0.0)),
    gears=GearCompensation(stiffness=(4e6, 4e6, 2.5e6, 6e5, 6e5, 3e5)),
    predicted=PlacingError(mean=0.4, p95=0.9), simulated_s=280.0,
    estimates=(EstimatedNumber(name="pallet x", value=0.003, sigma=0.0001, unit="m"),), covariance=((1e-8,),),
    residuals=(FitResiduals(name="touches", count=3, rms=0.05, expected=0.08, worst=0.1, unit="mm"),),
)  # fmt: skip


def test_what_was_written_is_read_again(tmp_path: Path) -> None:
    path = tmp_path / "cell" / "calibration.yaml"
    FOUND.write(path)
    assert load_calibration(path) == FOUND
    assert known_cell("real", str(path)).calibration == FOUND


def test_a_calibrated_cell_has_everything_where_it_was_found() -> None:
    nominal = palletizing_cell("real")
    cell = FOUND.applied(nominal)
    np.testing.assert_allclose(cell.pallet.X_WP.p - nominal.pallet.X_WP.p, [0.003, 0.0, 0.0], atol=1e-12)
    assert cell.overhead_camera.f == pytest.approx(1.004 * nominal.overhead_camera.f)
    assert cell.overhead_camera.c[0] - nominal.overhead_camera.c[0] == pytest.approx(3.0)
    assert cell.camera.lens.k1 == -0.08
    assert cell.picking_table.displacement == FOUND.picking_table
    assert nominal.pallet.displacement.is_zero


def test_a_calibration_of_the_other_cell_is_refused_in_one_sentence(tmp_path: Path) -> None:
    path = tmp_path / "calibration.yaml"
    FOUND.write(path)
    with pytest.raises(
        ConfigError, match=r"a calibration of the palletizing cell; expected .* packing cell"
    ) as one:
        load_depth_calibration(path)
    DepthCalibration(preset="installed", described=(), cameras=(), simulated_s=1.0).write(path)
    with pytest.raises(
        ConfigError, match=r"a calibration of the packing cell; .*`pack calibrate palletizing`"
    ) as other:
        load_calibration(path)
    assert "\n" not in str(one.value) + str(other.value)


def test_a_calibration_of_another_preset_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "calibration.yaml"
    FOUND.write(path)
    with pytest.raises(ConfigError, match="made under preset 'real', and this cell has 'elastic'"):
        known_cell("elastic", str(path))


def test_a_damaged_file_is_refused_with_its_key(tmp_path: Path) -> None:
    path = tmp_path / "calibration.yaml"
    FOUND.write(path)
    path.write_text(path.read_text().replace("focal_scale", "focal_length"))
    with pytest.raises(ConfigError, match="focal_length"):
        load_calibration(path)


def test_an_uncalibrated_real_cell_asks_for_wider_gaps() -> None:
    uncalibrated = known_cell("real", "")
    with pytest.raises(ConfigError, match=r"not calibrated.*pack calibrate palletizing.*gaps of 30 mm"):
        uncalibrated.check_gap(0.002)
    uncalibrated.check_gap(0.03)
    KnownCell(palletizing_cell("real"), FOUND).check_gap(0.002)
    known_cell("rigid", "").check_gap(0.0)
