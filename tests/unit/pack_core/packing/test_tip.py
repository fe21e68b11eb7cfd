"""The compliant cup against closed forms."""

from __future__ import annotations

import mujoco
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pack_core.bodies import body_pose
from pack_core.errors import ConfigError
from pack_core.packing.cell import PackingCell, Tip, packing_cell
from pack_core.packing.model import (
    TIP_JOINTS,
    ArmRole,
    HeldRole,
    build_model,
    cup_point,
    held_pose,
    tip_coordinates,
)
from pack_core.robots.panda import PANDA
from pack_core.rotations import Array, Pose, angle_between, exp

TIP = Tip(lateral=6000.0, axial=8000.0, bending=15.0, twist=20.0, damping_time=0.006)
STIFFNESS = np.array([6000.0, 6000.0, 8000.0, 15.0, 15.0, 20.0])
CELL = packing_cell().model_copy(update={"tip": TIP})
HELD = CELL.scene.new_object
LOADS = np.array([20.0, 20.0, 40.0, 0.5, 0.5, 0.5])
"""[N, N m]"""


def cell_without_objects(cell: PackingCell = CELL, mass: float = HELD.mass) -> PackingCell:
    held = HELD.model_copy(update={"mass": mass})
    return cell.model_copy(
        update={"scene": cell.scene.model_copy(update={"objects": [], "new_object": held})}
    )


def hanging(cell: PackingCell) -> tuple[mujoco.MjModel, mujoco.MjData]:
    """The arm at home, too heavy to be moved, with the object on the cup and no gravity."""
    model = build_model(cell.scene, cell, timestep=0.001, arm=ArmRole.GUIDED, held=HeldRole.COMPLIANT)
    data = mujoco.MjData(model)
    for name, angle in zip(PANDA.joints, cell.robot.home, strict=True):
        data.joint(name).qpos[0] = angle
        model.joint(name).armature[0] = 1e9
    model.opt.gravity[:] = 0.0
    mujoco.mj_forward(model, data)
    return model, data


def tip_of(data: mujoco.MjData) -> Array:
    return np.array([data.joint(name).qpos[0] for name in TIP_JOINTS])


def load_at_the_cup(data: mujoco.MjData, force_N: Array, torque_N: Array) -> None:
    """Load the held object at the middle of its top, in its axes."""
    R_WN = data.body(HELD.name).xmat.reshape(3, 3)
    p_WP = R_WN @ [0.0, 0.0, HELD.half_extents[2]]
    force, torque = R_WN @ force_N, R_WN @ torque_N
    data.body(HELD.name).xfrc_applied[:] = [*force, *(torque + np.cross(p_WP, force))]


@pytest.mark.parametrize("axis", range(6))
def test_a_steady_load_deflects_the_cup_by_load_over_stiffness(axis: int) -> None:
    model, data = hanging(cell_without_objects())
    load = LOADS[axis] * np.eye(6)[axis]
    load_at_the_cup(data, load[:3], load[3:])
    mujoco.mj_step(model, data, 1500)
    np.testing.assert_allclose(tip_of(data), load / STIFFNESS, rtol=1e-3, atol=1e-5)


def test_a_hanging_object_stretches_the_cup_by_its_weight() -> None:
    model, data = hanging(cell_without_objects())
    model.opt.gravity[2] = -9.81
    mujoco.mj_step(model, data, 300)
    assert tip_of(data)[2] == pytest.approx(-HELD.mass * 9.81 / TIP.axial, rel=0.01)


def test_two_newton_metres_bend_it_by_eight_degrees() -> None:
    assert np.rad2deg(2.0 / TIP.bending) == pytest.approx(7.6, abs=0.1)


@pytest.mark.parametrize("mass", [0.05, 0.5, 2.0])
def test_a_deflected_cup_comes_to_rest_at_a_millisecond_step(mass: float) -> None:
    model, data = hanging(cell_without_objects(mass=mass))
    start = 3.0 * LOADS / STIFFNESS
    for name, value in zip(TIP_JOINTS, start, strict=True):
        data.joint(name).qpos[0] = value
    energies = []
    for _ in range(3000):
        mujoco.mj_step(model, data)
        mujoco.mj_energyPos(model, data)
        mujoco.mj_energyVel(model, data)
        energies.append(float(data.energy.sum()))
    assert max(energies) < 1.05 * 0.5 * float(STIFFNESS @ start**2)
    assert energies[-1] < 1e-4 * energies[0]


@settings(max_examples=30)
@given(
    shift=st.lists(st.floats(-0.01, 0.01), min_size=3, max_size=3),
    turn=st.lists(st.floats(-0.3, 0.3), min_size=3, max_size=3),
)
def test_coordinates_bring_the_object_where_they_are_told(shift: list[float], turn: list[float]) -> None:
    cell = cell_without_objects()
    nominal = held_pose(cell.scene)
    wanted = nominal @ Pose(np.array(shift), exp(turn))
    model, data = HANGING
    for name, value in zip(TIP_JOINTS, tip_coordinates(nominal, wanted, cup_point(cell.scene)), strict=True):
        data.joint(name).qpos[0] = value
    mujoco.mj_kinematics(model, data)
    X_TN = body_pose(data, "tool").inverse() @ body_pose(data, HELD.name)
    np.testing.assert_allclose(X_TN.p, wanted.p, atol=1e-9)
    assert angle_between(X_TN.q, wanted.q) < 1e-7


HANGING = hanging(cell_without_objects())


def test_a_cup_without_springs_cannot_be_compliant() -> None:
    cell = packing_cell()
    with pytest.raises(ConfigError, match=r"`tip` in config/cells/packing\.yaml"):
        build_model(cell.scene, cell, timestep=0.001, arm=ArmRole.DRIVEN, held=HeldRole.COMPLIANT)


def test_a_rigid_grip_stays_rigid_in_a_cell_with_springs() -> None:
    rigid = [
        build_model(cell.scene, cell, timestep=0.001, arm=ArmRole.DRIVEN, held=HeldRole.RIGID)
        for cell in (packing_cell(), CELL)
    ]
    assert rigid[0].nq == rigid[1].nq


def test_what_is_steered_on_a_tip_gives_way_as_both_springs_together() -> None:
    """1 / k = 1 / k1 + 1 / k2 of the joints' servos and the cup."""
    scene = packing_cell().scene.model_copy(update={"objects": []}).description()
    tip = Tip(lateral=500.0, axial=4000.0, bending=10.0, twist=30.0, damping_time=0.006)
    gains = {}
    for name, springs in (("rigid", None), ("compliant", tip)):
        cell = packing_cell().model_copy(update={"tip": springs})
        model = build_model(scene, cell, timestep=0.006, arm=ArmRole.ABSENT, held=HeldRole.STEERED)
        gains[name] = np.array([model.actuator(f"steering_{i}").gainprm[0] for i in range(6)])
    np.testing.assert_allclose(1.0 / gains["compliant"], 1.0 / gains["rigid"] + 1.0 / np.array(tip.stiffness))
