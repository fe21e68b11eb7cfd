"""The dynamics that the joint controller believes in."""

import mujoco
import numpy as np

from pack_core.palletizing.arm_dynamics import CarriedLoad
from pack_core.palletizing.boxes import BoxBody
from pack_core.palletizing.cell import palletizing_cell
from pack_core.rotations import Array, Pose

BOX = BoxBody("box", (0.4, 0.3, 0.25), 16.6)
X_TB = Pose(np.array([0.0, 0.0, 0.126]))


def holding_torque(load: CarriedLoad) -> Array:
    """Torques `(6,)` that hold the arm still at home."""
    data = mujoco.MjData(load.model)
    data.qpos[:] = palletizing_cell().arm.home
    mujoco.mj_inverse(load.model, data)
    return data.qfrc_inverse.copy()


def test_a_load_adds_its_weight_at_the_arm() -> None:
    """By the principle of virtual work: J^T times the weight."""
    load = CarriedLoad(palletizing_cell())
    bare = holding_torque(load)
    load.put_on(BOX, X_TB)
    data = mujoco.MjData(load.model)
    data.qpos[:] = palletizing_cell().arm.home
    mujoco.mj_kinematics(load.model, data)
    mujoco.mj_comPos(load.model, data)
    J = np.zeros((3, 6))
    mujoco.mj_jac(
        load.model, data, J, None, data.body("tool").xpos - [0, 0, 0.126], load.model.body("tool").id
    )
    expected = J.T @ [0.0, 0.0, 9.81 * BOX.mass]
    np.testing.assert_allclose(holding_torque(load) - bare, expected, atol=0.1)


def test_taking_it_off_gives_the_bare_arm_back() -> None:
    load = CarriedLoad(palletizing_cell())
    bare = holding_torque(load)
    load.put_on(BOX, X_TB)
    load.take_off()
    np.testing.assert_allclose(holding_torque(load), bare, atol=1e-9)
