"""The simulated palletizing cell: MuJoCo physics behind the interface of a robot driver."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from copy import copy

import mujoco
import numpy as np
from pydantic import Field, PositiveFloat

from pack_core.bodies import body_pose
from pack_core.config import Config
from pack_core.joints import Desired, JointSample, Setpoints
from pack_core.palletizing.arm_dynamics import CarriedLoad
from pack_core.palletizing.boxes import BoxBody
from pack_core.palletizing.cell import PalletizingCell
from pack_core.palletizing.infeed import InfeedState
from pack_core.palletizing.visitors import Visitor
from pack_core.robots.joint_properties import GearCompensation
from pack_core.robots.kr210 import LIMITS
from pack_core.robots.surface_gripper import TOOL
from pack_core.rotations import Array, Pose
from pack_core.states import ObjectState, SceneState
from pack_sim.brakes import GentleBrake
from pack_sim.joint_servo import JointServo
from pack_sim.palletizing.contact_watch import ContactWatch, visitor_distances
from pack_sim.palletizing.infeed import ArrivingBox, Infeed
from pack_sim.palletizing.overhead_camera import PalletCamera, PalletCameraConfig, Snapshot
from pack_sim.palletizing.physics import Physics
from pack_sim.palletizing.place_scanner import PhysicsSnapshot, PlaceScanner, PlaceScannerConfig
from pack_sim.palletizing.real_arm import GearTrain, true_base
from pack_sim.palletizing.surface_gripper import SurfaceGripper
from pack_sim.palletizing.true_cell import arrival_pose, true_cell
from pack_sim.setpoint_follower import SetpointFollower

UNEVEN = np.array([0.004, -0.003, 0.0])
"""By how much an operator misses the place where something is to be laid [m]."""
TORQUE = 4
"""Stream of random numbers of the noise of measured torques."""


class PalletSimulatorConfig(Config):
    """Parameters of the simulated driver."""

    timestep: float = Field(default=0.002, gt=0, le=0.002, description="physics and joint controller [s]")
    watchdog: PositiveFloat = Field(default=0.1, description="age at which setpoints are stale [s]")
    has_limits: bool = Field(
        default=True,
        description="whether joints and grip have the limits that are known of them; not so in the thesis",
    )
    swap_time: PositiveFloat = Field(
        default=60.0, description="until an empty pallet stands where a full one was taken away [s]"
    )


class PalletSimulator:
    """Steps the physics of the cell together with its joint controller and its gripper.

    Args:
        cell: the cell's physical facts.
        config: time step of the physics and timeout of the setpoints.
        seed: seed of the random poses at which boxes arrive, and of all errors of a real cell.
        time: what the clock shows at the start [s].
        assumed: what the driver assumes of the arm's gears; by default what the preset says.
        errors_of: seed of the errors of a real cell; by default `seed`.
        visitors: who comes near the arm.
        arrivals: what comes on the conveyor of a cell that has one.

    Attributes:
        cell: the cell as it truly is; no part of a control loop may use it.
        nominal: the cell as it is configured.
        X_WB: true pose of the arm's base; no part of a control loop may use it either.
    """

    def __init__(
        self, cell: PalletizingCell, config: PalletSimulatorConfig, seed: int = 0, time: float = 0.0,
        assumed: GearCompensation | None = None, visitors: Sequence[Visitor] = (),
        errors_of: int | None = None, arrivals: Iterable[ArrivingBox] = (),
    ) -> None:  # fmt: skip
        wrong = seed if errors_of is None else errors_of
        self.cell, self.config, self._seed = true_cell(cell, wrong), config, seed
        self.nominal, self.X_WB = cell, true_base(cell, wrong)
        limits, grip = LIMITS, cell.grip
        if not config.has_limits:
            limits, grip = LIMITS.lifted(), cell.grip.lifted()
        self._physics = Physics(
            self.cell, config.timestep, self.X_WB, time, visitors, has_limits=config.has_limits
        )
        self._load = CarriedLoad(cell)
        gears = cell.imperfections.gears
        self._gears = None if gears is None else GearTrain(gears, self._load.model, assumed)
        self._torque_noise = cell.imperfections.torque_noise * LIMITS.effort
        self._rng = np.random.default_rng([seed, TORQUE])
        self._servo = JointServo(self._load.model, limits, cell.servo, config.timestep)
        brake = GentleBrake(limits, cell.servo.stop_deceleration)
        self.follower = SetpointFollower(limits, config.watchdog, brake)
        self.gripper = SurfaceGripper(cell.tool, grip)
        self.contacts = ContactWatch(cell.contact)
        self.contacts.index(self._physics.model)
        self._infeed = None if cell.shift is None else Infeed(self.cell, iter(arrivals))
        self._away: dict[str, float] = {}
        self.reference()  # from here on the arm is held: setpoints must begin where it stands

    @property
    def time(self) -> float:
        """Simulated time [s]."""
        return float(self._physics.data.time)

    @property
    def model(self) -> mujoco.MjModel:
        """The model of what is in the cell now; another one when a box has come or gone."""
        return self._physics.model

    @property
    def data(self) -> mujoco.MjData:
        """The state; body poses are those before the last step."""
        return self._physics.data

    @property
    def boxes(self) -> tuple[BoxBody, ...]:
        """The boxes in the cell, in the order of their arrival."""
        return tuple(self._physics.boxes.values())

    @property
    def infeed(self) -> InfeedState | None:
        """What the conveyor tells; None in a cell without one."""
        return None if self._infeed is None else self._infeed.state(self.time)

    @property
    def taken(self) -> frozenset[str]:
        """Names of the places whose full pallet is being replaced by an empty one."""
        return frozenset(place for place, end in self._away.items() if self.time < end)

    def accept(self, setpoints: Setpoints) -> None:
        """Pass setpoints to the driver; raises MessageError if they are refused."""
        self.follower.accept(setpoints, self.time)

    def step(self) -> None:
        """Advance by one time step."""
        model, data = self._physics.model, self._physics.data
        motors = self._physics.motors
        q, v = data.qpos[motors], data.qvel[motors]
        desired = self.follower.at(self.time, self._reported(q), v)
        if self._gears is not None:
            desired = self._gears.motors(desired)
            data.qfrc_applied[self._physics.gears] = self._gears.torque(data.qpos[self._physics.gears])
        data.ctrl[:] = self._servo.torque(q, v, desired)
        self._physics.move_visitors()
        if self._infeed is not None:
            self._infeed.step(self._physics)
            self._put_on_belt()
            model, data = self._physics.model, self._physics.data
        mujoco.mj_step(model, data)
        held = self.gripper.state.held
        self.contacts.update(model, data, held)
        self.gripper.update(model, data, list(self._physics.boxes))
        if self.gripper.state.held != held:
            self._tell_load(self.gripper.state.held)

    def joints(self) -> JointSample:
        """What the driver reports; the sensors are at the motors, before the gears."""
        data, motors = self._physics.data, self._physics.motors
        tau = data.ctrl.copy()
        if self._torque_noise.any():
            tau += self._torque_noise * self._rng.standard_normal(6)
        return JointSample(self.time, self._reported(data.qpos[motors].copy()), data.qvel[motors].copy(), tau)

    def link_angles(self) -> Array:
        """True joint angles of the links `(6,)` [rad]; no part of a control loop may use them."""
        return self._physics.link_angles()

    def reference(self) -> Desired:
        """What the joint controller pursues now: position, velocity and acceleration, each `(6,)`."""
        data, motors = self._physics.data, self._physics.motors
        return self.follower.at(self.time, self._reported(data.qpos[motors]), data.qvel[motors])

    def open_camera(self, config: PalletCameraConfig) -> PalletCamera:
        """The overhead camera of the cell as it truly is; it draws inside a `with` statement."""
        is_real = self.cell.imperfections.camera is not None
        return PalletCamera(self.cell, config, self._seed, self.X_WB if is_real else None)

    def open_scanner(self, config: PlaceScannerConfig) -> PlaceScanner:
        """The scanners of the cell as it truly is."""
        return PlaceScanner(self.cell, config, self._seed)

    def spawn(self, box: BoxBody, X_WB: Pose | None = None) -> Pose:
        """Put a box into the cell.

        Args:
            box: what arrives.
            X_WB: its pose; by default on the picking table, displaced and turned at random.

        Returns:
            The true pose of the box; no part of a control loop may use it.

        Raises:
            PackError: a box of this name is in the cell, or something is in its place.
        """
        where = X_WB or arrival_pose(self.cell, box, self._seed)
        self._physics.add(box, where)
        self.contacts.index(self._physics.model)
        return where

    def lay(self, box: BoxBody, X_NB: Pose) -> None:
        """Lay something on the picking table, as an operator does.

        Args:
            box: what is laid there.
            X_NB: where it would be if the table stood where it should; it is laid on the true table, some
                millimetres from there.

        Raises:
            PackError: a box of this name is in the cell, or something is in its place.
        """
        self.spawn(box, self.cell.picking_table.displaced(Pose(X_NB.p + UNEVEN, X_NB.q)))

    def remove(self, name: str) -> None:
        """Take a box out of the cell, also if it is gripped; raises PackError when there is no such box."""
        if self.gripper.state.held == name:
            self.gripper.let_go(self._physics.model, self._physics.data, f"box '{name}' was taken away")
            self._tell_load("")
        self._physics.remove(name)
        if self._infeed is not None:
            self._infeed.forget(name)
        self.contacts.index(self._physics.model)

    def send_box(self) -> None:
        """Have the conveyor bring the next box; nothing happens in a cell without one."""
        if self._infeed is not None:
            self._infeed.send()

    def take_pallet(self, place: str, boxes: Sequence[str]) -> None:
        """Have somebody take a pallet away with all that is on it, and bring an empty one a while later.

        Args:
            place: name of the pallet's place.
            boxes: names of what must stand on it; one that is not there any more is no fault.
        """
        taken = {*boxes, *self.over(place)}
        for name in [box.name for box in self.boxes if box.name in taken]:
            self.remove(name)
        self._away[place] = self.time + self.config.swap_time

    def over(self, place: str) -> tuple[str, ...]:
        """Names of the boxes that truly are over a pallet, but for one in the hand."""
        deck = self.cell.deck(place)
        half, X_DW = 0.5 * np.array(deck.size), deck.X_WD.inverse()
        middles = {name: X_DW.apply(box.X_WO.p)[:2] for name, box in self.truth().objects.items()}
        held = self.gripper.state.held
        return tuple(n for n, p in middles.items() if n != held and np.all(np.abs(p - half) <= half))

    def tool_pose(self) -> Pose:
        """X_WT, the true pose of the tool."""
        return body_pose(self._kinematics(), TOOL)

    def truth(self) -> SceneState:
        """True poses and twists of all boxes."""
        data = self._kinematics()
        return SceneState(self.time, {name: self._box_state(data, name) for name in self._physics.boxes})

    def visitor_distances(self) -> dict[str, float]:
        """By name, each visitor's true distance from the arm and what it carries [m]."""
        visitors, held = self._physics.visitors, self.gripper.state.held
        if not visitors:
            return {}
        names = [visitor.name for visitor in visitors]
        return visitor_distances(self._physics.model, self._kinematics(), names, held)

    def snapshot(self) -> Snapshot:
        """What a camera would see now, to be drawn by another thread."""
        data = self._kinematics()
        boxes = {box: body_pose(data, name) for name, box in self._physics.boxes.items()}
        return Snapshot(self.time, self._physics.link_angles(), boxes)

    def still(self) -> PhysicsSnapshot:
        """What a scanner would measure now, for another thread."""
        return PhysicsSnapshot(self.time, self._physics.model, copy(self._kinematics()))

    def _reported(self, q: Array) -> Array:
        """Joint angles as the driver reports them, of motors that stand at `q` `(6,)` [rad]."""
        return q if self._gears is None else q - self._gears.lead

    def _kinematics(self) -> mujoco.MjData:
        """The data with body poses that match qpos: a step of MuJoCo leaves those from before the step."""
        mujoco.mj_kinematics(self._physics.model, self._physics.data)
        return self._physics.data

    def _put_on_belt(self) -> None:
        """Put the next box on the conveyor, once there is room for it."""
        assert self._infeed is not None
        if self._infeed.bring(self._physics):
            self.contacts.index(self._physics.model)

    def _tell_load(self, held: str) -> None:
        if not held:
            self._load.take_off()
            return
        data = self._kinematics()
        self._load.put_on(self._physics.boxes[held], body_pose(data, TOOL).inverse() @ body_pose(data, held))

    def _box_state(self, data: mujoco.MjData, name: str) -> ObjectState:
        dof = self._physics.model.body(name).dofadr[0]
        R_WB = data.body(name).xmat.reshape(3, 3)
        v: Array = data.qvel[dof : dof + 6]
        # MuJoCo has a free joint's angular velocity in the body's frame: it is turned into the world.
        return ObjectState(body_pose(data, name), v[:3].copy(), np.asarray(R_WB @ v[3:]))
