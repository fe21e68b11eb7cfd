"""A simulated arm that lowers the held object into the container and pushes others with it."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import mujoco
import numpy as np
import numpy.typing as npt

from pack_core.joints import JointSample, Setpoints
from pack_core.packing.cell import packing_cell
from pack_core.packing.markers import MarkerFrame
from pack_core.packing.scene import Scene
from pack_core.robots.panda import PANDA
from pack_core.rotations import POINTING_DOWN, Array, Pose, conjugate, from_yaw, log, multiply
from pack_core.states import SceneState
from pack_sim.packing.simulator import Simulator, SimulatorConfig

POSITIONS = {
    "soup_can": (0.59, -0.06),
    "coffee_tin": (0.41, 0.068),
    "tea_box": (0.53, 0.02),
    "cracker_box": (0.57, 0.08),
    "sugar_box": (0.44, -0.073),
}
START, CONTACT, END = 0.0, 2.0, 4.4
WAYPOINTS = np.array(
    [
        # time [s], cup x, y, z [m], yaw [rad]
        [START, 0.5, 0.0, 0.45, 0.0],
        [0.5, 0.445, -0.004, 0.40, 0.0],
        [1.5, 0.445, -0.004, 0.21, 0.0],
        [CONTACT, 0.445, -0.004, 0.21, 0.0],
        [3.0, 0.485, 0.02, 0.21, 0.2],
        [4.0, 0.495, -0.01, 0.21, 0.4],
        [END, 0.485, -0.015, 0.21, 0.45],
    ]
)
PERIOD = 0.02


@dataclass(frozen=True)
class Moment:
    """What the sensors deliver at one joint sample, and how it really is."""

    joints: JointSample
    frames: list[MarkerFrame]
    truth: SceneState


def standing_scene() -> Scene:
    """The cell's five objects, upright and apart from each other."""
    scene = packing_cell().scene
    poses = {
        item.name: Pose(np.array([*POSITIONS[item.name], item.half_extents[2]])) for item in scene.objects
    }
    return scene.with_poses(poses)


def pushing_run(seed: int, until: float = END) -> Iterator[Moment]:
    """The sensors' data at 500 Hz, from above the container to after two seconds of pushing."""
    simulator = Simulator(packing_cell(), standing_scene(), SimulatorConfig(), np.random.default_rng(seed))
    times = np.arange(START, END + 0.1, PERIOD)
    qs = _joint_path(simulator.model, times)
    vs = np.gradient(qs, times, axis=0)
    step = 0
    while simulator.time < until:
        if step % 20 == 0:
            now = slice(step // 20, step // 20 + 6)
            offsets = times[now] - times[now][0]
            torques = np.zeros_like(qs[now])
            simulator.accept(Setpoints(simulator.time, offsets, qs[now], vs[now], torques))
        simulator.step()
        step += 1
        if step % 2 == 0:
            yield Moment(simulator.joints(), simulator.mocap.due(simulator.time), simulator.truth())


def without(frame: MarkerFrame, hidden: set[str]) -> MarkerFrame:
    """The frame as cameras that cannot see some objects would deliver it."""
    return _kept(frame, np.array([frame.objects[i] not in hidden for i in frame.object_index], dtype=bool))


def only(frame: MarkerFrame, name: str, markers: tuple[int, ...]) -> MarkerFrame:
    """The frame as cameras that see no other markers of an object would deliver it."""
    is_other = frame.object_index != frame.objects.index(name)
    return _kept(frame, is_other | np.isin(frame.marker_index, markers))


def _kept(frame: MarkerFrame, keep: npt.NDArray[np.bool_]) -> MarkerFrame:
    return replace(
        frame, object_index=frame.object_index[keep], marker_index=frame.marker_index[keep],
        p_WM=frame.p_WM[keep], cameras=frame.cameras[keep],
    )  # fmt: skip


def _joint_path(model: mujoco.MjModel, times: Array) -> Array:
    """Joint positions `(T, 7)` that take the cup along the way-points, by damped least squares."""
    data, tool = mujoco.MjData(model), model.body("tool").id
    first, dof = model.joint(PANDA.joints[0]).qposadr[0], model.joint(PANDA.joints[0]).dofadr[0]
    q, path, J = np.array(packing_cell().robot.home), [], np.empty((6, model.nv))
    for time in times:
        x, y, z, yaw = (np.interp(time, WAYPOINTS[:, 0], column) for column in WAYPOINTS[:, 1:].T)
        q_WT = multiply(from_yaw(yaw), POINTING_DOWN)
        for _ in range(20):
            data.qpos[first : first + 7] = q
            mujoco.mj_kinematics(model, data)
            mujoco.mj_comPos(model, data)
            mujoco.mj_jacBody(model, data, J[:3], J[3:], tool)
            turn = log(multiply(q_WT, conjugate(data.xquat[tool])))
            error = np.concatenate([np.array([x, y, z]) - data.xpos[tool], turn])
            arm = J[:, dof : dof + 7]
            q = q + arm.T @ np.linalg.solve(arm @ arm.T + 1e-6 * np.eye(6), error)
        path.append(q)
    return np.array(path)
