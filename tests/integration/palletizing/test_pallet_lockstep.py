"""The cores of the palletizing cell together: an order in physics, and what the camera sees."""

from functools import cache

import numpy as np
import pytest

from foreign_driver.lockstep_arm import trajectory_driven
from pack_core.palletizing.boxes import BoxBody, DetectionStatus, ExpectedBox
from pack_core.palletizing.cell import palletizing_cell
from pack_core.palletizing.orders.order_file import load_order
from pack_core.paths import config_path
from pack_core.robots.kr210 import LIMITS
from pack_core.rotations import angle_between
from pack_evaluation.palletizing.measures import OrderMeasures, measure_order
from pack_evaluation.palletizing.run import PalletRun
from pack_lockstep.palletizing.benchmark import OrderJob, plan_order, run_order
from pack_lockstep.palletizing.box_finder import BoxFinderConfig, open_box_finder
from pack_lockstep.palletizing.lockstep import PalletLockstep, Tick
from pack_lockstep.palletizing.settings import set_up
from pack_motion.setpoint_stream import StreamConfig
from pack_sim.palletizing.overhead_camera import PalletCameraConfig
from pack_sim.palletizing.simulator import PalletSimulator, PalletSimulatorConfig
from pallet_fsm.states import State


def order_03_cell(boxes: int = 2) -> PalletLockstep:
    """Two boxes, the first of them turned in flight; or that one alone."""
    setup = set_up(vision=False)
    order = load_order(config_path("orders", "order_03.json"))
    order = order.model_copy(update={"boxes": order.boxes[:boxes]})
    return PalletLockstep(setup.cell, order, plan_order(order, setup.layout), setup.config, seed=0)


@cache
def order_03() -> PalletRun:
    """The order, built."""
    return order_03_cell().run()


def measures() -> OrderMeasures:
    return measure_order(order_03())


@pytest.mark.timeout(300)
def test_an_order_is_built_within_its_tolerances() -> None:
    assert order_03().reason == ""
    assert measures().is_complete
    assert measures().faults == ()
    assert (measures().drops, measures().touches) == (0, 0)


@pytest.mark.timeout(300)
def test_the_next_box_comes_while_the_first_is_carried_to_the_pallet() -> None:
    """So that the camera has seconds to find it."""
    first, second = (box.name for box in order_03().boxes)
    entered = {visit.state: visit.time for visit in order_03().visits if visit.box == first}
    came = order_03().tracks[second].times[0]
    assert entered[State.ABOVE_PALLET.label] < came < entered[State.PRE_DEPOSIT.label] - 1.0


@pytest.mark.timeout(300)
def test_a_joint_trajectory_controller_puts_a_box_down_as_well_and_nearly_as_fast() -> None:
    cell = order_03_cell(boxes=1)
    stepped = cell.stepped
    arm = trajectory_driven(stepped.motion, stepped.simulator, StreamConfig(), LIMITS.velocity)
    stepped.arm = arm
    by_setpoints, by_trajectories = measures(), measure_order(cell.run())
    assert by_trajectories.is_complete
    assert by_trajectories.faults == ()
    assert arm.trouble == []
    # Each leg begins a horizon of 40 ms later than by setpoints, which have none in lockstep.
    assert by_trajectories.boxes[0].cycle_s == pytest.approx(by_setpoints.boxes[0].cycle_s, rel=0.02)


@pytest.mark.timeout(300)
def test_the_tool_follows_its_reference_within_a_millimetre() -> None:
    assert measures().position_mm[0] < 0.3
    assert measures().position_mm[1] < 1.0
    assert measures().orientation_deg[1] < 0.1


@pytest.mark.timeout(300)
def test_a_run_repeats_bit_for_bit() -> None:
    """Up to where its first box has been put down: what differed would differ from then on."""
    cell, first = order_03_cell(), order_03()

    def watch(tick: Tick) -> None:
        if tick.state is State.RETREAT:
            cell.palletizer.halt("enough")

    again = cell.run(watch)
    end = again.visits[-1].time
    n = int(np.searchsorted(again.tool.times, end))
    assert n > 1000
    assert np.array_equal(first.tool.p[:n], again.tool.p[:n])
    for name, track in again.tracks.items():
        m = int(np.searchsorted(track.times, end))
        assert np.array_equal(first.tracks[name].p[:m], track.p[:m])


@pytest.mark.timeout(300)
def test_a_motion_that_breaks_the_arms_limits_is_refused_by_its_driver_and_the_order_says_so() -> None:
    setup = set_up(motion="table_4_1", vision=False)
    line = run_order(setup, OrderJob(config_path("orders", "order_03.json"), 0))
    assert "the driver refused setpoints: acceleration of joint_a" in line["reason"]
    assert not line["measures"]["is_complete"]
    assert line["hold_mm"] is None


@pytest.mark.timeout(300)
def test_a_box_is_found_in_a_picture_where_it_stands() -> None:
    cell = palletizing_cell()
    simulator = PalletSimulator(cell, PalletSimulatorConfig(), seed=3)
    X_WB = simulator.spawn(BoxBody("a", (0.4, 0.3, 0.2), 5.0))
    config = BoxFinderConfig(by="vision", camera=PalletCameraConfig(width=1920))
    with open_box_finder(cell, config, simulator, np.random.default_rng(0)) as sight:
        found = sight.detect(ExpectedBox("a", (0.4, 0.3, 0.2), 0.0), simulator)
    assert found.status is DetectionStatus.DETECTED
    assert found.X_WB is not None
    assert np.linalg.norm(found.X_WB.p - X_WB.p) < 0.001
    assert np.degrees(angle_between(found.X_WB.q, X_WB.q)) < 0.2
