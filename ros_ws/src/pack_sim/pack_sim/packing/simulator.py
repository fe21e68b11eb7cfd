"""The simulated cell: MuJoCo physics with the interface of a robot driver."""

from __future__ import annotations

import mujoco
import numpy as np

from pack_core.bodies import body_pose, set_object_poses
from pack_core.joints import JointSample, Setpoints
from pack_core.packing.cell import PackingCell
from pack_core.packing.free_space import is_packed
from pack_core.packing.model import ArmRole, HeldRole, build_model, cup_point, held_pose
from pack_core.packing.objects import ObjectModel
from pack_core.packing.scene import Scene
from pack_core.packing.tip import TIP_JOINTS, tip_coordinates
from pack_core.rotations import Array, Pose, angle_between, conjugate, rotate
from pack_core.states import ObjectState, SceneState
from pack_sim.packing.contacts import soften_contacts
from pack_sim.packing.governor import ContactGovernor
from pack_sim.packing.hand_over import presented_pose, seal_fault
from pack_sim.packing.joint_controller import JointController
from pack_sim.packing.mismatch import actual, actual_object, believed, believed_object, joint_friction
from pack_sim.packing.mocap import MocapSystem
from pack_sim.packing.payload import PayloadCompensation
from pack_sim.packing.pump import PumpModel
from pack_sim.packing.simulator_config import SimulatorConfig
from pack_sim.packing.wrench_sensor import WrenchSensor

GRIP_DISTANCE = 0.005
GRIP_ANGLE = np.deg2rad(2.0)
"""The pump can grip an object that is at most this far from where it would hang [m] and [rad]."""
STICTION = 0.999
"""Impedance of the joints' friction constraint; a softer one lets joints creep under static friction."""


