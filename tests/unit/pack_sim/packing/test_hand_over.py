"""Objects that are handed over, gripped where they stand, and let go."""

from __future__ import annotations

import numpy as np
import pytest

from pack_core.bodies import body_pose
from pack_core.packing.cell import packing_cell
from pack_core.packing.model import held_pose
from pack_core.packing.objects import Box, Cylinder
from pack_core.packing.packing_list import PackingList, handed_over
from pack_core.rotations import Pose, angle_between, exp, from_yaw
from pack_sim.packing.hand_over import HandOverConfig, presented_pose, seal_fault
from pack_sim.packing.simulator import Simulator, SimulatorConfig

CELL = packing_cell()
CARTON = Box(name="carton", shape="box", size=(0.09, 0.06, 0.1), mass=0.3)
CAN = Cylinder(name="can", shape="cylinder", radius=0.034, height=0.08, mass=0.3)
LIST = PackingList(objects=[CARTON, CAN])
NOMINAL = held_pose(LIST.start(CELL))
RADIUS = CELL.pump.cup_radius


def simulator() -> Simulator:
    return Simulator(CELL, LIST.start(CELL), SimulatorConfig(), np.random.default_rng(1))


def put(cell: Simulator, X_WN: Pose) -> None:
    """Put the new object somewhere at rest."""
    first = cell.model.joint(cell.scene.new_object.name).qposadr[0]
    cell.data.qpos[first : first + 7] = [*X_WN.p, *X_WN.q]


def under_the_cup(cell: Simulator) -> Pose:
    return body_pose(cell.data, "tool") @ NOMINAL


@pytest.mark.parametrize(
    ("shift", "turn", "reason"),
    [
        ([0.0, 0.0, 0.0], [0.0, 0.0, 0.0], ""),
        ([0.006, -0.004, 0.001], [0.0, 0.0, 1.0], ""),
        ([0.0, 0.0, 0.005], [0.0, 0.0, 0.0], "over the object's top"),
        ([0.0, 0.020, 0.0], [0.0, 0.0, 0.0], "lip"),
        ([0.0, 0.0, 0.0], [0.15, 0.0, 0.0], "tilted"),
    ],
)
def test_the_cup_seals_near_enough_on_top_and_nowhere_else(
    shift: list[float], turn: list[float], reason: str
) -> None:
    # the object turns about the middle of its top, where the cup is
    top = np.array([0.0, 0.0, CARTON.half_extents[2]])
    X_TN = NOMINAL @ Pose(top) @ Pose(np.array(shift) * [1, 1, -1], exp(turn)) @ Pose(-top)
    fault = seal_fault(X_TN, CARTON, RADIUS)
    assert (reason in fault) if reason else not fault


def test_where_an_object_truly_stands_is_off_by_no_more_than_configured() -> None:
    config, rng = HandOverConfig(position=0.004, yaw_deg=3.0), np.random.default_rng(0)
    there = [presented_pose(Pose(np.zeros(3)), config, rng) for _ in range(50)]
    assert np.abs([X.p[:2] for X in there]).max() == pytest.approx(0.004, rel=0.1)
    assert np.abs([X.p[2] for X in there]).max() == 0.0
    assert max(angle_between(X.q, from_yaw(0.0)) for X in there) <= np.deg2rad(3.0)


def test_an_object_is_gripped_where_it_stands_and_hangs_there() -> None:
    cell = simulator()
    assert not cell.pump.state.is_closed
    assert "over the object's top" in cell.grip()
    off = under_the_cup(cell) @ Pose(np.array([0.006, 0.004, 0.0]), from_yaw(0.4))
    put(cell, off)
    cell.step()
    assert cell.grip() == ""
    for _ in range(300):
        cell.step()
    held, X_WT = body_pose(cell.data, "carton"), body_pose(cell.data, "tool")
    X_TN = X_WT.inverse() @ held
    expected = NOMINAL @ Pose(np.array([0.006, 0.004, 0.0]), from_yaw(0.4))
    np.testing.assert_allclose(X_TN.p, expected.p, atol=1e-3)
    assert angle_between(X_TN.q, expected.q) < 0.01


def test_the_next_object_replaces_one_that_was_not_packed_and_joins_one_that_was() -> None:
    cell, next_one = simulator(), handed_over(CAN, CELL)
    container = CELL.scene.container
    assert cell.present(next_one) == ""
    assert cell.scene.names == []
    assert cell.description.new_object.name == "can"
    put(cell, Pose(np.array([*container.centre, CAN.half_extents[2]])))
    cell.step()
    assert "in the container already" in cell.present(next_one)  # it is the one that was packed last
    assert cell.present(handed_over(CARTON, CELL)) == ""
    assert cell.scene.names == cell.description.names == ["can"]
    assert cell.truth().objects["can"].X_WO.p[:2] == pytest.approx(container.centre, abs=0.002)
    assert "in the container already" in cell.present(next_one)


def test_nothing_is_handed_over_while_the_pump_holds_an_object() -> None:
    cell = simulator()
    put(cell, under_the_cup(cell))
    cell.step()
    cell.grip()
    assert "the pump holds 'carton'" in cell.present(handed_over(CAN, CELL))


def test_what_presses_on_the_empty_cup_is_felt() -> None:
    cell = simulator()
    put(cell, under_the_cup(cell))
    up = cell.model.joint("carton").dofadr[0] + 2
    cell.data.qvel[up] = 0.3  # it comes up against the lip
    for _ in range(3):
        cell.step()
    force, _ = cell.external_wrench()
    assert force[2] > 1.0


def test_the_wrench_is_less_the_weight_of_the_object_that_hangs_now() -> None:
    cell, heavy = simulator(), Box(name="heavy", shape="box", size=(0.09, 0.06, 0.1), mass=0.9)
    for item in (CARTON, heavy):
        if item is heavy:
            cell.release()
            assert cell.present(handed_over(heavy, CELL)) == ""
        put(cell, under_the_cup(cell))
        cell.step()
        assert cell.grip() == ""
        for _ in range(1000):
            cell.step()
        assert np.linalg.norm(cell.external_wrench()[0]) < 0.05 * 9.81 * item.mass
