"""A simulator's node: physics in a thread of its own at a given pace; the executor only takes commands."""

from __future__ import annotations

import ctypes
import os
import threading
import time
from abc import abstractmethod
from collections.abc import Callable, Iterable, Sequence
from typing import Annotated, Any, Protocol

import mujoco
from pydantic import Field
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.node import Node
from std_msgs.msg import Float64

from pack_core.config import AT_ONCE, Config
from pack_core.joints import JointSample, Setpoints
from pack_core.robots.urdf import DescribedRobot
from pack_core.ros.contracts import shared
from pack_core.ros.contracts.contract import Contract
from pack_core.ros.messages.serialized_setpoints import TrajectoryReader
from pack_core.ros.node import CellNode
from pack_core.ros.run import run_node
from pack_sim.pacing import Pacer
from pack_sim.ros.arm_brake import ArmBrake
from pack_sim.ros.frame_publisher import FramePublisher
from pack_sim.ros.pause import Pause
from pack_sim.ros.setpoint_gate import SetpointGate
from pack_sim.setpoint_follower import SetpointFollower

Service = Callable[[Any, Any], Any]
REPORT_PERIOD = 1.0
"""Time between two reports of the real-time factor [s of wall clock]."""

M_MMAP_THRESHOLD = -3
"""Number of glibc's option for the size from which memory is given back as soon as it is freed."""
LARGE = 1 << 20
"""That size [byte]. By itself glibc raises it to that of a picture, 25 MB, and keeps what several had."""
FAILED_PAUSE = 0.1
"""After a tick that failed [s of wall clock], before the next is tried."""


class SimulatedCell(Protocol):
    """A simulated cell, as far as every cell's node needs it."""

    follower: SetpointFollower

    @property
    def model(self) -> mujoco.MjModel:
        """Its model; another one when objects have come or gone."""
        ...

    @property
    def data(self) -> mujoco.MjData:
        """Its state."""
        ...

    def joints(self) -> JointSample:
        """What the joint sensors measure now."""
        ...

    def accept(self, setpoints: Setpoints) -> None:
        """Pass setpoints to the driver; raises MessageError when they are refused."""
        ...


class CameraEnd(Protocol):
    """A camera that draws in a thread of its own, as far as this node needs it."""

    def wait(self) -> None:
        """Wait until the picture that was asked for last is published, if one was."""

    def close(self) -> None:
        """End the thread."""


class Pacing(Config):
    """How fast simulated time runs."""

    real_time_factor: Annotated[float, AT_ONCE] = Field(
        default=1.0,
        ge=0,
        le=100,
        description="simulated seconds a second; 1: real time, 0: as fast as physics and pictures can",
    )
    one_sender: Annotated[bool, AT_ONCE] = Field(
        default=True,
        description="while more than one node sends setpoints, refuse them all, and the arm brakes",
    )


