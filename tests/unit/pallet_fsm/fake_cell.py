"""A consistent cell without physics: boxes follow the hand, faults come on request."""

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from pack_core.motion.world import Obstacle
from pack_core.palletizing.boxes import BoxDetection, DetectionStatus
from pack_core.palletizing.cell import PalletizingCell, palletizing_cell
from pack_core.palletizing.grip import ASKED, GripState
from pack_core.palletizing.orders.order import Order
from pack_core.palletizing.ports import (
    CloseGripper,
    Command,
    DiscardBox,
    OpenGripper,
    PalletObservation,
    PursueTarget,
    ScanPlace,
    SpawnBox,
    StopArm,
    TakePicture,
)
from pack_core.palletizing.scanner import PlaceScan
from pack_core.rotations import POINTING_DOWN, Pose, from_yaw, multiply
from pallet_fsm.order_book import standing_box
from unit.pack_perception.scans.closed_form import scan_of
from unit.pallet_fsm.fake_motion import FakeMotion
from unit.pallet_fsm.faults import Faults

PERIOD = 0.05
HOME = Pose(np.array([0.0, 0.5, 2.0]), POINTING_DOWN)
REACH = 0.01
TURN = 0.3
"""By which somebody turns a box [rad]."""
MUTES = {
    SpawnBox: "feeder",
    TakePicture: "camera",
    ScanPlace: "scanner",
    PursueTarget: "motion",
    CloseGripper: "gripper",
    OpenGripper: "gripper",
}
"""Which part of the cell does a command."""


@dataclass
class FakeCell:
    """Boxes by name, with their true poses; and strangers, which belong to no order.

    The camera takes `exposure` [s] until a picture has been looked through.
    """

    order: Order
    faults: Faults = field(default_factory=Faults)
    time: float = 0.0
    X_WT: Pose = HOME
    grip: GripState = field(default_factory=lambda: GripState(reason=ASKED))
    boxes: dict[str, Pose] = field(default_factory=dict)
    spawned: str = ""
    detection: BoxDetection | None = None
    scans: dict[str, PlaceScan] = field(default_factory=dict)
    strangers: list[Obstacle] = field(default_factory=list)
    exposure: float = 0.0
    has_stopped: bool = False

    def __post_init__(self) -> None:
        self._cell: PalletizingCell = palletizing_cell()
        self._motion = FakeMotion(self.faults)
        self._rng = np.random.default_rng(0)
        self._picture: tuple[float, BoxDetection] | None = None

    def observe(self) -> PalletObservation:
        self.time += PERIOD
        self._advance()
        if self._picture is not None and self.time >= self._picture[0]:
            self.detection, self._picture = self._picture[1], None
        scans = tuple(self.scans.values())
        status = self._motion.status(self.time, self.X_WT)
        return PalletObservation(self.time, status, self.grip, self.spawned, self.detection, scans)

    def apply(self, command: Command) -> None:
        actions: dict[type, Callable[[], None]] = {
            SpawnBox: lambda: self._spawn(command.name, command.dims),
            DiscardBox: lambda: self._discard(command.name),
            TakePicture: lambda: self._look(command.expected),
            ScanPlace: lambda: self._scan(command.place),
            PursueTarget: lambda: self._motion.take(command.target, is_holding=bool(self.grip.held)),
            StopArm: self._stop,
            CloseGripper: self._close,
            OpenGripper: lambda: self._open(ASKED),
        }
        if MUTES.get(type(command)) not in self.faults.mute:
            actions[type(command)]()

    def _spawn(self, name: str, dims: tuple[float, float, float]) -> None:
        x, y = np.array(self._cell.picking_table.centre) + self._rng.uniform(-0.1, 0.1, 2)
        yaw = np.deg2rad(self._rng.uniform(-10, 10))
        self.boxes[name] = Pose([x, y, self._cell.picking_table.height + dims[2] / 2], from_yaw(yaw))
        self.spawned = name

    def _discard(self, name: str) -> None:
        self.boxes.pop(name, None)

    def _scan(self, place: str) -> None:
        standing = [
            standing_box(item, self.boxes[item.id])
            for item in self.order.boxes
            if item.id in self.boxes and item.id != self.grip.held
        ]
        blocks = (*self._cell.furniture, *standing, *self.strangers)
        self.scans[place] = scan_of(self._cell, place, blocks, self.time)

    def _look(self, expected) -> None:
        status, reason, X_WB = DetectionStatus.DETECTED, "", self.boxes[expected.id]
        if self.faults.unseen:
            self.faults.unseen -= 1
            status, reason, X_WB = DetectionStatus.NOT_FOUND, "no contour", None
        elif self.faults.wrong_size:
            self.faults.wrong_size -= 1
            status, reason, X_WB = DetectionStatus.WRONG_SIZE, "20 mm too long", None
        if self.faults.turned and X_WB is not None:
            self.faults.turned -= 1
            self.boxes[expected.id] = Pose(X_WB.p, multiply(from_yaw(TURN), X_WB.q))
        found = BoxDetection(self.time, expected.id, status, reason, X_WB, None, None)
        self._picture = self.time + self.exposure, found

    def _stop(self) -> None:
        self.has_stopped = True
        self._motion.stop()

    def _close(self) -> None:
        held = "" if self._slips() else self._under_pad()
        if held:
            self._X_TB = self.X_WT.inverse() @ self.boxes[held]
            self.grip = GripState(held=held)
        else:
            self.grip = GripState(reason="no face within reach")

    def _slips(self) -> bool:
        """Whether this grip fails; counts it."""
        table = self._cell.reorientation_table
        is_at_b = bool(np.all(np.abs(self.X_WT.p[:2] - table.centre) < table.size))
        name = "table_slips" if is_at_b else "slips"
        left = getattr(self.faults, name)
        setattr(self.faults, name, max(0, left - 1))
        return left > 0

    def _open(self, reason: str) -> None:
        if held := self.grip.held:
            X_WB = self.boxes[held]
            self.boxes[held] = Pose(X_WB.p - [0.0, 0.0, 0.002], X_WB.q)
        self.grip = GripState(reason=reason)

    def _under_pad(self) -> str:
        for item in self.order.boxes:
            if item.id in self.boxes:
                p_TB = (self.X_WT.inverse() @ self.boxes[item.id]).p
                if np.linalg.norm(p_TB[:2]) < REACH and p_TB[2] < max(item.dims) / 2 + REACH:
                    return item.id
        return ""

    def _advance(self) -> None:
        ended = self._motion.advance(is_holding=bool(self.grip.held))
        if ended is None:
            return
        label, self.X_WT = ended
        if label == self.faults.lost_at and self.grip.held:
            self._open(self.faults.reason)
        if self.grip.held:
            self.boxes[self.grip.held] = self.X_WT @ self._X_TB
