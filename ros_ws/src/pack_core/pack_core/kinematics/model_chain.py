"""The serial chain in a MuJoCo model."""

from __future__ import annotations

from collections.abc import Sequence

import mujoco

from pack_core.errors import PackError
from pack_core.kinematics.chain import SerialChain


def chain_from_model(model: mujoco.MjModel, joints: Sequence[str], tool: str) -> SerialChain:
    """The hinges named `joints`, from base to tip, and the body `tool` that the last one carries.

    Raises:
        PackError: a joint is no hinge, or does not carry the tool.
    """
    data = mujoco.MjData(model)
    # Other joints, such as fingers or gears, stay at their references; those of the chain go to zero, which
    # need not be their reference.
    data.qpos[:] = model.qpos0
    for name in joints:
        data.qpos[model.joint(name).qposadr[0]] = 0.0
    mujoco.mj_kinematics(model, data)
    carriers = _ancestors(model, model.body(tool).id)
    for name in joints:
        joint = model.joint(name)
        if joint.type[0] != mujoco.mjtJoint.mjJNT_HINGE or joint.bodyid[0] not in carriers:
            raise PackError(f"joint '{name}' must be a hinge that carries the body '{tool}'")
    index = [model.joint(name).id for name in joints]
    body = data.body(tool)
    return SerialChain(
        data.xaxis[index].copy(), data.xanchor[index].copy(), body.xmat.reshape(3, 3).copy(), body.xpos.copy()
    )


def _ancestors(model: mujoco.MjModel, body: int) -> set[int]:
    found = set()
    while body != 0:
        found.add(body)
        body = int(model.body_parentid[body])
    return found