class Simulator:
    """Simulates one scene.

    Args:
        cell: the cell's physical facts.
        scene: the scene, with a pose for every object.
        config: rates and limits.
        rng: source of the sensors' noise and of the errors of the description.
        time: simulated time at the start [s].

    Attributes:
        scene: the scene as it truly is, with true friction and masses.
        description: the scene as the nodes know it.
    """

    def __init__(
        self,
        cell: PackingCell,
        scene: Scene,
        config: SimulatorConfig,
        rng: np.random.Generator,
        time: float = 0.0,
    ) -> None:
        self.cell, self.config = cell, config
        self._truth_rng, self._belief_rng, arm_rng, wrench_rng, self._hand_over_rng = rng.spawn(5)
        self.scene = actual(scene, config.mismatch, self._truth_rng)
        self.description = believed(scene, config.mismatch, self._belief_rng)
        self._is_handed_over = scene.is_handed_over
        self._joint_friction = joint_friction(config.mismatch, len(cell.robot.arm.joints), arm_rng)
        governor = None if config.governor is None else ContactGovernor(config.governor, config.timestep)
        self.controller = JointController(cell.robot, config.watchdog, governor, config.friction_compensation)
        self.pump = PumpModel(cell.suction, config.timestep, is_closed=not scene.is_handed_over)
        self._rng = rng
        self.mocap = MocapSystem(self.scene, cell, config.mocap, rng)
        self._wrench_sensor = WrenchSensor(config.wrench_sensor, config.timestep, wrench_rng)
        self._held = HeldRole.RIGID if cell.tip is None else HeldRole.COMPLIANT
        self.model = self._compile(HeldRole.FREE if scene.is_handed_over else self._held)
        self.data = mujoco.MjData(self.model)
        self.data.time = time
        self._index()
        self.data.qpos[self._q] = cell.robot.home
        set_object_poses(self.model, self.data, scene.poses())
        if scene.is_handed_over:
            set_object_poses(self.model, self.data, {scene.new_object.name: self._presented()})
        mujoco.mj_forward(self.model, self.data)

    @property
    def time(self) -> float:
        """Simulated time [s]."""
        return float(self.data.time)

    @property
    def _weight(self) -> Array:
        gravity = float(self.model.opt.gravity[2])
        return np.array([0.0, 0.0, -gravity * self.description.new_object.mass])

    def accept(self, setpoints: Setpoints) -> None:
        """Pass setpoints to the joint controller; raises MessageError if they are refused."""
        self.controller.accept(setpoints, self.time)

    def change_sensors(self, config: SimulatorConfig) -> None:
        """Measure with other errors from now on; all else in `config` is as it was."""
        if config.wrench_sensor != self.config.wrench_sensor:
            self._wrench_sensor.configure(config.wrench_sensor)
        self.mocap.config = config.mocap
        self.config = config

    def step(self) -> None:
        """Advance by one time step: control, physics, pump and sensors."""
        data = self.data
        q, v = data.qpos[self._q], data.qvel[self._v]
        if self.config.governor is not None:
            force, torque = self.external_wrench()
            bending = float(np.hypot(torque[0], torque[1]))
            self.controller.update_contact(
                self.time, self._tip_rotation() @ force, bending, v, self._cup_jacobian
            )
        data.ctrl[:] = self.controller.torque(self.time, q, v, self._mass_matrix)
        if self.pump.state.is_closed:
            self._payload.apply(self.model, data)
        mujoco.mj_step(self.model, data)
        self._wrench_sensor.advance()
        if self.pump.state.is_closed:
            force, torque = self._cup_load()
            if not self.pump.update(force, torque):
                self._swap(HeldRole.FREE)
        self.mocap.update(self.model, data, self.time)

    def joints(self) -> JointSample:
        """Measured positions, velocities and torques of the joints."""
        d = self.data
        return JointSample(self.time, d.qpos[self._q].copy(), d.qvel[self._v].copy(), d.ctrl.copy())

    def external_wrench(self) -> tuple[Array, Array]:
        """Measured external force `(3,)` [N] and torque `(3,)` [N m] on the held object.

        They are given in the frame of site `tip`, at the middle of the held object's top and with the axes of
        the object N, without the object's described weight. If nothing is held, they are what presses on the
        cup, in the axes of an object that would hang upright from it.
        """
        if not self.pump.state.is_closed:
            return self._wrench_sensor.read(self._tip_rotation().T @ self._pressure(), np.zeros(3))
        force, torque = self._cup_load()
        R_WN = self._tip_rotation()
        return self._wrench_sensor.read(R_WN.T @ self._weight - force, -torque)

    def truth(self) -> SceneState:
        """True poses and twists of all objects, the new one included; the simulation is not affected."""
        model, seen = self.model, self._seen
        seen.qpos[:], seen.qvel[:] = self.data.qpos, self.data.qvel
        for forward in (mujoco.mj_kinematics, mujoco.mj_comPos, mujoco.mj_comVel):
            forward(model, seen)
        return SceneState(self.time, {name: _object_state(model, seen, name) for name in self._names})

    def release(self, reason: str = "asked to open") -> None:
        """Open the pump and free the object; does nothing if the pump is open."""
        if self.pump.state.is_closed:
            self.pump.open(reason)
            self._swap(HeldRole.FREE)

    def present(self, item: ObjectModel) -> str:
        """The next object arrives where its `pose` announces it, with an error, and may be gripped there.

        The object before it stays in the cell if it was packed, that is, if it is inside the container;
        from the hand-over place it is taken away.

        Returns:
            Why it cannot be presented; empty if it is there.
        """
        if item.pose is None:
            return f"'{item.name}' has no pose; allowed: where it is handed over"
        if self.pump.state.is_closed:
            return f"the pump holds '{self.scene.new_object.name}'; pack or release it first"
        if item.name in self.scene.names:
            return f"'{item.name}' is in the container already; allowed: another name"
        joints, truth, old = self.joints(), self.truth(), self.scene.new_object.name
        keep = is_packed(self.scene, truth.objects[old].X_WO)
        mismatch = self.config.mismatch
        true = actual_object(item, self.description, mismatch, self._truth_rng)
        told = believed_object(item, mismatch, self._belief_rng)
        self.scene = self.scene.with_next(true, keep=keep)
        self.description = self.description.with_next(told, keep=keep).description()
        self._is_handed_over = True
        self.mocap = MocapSystem(self.scene, self.cell, self.config.mocap, self._rng)
        there = ObjectState(self._presented())
        self._rebuild(HeldRole.FREE, joints, SceneState(truth.time, {**truth.objects, item.name: there}))
        return ""

    def grip(self) -> str:
        """Close the pump, if the cup seals on an object that was handed over, or holds it as described.

        Returns:
            Why it could not grip; empty if it holds the object.
        """
        if self.pump.state.is_closed:
            return ""
        X_TN = body_pose(self.data, "tool").inverse() @ body_pose(self.data, self.scene.new_object.name)
        if self._is_handed_over:
            if fault := seal_fault(X_TN, self.scene.new_object, self.cell.pump.cup_radius):
                return fault
            self.scene = self.scene.gripped(X_TN)
            self.pump.close()
            self._swap(self._held)
            return ""
        nominal = held_pose(self.scene)
        distance = float(np.linalg.norm(X_TN.p - nominal.p))
        if distance > GRIP_DISTANCE or angle_between(X_TN.q, nominal.q) > GRIP_ANGLE:
            return f"the object is {1000 * distance:.0f} mm off the cup; allowed: 5 mm and 2 degrees"
        self.pump.close()
        self._swap(self._held)
        return ""

    @property
    def _names(self) -> list[str]:
        return [*self.scene.names, self.scene.new_object.name]

    def _compile(self, held: HeldRole) -> mujoco.MjModel:
        model = build_model(
            self.scene, self.cell, timestep=self.config.timestep, arm=ArmRole.DRIVEN, held=held,
            lip_touches=self._is_handed_over and held is HeldRole.FREE,
        )  # fmt: skip
        for name, friction in zip(self.cell.robot.arm.joints, self._joint_friction, strict=True):
            dof = model.joint(name).dofadr[0]
            model.dof_frictionloss[dof], model.dof_solimp[dof, :2] = friction, STICTION
        soften_contacts(model, self.config.contact_width)
        return model

    def _presented(self) -> Pose:
        """Where the new object truly stands at its hand-over."""
        assert self.scene.new_object.pose is not None
        announced = self.scene.new_object.pose.to_pose()
        return presented_pose(announced, self.config.hand_over, self._hand_over_rng)

    def _tip_rotation(self) -> Array:
        """Rotation `(3, 3)` from the axes of `/wrench` into the world's: those of the object, if held."""
        if self.pump.state.is_closed or not self._is_handed_over:
            return np.asarray(self.data.body(self.scene.new_object.name).xmat.reshape(3, 3))
        return np.asarray(self.data.body("tool").xmat.reshape(3, 3) * np.array([1.0, -1.0, -1.0]))

    def _pressure(self) -> Array:
        """Force `(3,)` [N] of all contacts on the empty cup and pump, in world axes."""
        model, data, total, wrench = self.model, self.data, np.zeros(3), np.zeros(6)
        if not self._is_handed_over:
            return total
        tool = model.body("tool").id
        for i in range(data.ncon):
            contact = data.contact[i]
            bodies = model.geom_bodyid[contact.geom]
            if tool in bodies:
                mujoco.mj_contactForce(model, data, i, wrench)
                # the contact's frame has its axes as rows, and the force acts on the second geom
                sign = 1.0 if bodies[1] == tool else -1.0
                total += sign * contact.frame.reshape(3, 3).T @ wrench[:3]
        return total

    def _index(self) -> None:
        joints = [self.model.joint(name) for name in self.cell.robot.arm.joints]
        self._q = np.array([joint.qposadr[0] for joint in joints])
        self._v = np.array([joint.dofadr[0] for joint in joints])
        self._payload = PayloadCompensation(self.model, self.description)
        self._seen = mujoco.MjData(self.model)

    def _mass_matrix(self) -> Array:
        """Mass matrix `(7, 7)` of the arm with the held object [kg m^2]."""
        M = np.empty((self.model.nv, self.model.nv))
        mujoco.mj_fullM(self.model, self.data, M)
        return np.asarray(M[np.ix_(self._v, self._v)])

    def _cup_jacobian(self) -> Array:
        """Jacobian `(6, 7)` of the cup, linear part first, in the world frame."""
        J = np.empty((6, self.model.nv))
        mujoco.mj_jacBody(self.model, self.data, J[:3], J[3:], self.model.body("tool").id)
        return J[:, self._v]

    def _swap(self, held: HeldRole) -> None:
        """Continue with a model in which the new object is held or free, everything else unchanged."""
        self._rebuild(held, self.joints(), self.truth())

    def _rebuild(self, held: HeldRole, joints: JointSample, truth: SceneState) -> None:
        """Compile the model anew, and go on from these joints and objects."""
        self.model = self._compile(held)
        self.data = mujoco.MjData(self.model)
        self.data.time = joints.time
        self._index()
        self.data.qpos[self._q], self.data.qvel[self._v] = joints.q, joints.v
        for name in self._names if held is HeldRole.FREE else self.scene.names:
            self._place(name, truth.objects[name])
        if held is HeldRole.COMPLIANT:
            self._hang(truth.objects[self.scene.new_object.name].X_WO)
        mujoco.mj_forward(self.model, self.data)

    def _place(self, name: str, state: ObjectState) -> None:
        set_object_poses(self.model, self.data, {name: state.X_WO})
        v = self.model.joint(name).dofadr[0]
        self.data.qvel[v : v + 3] = state.v_WO_W
        # MuJoCo has a free joint's angular velocity in the body's axes
        self.data.qvel[v + 3 : v + 6] = rotate(conjugate(state.X_WO.q), state.w_WO_W)

    def _hang(self, X_WN: Pose) -> None:
        """Set the cup's springs so that the held object is where it was gripped."""
        mujoco.mj_kinematics(self.model, self.data)
        X_TN = body_pose(self.data, "tool").inverse() @ X_WN
        coordinates = tip_coordinates(held_pose(self.scene), X_TN, cup_point(self.scene))
        for name, value in zip(TIP_JOINTS, coordinates, strict=True):
            self.data.joint(name).qpos[0] = value

    def _cup_load(self) -> tuple[Array, Array]:
        # the sensors tip_force and tip_torque are the first of the model
        return self.data.sensordata[:3].copy(), self.data.sensordata[3:6].copy()


def _object_state(model: mujoco.MjModel, data: mujoco.MjData, name: str) -> ObjectState:
    twist = np.empty(6)
    mujoco.mj_objectVelocity(model, data, mujoco.mjtObj.mjOBJ_XBODY, model.body(name).id, twist, 0)
    # MuJoCo gives the angular part first
    return ObjectState(body_pose(data, name), twist[3:].copy(), twist[:3].copy())
