"""The motion controller as a ROS 2 node: targets in, joint setpoints and status out."""

from __future__ import annotations

import threading
from dataclasses import replace
from typing import Any

from pack_interfaces.msg import ArmState, BoxObstacles, Separation
from pack_interfaces.msg import MotionTarget as MotionTargetMsg
from pydantic import Field, field_validator

from pack_core.errors import MessageError
from pack_core.joints import JointSample
from pack_core.motion.moves import Path
from pack_core.motion.target import MotionTarget
from pack_core.ros.clock import StampCheck
from pack_core.ros.contracts import motion as contracts
from pack_core.ros.contracts import shared
from pack_core.ros.contracts.contract import NEWEST
from pack_core.ros.messages.conversions import WORLD, from_stamp, to_stamp
from pack_core.ros.messages.motion import from_obstacles, from_target
from pack_core.ros.messages.serialized import JointStateReader
from pack_core.ros.messages.serialized_setpoints import TrajectoryWriter
from pack_core.ros.messages.serialized_status import MotionStatusWriter
from pack_core.ros.node import CellNode
from pack_core.ros.run import run_node
from pack_core.ros.stream import Stream, StreamReader
from pack_motion.arm.arm import load_arm
from pack_motion.controller import MotionController, warm_up
from pack_motion.ros.trajectory_client import ACTION, TrajectoryClient
from pack_motion.setpoint_stream import SetpointStream, StreamConfig
from pack_motion.target_planner import PlanningThread, PreparedTarget
from pack_motion.tracking.config import motion_set
from pack_motion.trajectory_output import LONGEST_GAP, Cancel, DriverClock, TrajectoryOutput

COMMANDER = "fsm"
"""The node whose moves are given up when its process ends: a new one knows nothing of them."""
FASTEST = 2.0
"""Largest scaling factor of a driver's speed that is believed: a percentage, say, is none."""
READ_PERIOD = 0.05
"""Longest time for which the reader waits for a joint state [s of wall clock]."""


class MotionNodeConfig(StreamConfig):
    """Parameters of the node `motion`."""

    cell: str = Field(default="palletizing", description="whose arm it moves")
    parameters: str = Field(default="shipped", description="named set of config/motion")
    follow_joint_trajectory: str = Field(
        default="",
        description="action of a driver's joint trajectory controller, which gets whole moves, such as "
        "/scaled_joint_trajectory_controller/follow_joint_trajectory; empty: setpoints are sent",
    )
    watched: tuple[str, ...] = Field(
        default=("sim",), description="the arm brakes and waits while one of them is silent"
    )

    @field_validator("follow_joint_trajectory")
    @classmethod
    def _check_action(cls, name: str) -> str:
        if name and not (name.startswith("/") and name.endswith(ACTION)):
            raise ValueError(f"'{name}'; allowed: '', or a name with its namespace, /CONTROLLER{ACTION}")
        return name


