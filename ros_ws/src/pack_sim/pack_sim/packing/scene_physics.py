"""MuJoCo's model and state of a packing scene, compiled anew when an object is gripped, let go or arrives."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import mujoco
import numpy as np

from pack_core.bodies import body_pose, set_object_poses
from pack_core.joints import JointSample
from pack_core.packing.cell import PackingCell
from pack_core.packing.model import (
    TIP_JOINTS,
    ArmRole,
    HeldRole,
    build_model,
    cup_point,
    held_pose,
    tip_coordinates,
)
from pack_core.packing.scene import Scene
from pack_core.rotations import Array, Pose, conjugate, rotate
from pack_core.states import ObjectState, SceneState


def soften_contacts(model: mujoco.MjModel, width: float) -> None:
    """Have the firmness of every contact grow from nothing, so that its force is continuous.

    MuJoCo's default impedance is 0.9 at first touch: a contact takes nearly its whole load at once. What
    the held object pushes then leaves it and meets it again about a hundred times a second, and the force
    on the cup jumps between 2 and 12 N although the torques of the arm are smooth. From an impedance of 0
    on, the force grows with the penetration instead, as where cartons and shrink film give way. Under
    load the contact is no softer: 15 N press 0.5 kg in by 0.6 mm, and by 0.7 mm with the default.

    Args:
        model: changed in place.
        width: penetration at which a contact has MuJoCo's largest impedance, 0.95 [m]; 0 leaves the default.
    """
    if width > 0.0:
        # solimp: impedance at first touch, largest impedance, width, and the shape of the curve between
        model.geom_solimp[:, 0], model.geom_solimp[:, 2] = 0.0, width


STICTION = 0.999
"""Impedance of the joints' friction constraint; a softer one lets joints creep under static friction."""


@dataclass(frozen=True)
class PhysicsOptions:
    """What a scene does not say.

    Attributes:
        timestep: time step of the integrator [s].
        contact_width: depth over which contacts become hard [m].
        joint_friction: of each joint of the arm `(7,)` [N m].
    """

    timestep: float
    contact_width: float
    joint_friction: Array


