"""The simulated cell: MuJoCo physics with the interface of a robot driver."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Annotated

import mujoco
import numpy as np
from pydantic import Field, NonNegativeFloat, PositiveFloat

from pack_core.bodies import body_pose
from pack_core.config import AT_ONCE, Config
from pack_core.joints import JointSample, Setpoints
from pack_core.packing.cell import PackingCell, Perception
from pack_core.packing.free_space import is_packed
from pack_core.packing.model import HeldRole, held_pose
from pack_core.packing.objects import ObjectModel
from pack_core.packing.scene import Scene
from pack_core.rotations import Array, Pose
from pack_core.states import ObjectState, SceneState
from pack_sim.brakes import TorqueBrake
from pack_sim.packing.contact_governor import ContactGovernor, ContactGovernorConfig
from pack_sim.packing.hand_over import HandOverConfig, hang_fault, present_fault, presented_pose, seal_fault
from pack_sim.packing.joint_controller import JointController, PayloadCompensation
from pack_sim.packing.mismatch import (
    MismatchConfig,
    actual,
    actual_object,
    believed,
    believed_object,
    joint_friction,
)
from pack_sim.packing.mocap import MocapConfig, MocapSystem
from pack_sim.packing.pump import PumpModel
from pack_sim.packing.scene_physics import PhysicsOptions, ScenePhysics
from pack_sim.packing.wrench_sensor import WrenchSensor, WrenchSensorConfig
from pack_sim.setpoint_follower import SetpointFollower

UPSIDE_DOWN = np.array([1.0, -1.0, -1.0])
"""Turns the tool's axes into those of an object that hangs upright from it."""