class MotionNode(CellNode):
    """Makes a step for every joint state; plans in another thread while the arm stands still."""

    def __init__(self, **kwargs: Any) -> None:
        super().__init__("motion", **kwargs)
        self._config = self.read_parameters(MotionNodeConfig)
        self._arm, self._set = load_arm(self._config.cell), motion_set(self._config.parameters)
        warm_up(self._arm, self._set)
        self._stream: SetpointStream | None = None
        self._waiting: MotionTarget | None = None
        self._planned: MotionTarget | None = None
        self._stepping = threading.Lock()
        self._arm_state = ArmState()
        self._silent, self._stamps = set[str](), StampCheck(self)
        self._planning = PlanningThread(self._prepare, self._on_error)
        self._trajectories = self._open_trajectories()
        self._output: TrajectoryOutput | None = None
        self._driver_clock, self._obstacle_stamps = DriverClock(), StampCheck(self)
        self._setpoints = self.advertise(contracts.SETPOINTS)
        self._writer = TrajectoryWriter(self._arm.limits.names)
        self._status, self._status_writer = self.advertise(contracts.MOTION_STATUS), MotionStatusWriter()
        self._separation = self.advertise(contracts.SEPARATION)
        self.listen(contracts.MOTION_TARGET, self._on_target)
        self.listen(contracts.MOTION_OBSTACLES, self._on_obstacles)
        self.listen(shared.ARM_STATE, self._on_arm_state)
        # Only the newest joint state: setpoints made for an older one would be late.
        self._joints = Stream(self, replace(contracts.JOINT_STATES, qos=NEWEST), raw=True)
        self._joint_reader = JointStateReader(self._arm.limits.names)
        self._reader = StreamReader(self, (self._joints,), self._read, READ_PERIOD)
        self.watch(self._config.watched, self._on_peer)

    @property
    def waits_for(self) -> str:
        if self._stream is None:
            return f"no {contracts.JOINT_STATES.name} yet: is sim up?"
        if self._trajectories is not None and not self._trajectories.is_there:
            return f"nobody takes trajectories at {self._trajectories.action} yet: is the driver up?"
        return ""

    def destroy_node(self) -> None:
        """Stop reading and planning, then the node."""
        self._reader.end()
        self._planning.end()
        if self._trajectories is not None:
            self._trajectories.close()
        super().destroy_node()

    def _open_trajectories(self) -> TrajectoryClient | None:
        """The client of the driver's controller, if whole moves are sent."""
        action = self._config.follow_joint_trajectory
        if not action:
            return None
        limits = self._arm.limits
        return TrajectoryClient(
            self, action, limits.names, self._config.deviation * limits.velocity,
            self._on_rejection, self._on_abort,
        )  # fmt: skip

    def _on_rejection(self, reason: str) -> None:
        """The driver takes no trajectory now: the move ends, as it would not take the next one either."""
        self.health.count("rejected trajectory", reason)
        self.get_logger().error(reason)
        self.executor.create_task(self._refuse, reason)

    def _refuse(self, reason: str) -> None:
        with self._stepping:
            if self._stream is not None:
                self._stream.interrupt(reason)
                self._stream.controller.refuse(reason)
                self._plan_again()

    def _on_abort(self, reason: str) -> None:
        """The driver holds the arm somewhere on the way: the rest of the move is planned from there."""
        with self._stepping:
            if self._stream is not None and not self._arm_state.is_stopped:
                self._stream.interrupt(reason)
                self._note_interruption(reason)

    def _read(self) -> None:
        for message in self._joints.take_all():
            with self._stepping:
                self.guard(contracts.JOINT_STATES, self._on_joints, message)

    def _on_target(self, message: MotionTargetMsg) -> None:
        target = from_target(message)
        with self._stepping:
            if self._stream is None:
                raise MessageError("no joint state yet: is the sim up?")
            if not self._stream.controller.is_standing:
                self._stream.controller.stop()
            self._waiting, self._planned = None if target.move == Path(()) else target, None

    def _on_obstacles(self, message: BoxObstacles) -> None:
        obstacles = from_obstacles(message.obstacles)
        # A sender that leaves the stamp out means: now.
        time = from_stamp(message.header.stamp) or None
        if time is not None:
            self._obstacle_stamps.check(time)  # one ahead of the clock would never be too old
        with self._stepping:
            if self._stream is not None:
                self._stream.controller.observe(obstacles, time and self._driver_clock.at(time))

    def _on_arm_state(self, message: ArmState) -> None:
        """Give up the move when the arm is stopped; a target that comes later waits until it is released."""
        with self._stepping:
            if message.stops > self._arm_state.stops:
                self._give_up(f"the arm was stopped: {message.reason}")
            self._arm_state = message

    def _give_up(self, reason: str) -> None:
        self._waiting = self._planned = None
        if self._stream is not None:
            self._stream.abandon(reason)

    def _on_peer(self, peer: str, is_alive: bool) -> None:
        """Have the arm brake while a node is silent; the move goes on when all are heard again."""
        with self._stepping:
            self._silent = self._silent - {peer} if is_alive else self._silent | {peer}
            self._bar()

    def _bar(self) -> None:
        if self._stream is not None:
            names = ", ".join(sorted(self._silent))
            self._stream.bar(names and f"silent: {names}")

    def on_peer_end(self, peer: str) -> None:
        if peer == COMMANDER:
            with self._stepping:
                self._give_up(f"node '{peer}' has ended")

    def on_failure(self, reason: str) -> None:
        with self._stepping:
            self._give_up(reason)

    def _on_joints(self, data: bytes) -> None:
        measured = self._joint_reader.read(data)
        self._stamps.check(measured.time)
        self._look_at_driver()
        sample = replace(measured, time=self._driver_clock.at(measured.time))
        stream = self._stream
        if stream is None or stream.has_begun_anew(sample):
            self._driver_clock.restart()
            sample = measured
            stream = self._stream = self._start(sample)
            self._bar()
        if not self._arm_state.is_stopped and not self._silent:
            self._take_up(stream.controller)
        self._drive(stream, sample)
        if stream.interruption:
            self._note_interruption(
                f"{stream.interruption}: is the machine too slow for this real_time_factor?"
            )
        self._waiting = self._waiting or stream.left
        late = measured.time - sample.time
        status = stream.controller.status()
        self._status.publish(self._status_writer.write(replace(status, time=status.time + late)))
        self._tell_separation(stream.controller, measured.time)

    def _tell_separation(self, controller: MotionController, time: float) -> None:
        margin = controller.margin
        if not margin.who:
            return
        message = Separation(
            margin=margin.value, distance=margin.distance, body=margin.body, who=margin.who,
            is_under_way=controller.is_under_way,
        )  # fmt: skip
        message.header.stamp, message.header.frame_id = to_stamp(time), WORLD
        self._separation.publish(message)

    def _drive(self, stream: SetpointStream, sample: JointSample) -> None:
        """Tell the driver what is new. Beside trajectories setpoints are told for recordings alone."""
        is_stopped = self._arm_state.is_stopped
        if self._output is None or self._trajectories is None:
            given = stream.advance(sample)
        else:
            command = self._output.advance(sample, is_stopped=is_stopped)
            if isinstance(command, Cancel):
                self._trajectories.cancel()
            elif command is not None:
                self._trajectories.send(replace(command, time=self._driver_clock.stamp(command.time)))
            given = None if stream.controller.is_held else stream.given
        if given is not None and not is_stopped:
            due = replace(given, time=self._driver_clock.stamp(given.time))
            self._setpoints.publish(self._writer.write(due))

    def _look_at_driver(self) -> None:
        """Note how fast the driver goes through its trajectory."""
        state = self._trajectories and self._trajectories.newest_state()
        if not state:
            return
        factor = float(state.speed_scaling_factor)
        if not 0.0 <= factor <= FASTEST:  # nor is NaN
            self.health.count("refused", f"speed_scaling_factor is {factor}; allowed: 0 to {FASTEST:g}")
            return
        self._driver_clock.see(from_stamp(state.header.stamp), factor)
        self.health.values["speed scaling"] = f"{factor:.2f}"

    def _start(self, sample: JointSample) -> SetpointStream:
        """Start from the measured posture, and drop all targets: time has begun anew."""
        self._waiting = self._planned = None
        controller = MotionController(self._arm, self._set, sample.time, sample.q)
        if self._trajectories is None:
            return SetpointStream(controller, self._config, self._arm.limits.velocity)
        stream = SetpointStream(controller, self._config, self._arm.limits.velocity, LONGEST_GAP)
        self._output = TrajectoryOutput(stream, self._config.horizon)
        return stream

    def _note_interruption(self, reason: str) -> None:
        """Report an interruption."""
        self._plan_again()
        self.health.count("interrupted", reason)
        self.get_logger().warning(reason)

    def _plan_again(self) -> None:
        """Plan a target anew that is being planned, from the posture in which the arm comes to rest."""
        self._waiting, self._planned = self._waiting or self._planned, None

    def _take_up(self, controller: MotionController) -> None:
        """Pass a waiting target to the planner, and a planned one to the controller."""
        if self._waiting is not None and controller.is_standing:
            self._planned, self._waiting = self._waiting, None
            self._planning.submit(self._planned)
        prepared = self._planning.result()
        if prepared is not None and prepared.target is self._planned:
            self._planned = None
            acceptance = controller.take(prepared)
            if not acceptance.is_accepted:
                self.get_logger().warning(f"refused target {prepared.target.id}: {acceptance.reason}")

    def _prepare(self, target: MotionTarget) -> PreparedTarget:
        assert self._stream is not None
        return self._stream.controller.prepare(target)

    def _on_error(self, error: Exception) -> None:
        self.health.count("failed plan", repr(error))
        self.get_logger().error(f"planning failed: {error!r}")


def main() -> int:
    """Entry point of `motion_node`."""
    return run_node(MotionNode)