class ScenePhysics:
    """The scene in motion.

    Args:
        cell: the cell's physical facts.
        scene: as it truly is.
        options: what the scene does not say.
        held: whether the new object is on the cup or free.
        time: simulated time at the start [s].
        lip_touches: whether the cup's lip touches objects, as where one is to be gripped.
        poses: where objects are, over those of the scene.

    Attributes:
        model: the present model.
        data: its state.
        R_WN: rotation `(3, 3)` of the new object, as it is now.
        R_WT: rotation of the tool.
    """

    def __init__(
        self, cell: PackingCell, scene: Scene, options: PhysicsOptions, held: HeldRole, *, time: float,
        lip_touches: bool, poses: Mapping[str, Pose],
    ) -> None:  # fmt: skip
        self._cell, self._options = cell, options
        self._compile(scene, held, time, lip_touches=lip_touches)
        self.data.qpos[self._q] = cell.robot.home
        set_object_poses(self.model, self.data, scene.poses())
        set_object_poses(self.model, self.data, dict(poses))
        mujoco.mj_forward(self.model, self.data)

    @property
    def time(self) -> float:
        """Simulated time [s]."""
        return float(self.data.time)

    @property
    def q(self) -> Array:
        """Joint positions `(7,)` [rad]."""
        return self._arm_q.copy()

    @property
    def v(self) -> Array:
        """Joint velocities `(7,)` [rad/s]."""
        return self._arm_v.copy()

    @property
    def cup_load(self) -> tuple[Array, Array]:
        """Force `(3,)` [N] and torque `(3,)` [N m] of the cup on what hangs from it, in the object's axes."""
        load = self._cup_load.copy()
        return load[:3], load[3:]

    def joints(self) -> JointSample:
        """Positions, velocities and torques of the joints."""
        return JointSample(self.time, self.q, self.v, self.data.ctrl.copy())

    def mass_matrix(self) -> Array:
        """Mass matrix `(7, 7)` of the arm with the held object [kg m^2]."""
        M = np.empty((self.model.nv, self.model.nv))
        mujoco.mj_fullM(self.model, self.data, M)
        return np.asarray(M[self._v, self._v])

    def cup_jacobian(self) -> Array:
        """Jacobian `(6, 7)` of the cup, linear part first, in the world frame."""
        J = np.empty((6, self.model.nv))
        mujoco.mj_jacBody(self.model, self.data, J[:3], J[3:], self._tool)
        return J[:, self._v]

    def cup_pressure(self) -> Array:
        """Force `(3,)` [N] of all contacts on the empty cup and pump, in world axes."""
        model, data, total, wrench = self.model, self.data, np.zeros(3), np.zeros(6)
        for i in range(data.ncon):
            contact = data.contact[i]
            bodies = model.geom_bodyid[contact.geom]
            if self._tool in bodies:
                mujoco.mj_contactForce(model, data, i, wrench)
                # the contact's frame has its axes as rows, and the force acts on the second geom
                sign = 1.0 if bodies[1] == self._tool else -1.0
                total += sign * contact.frame.reshape(3, 3).T @ wrench[:3]
        return total

    def truth(self) -> SceneState:
        """True poses and twists of all objects, the new one included; the simulation is not affected."""
        model, seen = self.model, self._seen
        seen.qpos[:], seen.qvel[:] = self.data.qpos, self.data.qvel
        for forward in (mujoco.mj_kinematics, mujoco.mj_comPos, mujoco.mj_comVel):
            forward(model, seen)
        return SceneState(
            self.time,
            {name: _object_state(model, seen, i) for name, i in zip(self._names, self._bodies, strict=True)},
        )

    def rebuild(
        self, scene: Scene, held: HeldRole, joints: JointSample, truth: SceneState, *, lip_touches: bool
    ) -> None:
        """Compile the model anew, and go on from these joints and objects; arguments as of the class."""
        self._compile(scene, held, joints.time, lip_touches=lip_touches)
        self.data.qpos[self._q], self.data.qvel[self._v] = joints.q, joints.v
        for name in self._names if held is HeldRole.FREE else scene.names:
            self._place(name, truth.objects[name])
        if held is HeldRole.COMPLIANT:
            self._hang(scene, truth.objects[scene.new_object.name].X_WO)
        mujoco.mj_forward(self.model, self.data)

    def _compile(self, scene: Scene, held: HeldRole, time: float, *, lip_touches: bool) -> None:
        options = self._options
        self.model = model = build_model(
            scene, self._cell, timestep=options.timestep, arm=ArmRole.DRIVEN, held=held,
            lip_touches=lip_touches,
        )  # fmt: skip
        for name, friction in zip(self._cell.robot.arm.joints, options.joint_friction, strict=True):
            dof = model.joint(name).dofadr[0]
            model.dof_frictionloss[dof], model.dof_solimp[dof, :2] = friction, STICTION
        soften_contacts(model, options.contact_width)
        self.data, self._seen = mujoco.MjData(model), mujoco.MjData(model)
        self.data.time = time
        self._names = [*scene.names, scene.new_object.name]
        self._bodies = [int(model.body(name).id) for name in self._names]
        self._tool = int(model.body("tool").id)
        joints = self._cell.robot.arm.joints
        # The arm is one chain, so its joints follow each other.
        first = model.joint(joints[0])
        self._q = slice(first.qposadr[0], first.qposadr[0] + len(joints))
        self._v = slice(first.dofadr[0], first.dofadr[0] + len(joints))
        self._keep_views(self.data, scene.new_object.name)

    def _keep_views(self, data: mujoco.MjData, new_object: str) -> None:
        """Keep views of what every step reads; to look them up takes as long as to compute with them."""
        self._arm_q: Array = data.qpos[self._q]
        self._arm_v: Array = data.qvel[self._v]
        self.R_WN: Array = _read_only(data.body(new_object).xmat)
        self.R_WT: Array = _read_only(data.body("tool").xmat)
        # the sensors tip_force and tip_torque are the first of the model
        self._cup_load: Array = data.sensordata[:6]

    def _place(self, name: str, state: ObjectState) -> None:
        set_object_poses(self.model, self.data, {name: state.X_WO})
        v = self.model.joint(name).dofadr[0]
        self.data.qvel[v : v + 3] = state.v_WO_W
        # MuJoCo has a free joint's angular velocity in the body's axes
        self.data.qvel[v + 3 : v + 6] = rotate(conjugate(state.X_WO.q), state.w_WO_W)

    def _hang(self, scene: Scene, X_WN: Pose) -> None:
        """Set the cup's springs so that the held object is where it was gripped."""
        mujoco.mj_kinematics(self.model, self.data)
        X_TN = body_pose(self.data, "tool").inverse() @ X_WN
        coordinates = tip_coordinates(held_pose(scene), X_TN, cup_point(scene))
        for name, value in zip(TIP_JOINTS, coordinates, strict=True):
            self.data.joint(name).qpos[0] = value


def _read_only(xmat: Array) -> Array:
    """A view `(3, 3)` of a body's rotation that nobody writes to."""
    R = xmat.reshape(3, 3)
    R.setflags(write=False)
    return R


def _object_state(model: mujoco.MjModel, data: mujoco.MjData, body: int) -> ObjectState:
    twist = np.empty(6)
    mujoco.mj_objectVelocity(model, data, mujoco.mjtObj.mjOBJ_XBODY, body, twist, 0)
    # MuJoCo gives the angular part first
    return ObjectState(Pose(data.xpos[body], data.xquat[body]), twist[3:], twist[:3])
