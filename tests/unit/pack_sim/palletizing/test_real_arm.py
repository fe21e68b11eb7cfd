"""An arm with elastic gears, play, and a base that stands elsewhere."""

import numpy as np
import pytest

from pack_core.errors import ConfigError
from pack_core.palletizing.cell import palletizing_cell
from pack_core.rotations import angle_between
from pack_sim.palletizing.real_arm import GearTrain, true_base
from unit.pack_sim.palletizing.rig import OVER_TABLE, Rig

ELASTIC = palletizing_cell("elastic")
GEARS = ELASTIC.imperfections.gears
assert GEARS is not None


def without_calibration_error() -> Rig:
    exact = ELASTIC.imperfections.calibration.model_copy(update={"position": 0.0, "orientation_deg": 0.0})
    placed = ELASTIC.imperfections.model_copy(update={"calibration": exact})
    return Rig(ELASTIC.model_copy(update={"imperfections": placed}))


def test_the_base_is_off_by_what_the_preset_says() -> None:
    believed = ELASTIC.arm.X_WB
    for seed in range(20):
        angle = angle_between(true_base(ELASTIC, seed).q, believed.q)
        assert np.rad2deg(angle) == pytest.approx(0.1)
    assert not np.array_equal(true_base(ELASTIC, 0).p, true_base(ELASTIC, 1).p)
    np.testing.assert_array_equal(true_base(palletizing_cell(), 3).p, believed.p)


def test_a_gear_gives_no_torque_within_its_play_and_a_spring_beyond_it() -> None:
    train = GearTrain(GEARS, Rig().simulator._load.model)
    play = np.deg2rad(GEARS.backlash_deg) / 2
    np.testing.assert_array_equal(train.torque(np.full(6, 0.9 * play)), 0.0)
    np.testing.assert_allclose(train.torque(np.full(6, -play - 1e-4)), 1e-4 * np.array(GEARS.stiffness))


def test_elastic_gears_let_the_tool_sag_and_are_led_against_it() -> None:
    """What is left at rest: play and the share of the load's twist that the controller does not know."""
    rig = without_calibration_error()
    rig.wait(1.0)
    error = rig.chain.forward(np.array(rig.cell.arm.home)).p - rig.simulator.tool_pose().p
    assert 0.05e-3 < np.linalg.norm(error) < 1.5e-3
    assert error[2] > 0.0


def test_an_elastic_arm_tracks_worse_than_a_rigid_one_and_settles() -> None:
    rigid, elastic = Rig(), without_calibration_error()
    for rig in (rigid, elastic):
        rig.move(OVER_TABLE)
    assert np.mean(elastic.errors) > 3 * np.mean(rigid.errors)
    assert np.max(elastic.errors) < 10e-3
    elastic.wait(1.0)
    assert np.abs(elastic.simulator.joints().v).max() < 1e-3


def test_a_preset_that_is_not_there_is_refused_by_name() -> None:
    with pytest.raises(ConfigError, match="no preset 'rubber'; allowed: elastic, real, rigid"):
        palletizing_cell("rubber")
