"""Calibrating the simulated real cell: what is touched and fitted, against where things truly are."""

import numpy as np
import pytest

from pack_core.palletizing.cell import palletizing_cell
from pack_core.palletizing.imperfections import Displacement
from pack_core.rotations import Array, Pose, log
from pack_core.tasks.steps import Steps
from pack_lockstep.palletizing.calibration_lockstep import CalibrationLockstep, calibrate, quick_check
from pack_lockstep.palletizing.settings import set_up
from pack_sim.palletizing.real_arm import true_base
from pack_sim.palletizing.true_cell import true_cell
from pallet_calibration.measurements import FeltContact, contact_of
from pallet_calibration.model import CellModel, sag_at
from pallet_calibration.parameters import (
    GEARS,
    PLACE,
    start,
)
from pallet_calibration.progress import Agenda, CalibrationState
from pallet_calibration.rig import CalibrationRig, RigJob
from pallet_calibration.touch import DOWN, TRAVEL, from_above, touch

REAL = palletizing_cell("real")
SEED = 12


def true_place(name: str) -> Array:
    """Displacement `(6,)` of a table or the pallet, as seen from the arm's true base."""
    place = getattr(true_cell(REAL, SEED), name)
    X_BW = REAL.arm.X_WB @ true_base(REAL, SEED).inverse()  # the arm takes its base to be the nominal one
    nominal = Pose(place.middle)
    moved = X_BW @ place.displaced(nominal) @ nominal.inverse()
    return np.concatenate([moved.apply(place.middle) - place.middle, log(moved.q)])


@pytest.mark.long
@pytest.mark.timeout(120)
def test_a_touch_finds_a_table_as_well_as_the_gears_are_known() -> None:
    setup = set_up(preset="real")
    rig = CalibrationRig(REAL, setup.config.period)
    table = REAL.picking_table

    def once(rig: CalibrationRig) -> Steps[FeltContact]:
        X_WT, normal, p_TC = from_above(rig, table.middle, 0.055)
        yield from rig.go(Pose(X_WT.p - 0.1 * DOWN, X_WT.q))
        surface = ("picking_table", 2, table.height)
        recorded = yield from touch(rig, X_WT, normal, TRAVEL, surface, p_TC)
        return contact_of(recorded, rig.arm.chain, rig.period)

    agenda = Agenda({CalibrationState.TOUCH: 1})
    found = CalibrationLockstep(REAL, REAL, setup.config, SEED).run(RigJob(rig, once), agenda)
    gears = REAL.imperfections.gears
    assert gears is not None
    model = CellModel(REAL, rig.arm.chain, gears.assumed, Pose(np.zeros(3)))
    x = start()
    x[PLACE["picking_table"]] = true_place("picking_table")
    sag = sag_at(model, found)
    by_data_sheet = model.gap(x, found, sag.links(x))
    x[GEARS] = 1.0 + gears.stiffness_error
    by_true_gears = model.gap(x, found, sag.links(x))
    assert abs(by_true_gears) < 1e-4
    assert abs(by_true_gears) < abs(by_data_sheet)
    assert found.gives == pytest.approx(model.give(x, found), rel=0.3)


@pytest.mark.long
@pytest.mark.timeout(1500)
def test_a_calibration_finds_the_cell_predicts_well_and_holds_until_something_moves() -> None:
    setup = set_up(preset="real")
    run = calibrate(REAL, setup.config, SEED)
    sigma = np.sqrt(np.diag(run.found.covariance))
    off = run.found.x[PLACE["pallet"]] - true_place("pallet")
    assert np.all(np.abs(off[:3]) < np.maximum(4 * sigma[PLACE["pallet"]][:3], 3e-4))
    assert run.calibration.simulated_s < 600
    assert run.calibration.predicted.mean < 0.7
    holds = quick_check(REAL, setup.config, SEED, run.calibration)
    assert holds.holds
    assert holds.seconds < 60
    # Somebody ran into the camera: everything it sees is 3 mm farther.
    camera = run.calibration.camera
    pushed = Displacement.of(camera.displacement.vector + 0.003 * np.eye(6)[0])
    wrong = run.calibration.model_copy(update={"camera": camera.model_copy(update={"displacement": pushed})})
    assert not quick_check(REAL, setup.config, SEED, wrong).holds
