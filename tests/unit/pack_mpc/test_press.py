"""Pressing on the held object while it halts: a force down, stated as torque."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pack_core.joints import Setpoints
from pack_core.packing.cell import packing_cell
from pack_core.rotations import Array
from pack_mpc.controller import pressing
from pack_mpc.plant import PackingPlant
from pack_mpc.task.stages import PressConfig

HOME = np.array(packing_cell().robot.home)
CONFIG = PressConfig(force=20.0, rate=40.0, delay=0.15)


def setpoints_at(q: Array) -> Setpoints:
    return Setpoints(1.0, np.array([0.0, 0.1]), np.stack([q, q + 0.01]), np.zeros((2, 7)), np.ones((2, 7)))


@pytest.mark.parametrize(("halt", "force"), [(0.0, 0.0), (0.15, 0.0), (0.4, 10.0), (0.65, 20.0), (9.0, 20.0)])
def test_the_force_grows_once_the_object_has_halted_for_a_while(halt: float, force: float) -> None:
    assert CONFIG.after(halt) == pytest.approx(force)


@given(offset=st.lists(st.floats(-0.3, 0.3), min_size=7, max_size=7))
def test_the_torques_do_the_work_of_the_force(plant: PackingPlant, offset: list[float]) -> None:
    """By virtual work, tau' dq = f' dp for every small step dq of the joints."""
    q, step = HOME + offset, 1e-6

    def height(q: Array) -> float:
        x = np.zeros(plant.nx)
        x[plant.layout.q] = q
        return float(plant.held_position(x)[2])

    slope = np.array([height(q + d) - height(q - d) for d in step * np.eye(7)]) / (2.0 * step)
    before = setpoints_at(q)
    added = pressing(plant, before, 10.0).tau - before.tau
    np.testing.assert_allclose(added, np.tile(-10.0 * slope, (2, 1)), atol=1e-6)


def test_without_a_force_the_setpoints_are_the_same(plant: PackingPlant) -> None:
    before = setpoints_at(HOME)
    assert pressing(plant, before, 0.0) is before


def test_no_torque_is_beyond_the_arms_limits(plant: PackingPlant) -> None:
    limit = packing_cell().robot.arm.limits.effort
    tau = pressing(plant, setpoints_at(HOME), 1000.0).tau
    assert np.all(np.abs(tau) <= limit)
    assert np.any(np.abs(tau) == limit)
