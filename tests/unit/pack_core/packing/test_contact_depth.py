"""Contacts of the packing cell are as deep as the objects overlap, whatever their tilts."""

from __future__ import annotations

from functools import cache

import mujoco
import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from scipy.optimize import brentq

from pack_core.packing.cell import packing_cell
from pack_core.packing.model import ArmRole, HeldRole, build_model
from pack_core.rotations import Array, exp, from_yaw, multiply, rotate

CELL = packing_cell()
HELD = CELL.scene.new_object
TIN = next(item for item in CELL.scene.objects if item.name == "coffee_tin")
P_WT = np.array([*CELL.scene.container.centre, TIN.half_extents[2]])
"""The tin stands in the middle of the container [m]."""
SIDES = 128
"""Of the prism that stands for the tin; it is 11 micrometres narrower than the tin at most."""

around = np.linspace(0.0, 2 * np.pi, SIDES, endpoint=False)
rim = TIN.half_extents[0] * np.column_stack([np.cos(around), np.sin(around)])
TIN_CORNERS = np.vstack(
    [np.column_stack([rim, np.full(SIDES, z)]) for z in TIN.half_extents[2] * np.array([-1, 1])]
)
TIN_NORMALS = np.vstack(
    [
        np.column_stack([np.cos(around + np.pi / SIDES), np.sin(around + np.pi / SIDES), 0.0 * around]),
        np.eye(3)[2],
    ]
)
TIN_EDGES = np.vstack([np.diff(TIN_CORNERS[:SIDES], axis=0, append=TIN_CORNERS[:1]), np.eye(3)[2]])
BOX_CORNERS = HELD.half_extents * np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)])


def overlap(p_TN: Array, q_WN: Array) -> float:
    """How far one of the two must be moved until they are apart [m], negative if they are.

    The shortest way apart of two convex polyhedra is along a normal of a face of one of them, or normal to an
    edge of each (the separating axes).
    """
    axes = np.array([rotate(q_WN, axis) for axis in np.eye(3)])
    across = np.cross(axes[:, None], TIN_EDGES).reshape(-1, 3)
    lengths = np.linalg.norm(across, axis=1)
    parallel = lengths < 1e-9
    normals = np.vstack([axes, TIN_NORMALS, across[~parallel] / lengths[~parallel, None]])
    box = p_TN + np.array([rotate(q_WN, corner) for corner in BOX_CORNERS])
    of_box, of_tin = normals @ box.T, normals @ TIN_CORNERS.T
    forwards, back = of_tin.max(axis=1) - of_box.min(axis=1), of_box.max(axis=1) - of_tin.min(axis=1)
    return float(min(forwards.min(), back.min()))


@cache
def both() -> mujoco.MjModel:
    """The cell's model with the tin and the free object."""
    scene = CELL.scene.model_copy(update={"objects": [TIN]})
    return build_model(scene, CELL, timestep=0.001, arm=ArmRole.ABSENT, held=HeldRole.FREE)


def deepest_contact(p_TN: Array, q_WN: Array) -> float:
    """Depth of the deepest contact between the two in that model [m]."""
    model = both()
    data = mujoco.MjData(model)
    data.joint(TIN.name).qpos[:] = [*P_WT, 1.0, 0.0, 0.0, 0.0]
    data.joint(HELD.name).qpos[:] = [*(P_WT + p_TN), *q_WN]
    mujoco.mj_forward(model, data)
    pair = {model.geom(TIN.name).id, model.geom(HELD.name).id}
    return max((-c.dist for c in data.contact if {c.geom1, c.geom2} == pair), default=0.0)


tilts = st.tuples(st.floats(-0.6, 0.6), st.floats(-0.6, 0.6))
headings = st.floats(0.0, 2 * np.pi)


@given(tilt=tilts, yaw=headings, aside=st.tuples(st.floats(-0.06, 0.06), st.floats(-0.06, 0.06)))
def test_a_tilted_box_on_a_tin_is_as_deep_in_it_as_they_overlap(
    tilt: tuple[float, float], yaw: float, aside: tuple[float, float]
) -> None:
    q_WN = multiply(exp(np.array([*tilt, 0.0])), from_yaw(yaw))

    def too_deep(z: float) -> float:
        return overlap(np.array([*aside, z]), q_WN) - 0.004

    # lowered until it overlaps by about 4 mm, or lies beside the tin
    height = brentq(too_deep, 0.0, 0.4, xtol=1e-4) if too_deep(0.0) > 0.0 else 0.0
    p_TN = np.array([*aside, height])
    assert abs(deepest_contact(p_TN, q_WN) - max(overlap(p_TN, q_WN), 0.0)) < 5e-5