class PhysicsNode(CellNode):
    """The node `sim` of a cell; a subclass builds its simulator and then calls `start`."""

    def __init__(self, **kwargs: Any) -> None:
        super().__init__("sim", **kwargs)
        self.lock = threading.Lock()
        self._stopped = threading.Event()
        self._factor = self.advertise(shared.REAL_TIME_FACTOR)
        self._thread: threading.Thread | None = None
        self._camera_end: CameraEnd | None = None

    def show(self, robot: DescribedRobot) -> FramePublisher:
        """Tell viewers of the robot, and of all that moves from the first tick on.

        A subclass calls it before `start`, and sets the frames that are no bodies of its models.
        """
        self._frames = FramePublisher(self, robot)
        return self._frames

    @property
    @abstractmethod
    def simulator(self) -> SimulatedCell:
        """The simulated cell; a new object after every reset."""

    @abstractmethod
    def advance(self) -> float:
        """Advance by one tick and publish what is due, under the lock; how long that was [s]."""

    def release(self) -> None:
        """Let the arm follow setpoints again after a stop, under the lock: for a reset of the cell."""
        self._brake.release()

    def start(
        self, setpoints: Contract, sender: str, joints: Sequence[str],
        services: Iterable[tuple[Contract, Service]], factor: float, camera: CameraEnd | None = None,
    ) -> None:  # fmt: skip
        """Take commands and let time run.

        Args:
            setpoints: of the arm.
            sender: the node that sends them; when it falls silent the arm is held.
            joints: names of the arm's joints, in the order of the simulator.
            services: what is served, and by whom.
            factor: simulated seconds a second of wall clock, 0 for as fast as it can.
            camera: is closed with the node.
        """
        self._setpoints = TrajectoryReader(joints, self.simulator.follower.feed_forward)
        self._camera_end = camera
        self._pause = Pause(self, self.lock)
        self._brake = ArmBrake(self, self._drop, lambda: self.simulator.joints(), self.lock)
        self._gate = SetpointGate(self, setpoints, sender, self._brake, self._accept, self._drop, self.lock)
        group = ReentrantCallbackGroup()
        for contract, serve in services:
            self.create_service(contract.type, contract.name, serve, callback_group=group)
        self._pacer, self._reported = Pacer(factor), time.monotonic()
        self._thread = threading.Thread(target=self._run, name="physics", daemon=True)
        self._thread.start()

    def change_pace(self, config: Pacing) -> None:
        """Let time run as fast as a configuration says."""
        self._pacer.change_factor(config.real_time_factor)

    def stop(self) -> None:
        """Stop the physics."""
        self._stopped.set()
        if self._thread is not None:
            self._pause.end()
            self._thread.join()
            self._gate.end()

    def destroy_node(self) -> None:
        """Stop the physics and the camera, then the node."""
        self.stop()
        if self._camera_end is not None:
            self._camera_end.close()
        super().destroy_node()

    def _accept(self, data: bytes, may_follow: Callable[[], bool]) -> None:
        setpoints = self._setpoints.read(data)
        with self.lock:
            # Asked under the lock: while it was waited for, the arm may have been stopped.
            if may_follow():
                self.simulator.accept(setpoints)

    def _drop(self) -> None:
        self.simulator.follower.drop()

    def _run(self) -> None:
        while not self._stopped.is_set():
            try:
                self._turn()
            except Exception as error:  # time stands, said on /diagnostics, until a reset mends the cell
                self.fail("physics", error)
                self._stopped.wait(FAILED_PAUSE)
            else:
                self.failures.passed("physics")

    def _turn(self) -> None:
        """Advance by a tick and wait until the next one is due, or as long as time stands."""
        with self.lock:
            # Looked at under the lock, so that no tick follows the answer that time stands.
            simulated = None if self._pause.is_paused else self._tick()
        if simulated is None:
            self._pause.wait()
            self._pacer.skip()
            self._reported = time.monotonic()
            return
        if self._pacer.is_free and self._camera_end is not None:
            self._camera_end.wait()  # or simulated time would run out for whoever waits for the picture
        delay = self._pacer.delay(simulated)
        self._stopped.wait(delay) if delay > 0 else time.sleep(0)
        if time.monotonic() - self._reported > REPORT_PERIOD:
            self._reported = time.monotonic()
            self._factor.publish(Float64(data=self._pacer.achieved()))

    def _tick(self) -> float:
        simulated = self.advance()
        self._brake.watch()
        self._frames.step(self.simulator.model, self.simulator.data)
        return simulated

    def on_peer_end(self, peer: str) -> None:
        self._gate.note_end(peer)


def run_sim_with_camera(make: Callable[[], Node]) -> int:
    """As `run_node`; drawing in software leaves the other cores to the physics, and memory to the others."""
    os.environ.setdefault("LP_NUM_THREADS", "1")  # of Mesa's llvmpipe
    ctypes.CDLL("libc.so.6").mallopt(M_MMAP_THRESHOLD, LARGE)
    return run_node(make)
