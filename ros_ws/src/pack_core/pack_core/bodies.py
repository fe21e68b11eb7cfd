"""Bodies of a MuJoCo model: put in place, read out, and checked for penetration."""

from __future__ import annotations

import mujoco

from pack_core.rotations import Pose


def set_object_poses(model: mujoco.MjModel, data: mujoco.MjData, poses: dict[str, Pose]) -> None:
    """Put free bodies at X_WO, at rest; names without a free joint are an error (KeyError)."""
    for name, X_WO in poses.items():
        joint = model.joint(name)
        q, v = joint.qposadr[0], joint.dofadr[0]
        data.qpos[q : q + 7] = [*X_WO.p, *X_WO.q]  # a free joint: position, then quaternion wxyz
        data.qvel[v : v + 6] = 0.0


def penetrations(model: mujoco.MjModel, data: mujoco.MjData) -> dict[tuple[str, str], float]:
    """Deepest penetration [m] of every pair of geoms that touch at the positions in `data`."""
    # Positions and collisions alone: mj_forward would also compute forces.
    mujoco.mj_kinematics(model, data)
    mujoco.mj_comPos(model, data)
    mujoco.mj_collision(model, data)
    deepest: dict[tuple[int, int], float] = {}
    for (a, b), distance in zip(data.contact.geom.tolist(), data.contact.dist.tolist(), strict=True):
        # MuJoCo's distance is negative where geoms overlap; one pair may touch in several points.
        deepest[a, b] = max(deepest.get((a, b), 0.0), -distance)
    names = {i: mujoco.mj_id2name(model, mujoco.mjtObj.mjOBJ_GEOM, i) or "" for pair in deepest for i in pair}
    return {(names[a], names[b]): depth for (a, b), depth in deepest.items()}


def body_pose(data: mujoco.MjData, name: str) -> Pose:
    """X_WB of a body after forward kinematics."""
    body = data.body(name)
    return Pose(body.xpos, body.xquat)
