"""An order in a real cell whose calibration is exact: what is left is play, vision and letting go."""

import numpy as np
import pytest

from pack_core.errors import ConfigError
from pack_core.palletizing.calibration import CalibratedCamera, CellCalibration, PlacingError
from pack_core.palletizing.cell import palletizing_cell
from pack_core.palletizing.imperfections import Displacement
from pack_core.paths import config_path
from pack_core.rotations import Array, Pose, log
from pack_lockstep.palletizing.benchmark import OrderJob, PalletSetup, run_order
from pack_lockstep.palletizing.settings import set_up
from pack_sim.palletizing.real_arm import true_base
from pack_sim.palletizing.true_cell import true_cell

REAL, SEED = palletizing_cell("real"), 12
X_BW = REAL.arm.X_WB @ true_base(REAL, SEED).inverse()
"""From the true world to one in which the arm's base is where it is taken to be."""


def seen_from_base(displacement: Displacement, middle: Array) -> Displacement:
    """A displacement as the arm has it that takes its base to be the nominal one."""
    moved = X_BW @ displacement.about(middle)
    return Displacement.of([*(moved.apply(middle) - middle), *log(moved.q)])


def exact() -> CellCalibration:
    """The calibration that knows everything but the play of the gears."""
    true, gears = true_cell(REAL, SEED), REAL.imperfections.gears
    assert gears is not None
    camera = true.camera
    found = {
        name: seen_from_base(getattr(true, name).displacement, getattr(true, name).middle)
        for name in ("picking_table", "reorientation_table", "pallet")
    }
    p_WC = REAL.overhead_camera.X_WC.p
    return CellCalibration(
        preset="real",
        camera=CalibratedCamera(
            displacement=seen_from_base(camera.displacement, p_WC), focal_scale=camera.focal_scale,
            centre_shift=camera.centre_shift, lens=camera.lens,
        ),
        picking_table=found["picking_table"], reorientation_table=found["reorientation_table"],
        pallet=found["pallet"], gears=gears.assumed.model_copy(update={"stiffness": gears.stiffness}),
        predicted=PlacingError(mean=0.0, p95=0.0), simulated_s=0.0, estimates=(), covariance=(), residuals=(),
    )  # fmt: skip


def setup(calibrations: dict[int, CellCalibration]) -> PalletSetup:
    read = set_up(preset="real")
    return PalletSetup(read.name, read.cell, read.config, read.layout, calibrations=calibrations)


JOB = OrderJob(config_path("orders", "order_15.json"), SEED)


def test_the_true_camera_is_where_the_exact_calibration_has_it() -> None:
    known = exact().applied(REAL).overhead_camera
    wanted = X_BW @ true_cell(REAL, SEED).overhead_camera.X_WC
    np.testing.assert_allclose(known.X_WC.p, wanted.p, atol=1e-9)
    np.testing.assert_allclose(known.X_WC.q, wanted.q, atol=1e-9)
    pallet = X_BW @ true_cell(REAL, SEED).pallet.X_WP
    np.testing.assert_allclose(exact().applied(REAL).pallet.X_WP.p, pallet.p, atol=1e-9)
    assert isinstance(pallet, Pose)


def test_without_a_calibration_the_order_is_refused() -> None:
    with pytest.raises(ConfigError, match="the cell is not calibrated"):
        run_order(setup({}), JOB)


@pytest.mark.long
@pytest.mark.timeout(600)
def test_boxes_stand_within_a_millimetre_of_their_places_on_the_true_pallet() -> None:
    line = run_order(setup({SEED: exact()}), JOB)
    measures = line["measures"]
    assert measures["is_complete"], line["reason"]
    assert max(box["error_mm"] for box in measures["boxes"]) < 1.0
    assert measures["touches"] == measures["drops"] == 0
    assert measures["true_position_mm"][1] < 1.0