class SimulatorConfig(Config):
    """Parameters of the simulated driver, its sensors and its errors."""

    timestep: float = Field(default=0.001, gt=0, le=0.001, description="physics and joint controller [s]")
    watchdog: PositiveFloat = Field(default=0.1, description="age at which setpoints are stale [s]")
    governor: ContactGovernorConfig = ContactGovernorConfig()
    friction_compensation: NonNegativeFloat = Field(
        default=0.0, description="compensated friction of each joint, along its desired velocity [N m]"
    )
    torque_rate: PositiveFloat = Field(
        default=math.inf, description="fastest change of a joint's torque while setpoints are tracked [N m/s]"
    )
    contact_width: NonNegativeFloat = Field(
        default=0.0005,
        description="penetration over which a contact becomes firm [m]; 0: at first touch, as MuJoCo has it",
    )
    mocap: MocapConfig = MocapConfig()
    wrench_sensor: Annotated[WrenchSensorConfig, AT_ONCE] = WrenchSensorConfig()
    mismatch: MismatchConfig = MismatchConfig()
    hand_over: HandOverConfig = HandOverConfig()


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
        zeroed: when the force sensor was last set to zero with an empty cup, simulated time [s]: at the
            start, and before each grip.
    """

    def __init__(
        self, cell: PackingCell, scene: Scene, config: SimulatorConfig, rng: np.random.Generator,
        time: float = 0.0,
    ) -> None:  # fmt: skip
        self.cell, self.config = cell, config
        self._truth_rng, self._belief_rng, arm_rng, wrench_rng, self._hand_over_rng = rng.spawn(5)
        self.scene = actual(scene, config.mismatch, self._truth_rng)
        self.description = believed(scene, config.mismatch, self._belief_rng)
        self._is_handed_over = is_handed_over = scene.is_handed_over
        friction = joint_friction(config.mismatch, len(cell.robot.arm.joints), arm_rng)
        self.controller = JointController(
            cell.robot, ContactGovernor(config.governor, config.timestep), config.friction_compensation,
            config.torque_rate * config.timestep,
        )  # fmt: skip
        self.pump = PumpModel(cell.suction, config.timestep, is_closed=not is_handed_over)
        self._rng = rng
        self.mocap = MocapSystem(self.scene, cell, config.mocap, rng)
        self._wrench_sensor = WrenchSensor(config.wrench_sensor, config.timestep, wrench_rng)
        self._zero_sensor(time)
        self._held = HeldRole.RIGID if cell.tip is None else HeldRole.COMPLIANT
        self._physics = ScenePhysics(
            cell, self.scene, PhysicsOptions(config.timestep, config.contact_width, friction),
            HeldRole.FREE if is_handed_over else self._held, time=time, lip_touches=is_handed_over,
            poses={scene.new_object.name: self._presented()} if is_handed_over else {},
        )  # fmt: skip
        brake = TorqueBrake(
            cell.robot.arm.limits, self._physics.mass_matrix, lambda: self.controller.is_touching
        )
        self.follower = SetpointFollower(cell.robot.arm.limits, config.watchdog, brake)
        self._payload = PayloadCompensation(self.model, self.description)

    @property
    def model(self) -> mujoco.MjModel:
        """The present model; another one when an object was gripped, was let go or has arrived."""
        return self._physics.model

    @property
    def data(self) -> mujoco.MjData:
        """Its state."""
        return self._physics.data

    @property
    def time(self) -> float:
        """Simulated time [s]."""
        return self._physics.time

    def accept(self, setpoints: Setpoints) -> None:
        """Pass setpoints to the driver; raises MessageError if they are refused."""
        self.follower.accept(setpoints, self.time)

    def change_sensors(self, config: SimulatorConfig) -> None:
        """Measure with other errors from now on; all else in `config` is as it was."""
        if config.wrench_sensor != self.config.wrench_sensor:
            self._wrench_sensor.configure(config.wrench_sensor)
        self.mocap.config = config.mocap
        self.config = config

    def step(self) -> None:
        """Advance by one time step: control, physics, pump and sensors."""
        physics, data = self._physics, self.data
        q, v = physics.q, physics.v
        force, torque = self.external_wrench()
        force, bending = self._tip_rotation() @ force, float(np.hypot(torque[0], torque[1]))
        is_holding = self.follower.is_holding
        self.controller.update_contact(
            self.time, force, bending, v, physics.cup_jacobian, is_holding=is_holding
        )
        desired = self.follower.at(self.time, q, v)
        data.ctrl[:] = self.controller.torque(q, v, desired, is_holding=self.follower.is_holding)
        if self.pump.state.is_closed:
            self._payload.apply(self.model, data)
        mujoco.mj_step(self.model, data)
        self._wrench_sensor.advance()
        if self.pump.state.is_closed and not self.pump.update(*physics.cup_load):
            self._rebuild(HeldRole.FREE)
        if self.cell.perception is Perception.MOCAP:
            self.mocap.update(self.model, self.data, self.time)  # of the model that is there now

    def joints(self) -> JointSample:
        """Measured positions, velocities and torques of the joints."""
        return self._physics.joints()

    def external_wrench(self) -> tuple[Array, Array]:
        """Measured external force `(3,)` [N] and torque `(3,)` [N m] on the held object.

        They are given in the frame of site `tip`, at the middle of the held object's top and with the axes of
        the object N. The force is without the object's described weight; the torque has the weight's moment
        about the site in it. If nothing is held, they are what presses on the cup, in the axes of an object
        that would hang upright from it.
        """
        if not self.pump.state.is_closed:
            pressure = self._physics.cup_pressure() if self._is_handed_over else np.zeros(3)
            return self._wrench_sensor.read(self._tip_rotation().T @ pressure, np.zeros(3))
        force, torque = self._physics.cup_load
        return self._wrench_sensor.read(
            self._physics.R_WN.T @ self._payload.described_weight - force, -torque
        )

    def truth(self) -> SceneState:
        """True poses and twists of all objects, the new one included; the simulation is not affected."""
        return self._physics.truth()

    def release(self, reason: str = "asked to open") -> None:
        """Open the pump and free the object; does nothing if the pump is open."""
        if self.pump.state.is_closed:
            self.pump.open(reason)
            self._rebuild(HeldRole.FREE)

    def present(self, item: ObjectModel) -> str:
        """The next object arrives where its `pose` announces it, with an error, and may be gripped there.

        The object before it stays in the cell if it was packed, that is, if it is inside the container;
        from the hand-over place it is taken away.

        Returns:
            Why it cannot be presented; empty if it is there.
        """
        keep = is_packed(self.scene, self.truth().objects[self.scene.new_object.name].X_WO)
        if fault := present_fault(item, self.scene, is_held=self.pump.state.is_closed, keep=keep):
            return fault
        true = actual_object(item, self.description, self.config.mismatch, self._truth_rng)
        self.scene = self.scene.with_next(true, keep=keep)
        told = believed_object(item, self.config.mismatch, self._belief_rng)
        self.description = self.description.with_next(told, keep=keep).description()
        self._is_handed_over = True
        self.mocap = MocapSystem(self.scene, self.cell, self.config.mocap, self._rng)
        self._rebuild(HeldRole.FREE, {item.name: ObjectState(self._presented())})
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
        elif fault := hang_fault(X_TN, held_pose(self.scene)):
            return fault
        self._zero_sensor(self.time)
        self.pump.close()
        self._rebuild(self._held)
        return ""

    def _zero_sensor(self, time: float) -> None:
        self._wrench_sensor.zero()
        self.zeroed = time

    def _presented(self) -> Pose:
        """Where the new object truly stands at its hand-over."""
        announced = self.scene.new_object.pose
        assert announced is not None
        return presented_pose(announced.to_pose(), self.config.hand_over, self._hand_over_rng)

    def _tip_rotation(self) -> Array:
        """Rotation `(3, 3)` from the axes of `/wrench` into the world's: those of the object, if held."""
        if self.pump.state.is_closed or not self._is_handed_over:
            return self._physics.R_WN
        return np.asarray(self._physics.R_WT * UPSIDE_DOWN)

    def _rebuild(self, held: HeldRole, arrived: Mapping[str, ObjectState] | None = None) -> None:
        """Go on with a model in which the new object is held or free, and with objects that have arrived."""
        joints, truth = self.joints(), self.truth()
        objects = SceneState(truth.time, {**truth.objects, **(arrived or {})})
        is_touched = self._is_handed_over and held is HeldRole.FREE
        self._physics.rebuild(self.scene, held, joints, objects, lip_touches=is_touched)
        self._payload = PayloadCompensation(self.model, self.description)
