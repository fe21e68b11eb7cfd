"""A consistent cell without physics: moves end exactly, boxes follow the hand, faults come on request."""

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from pack_core.motion.moves import Path, Transfer
from pack_core.motion.target import MotionState, MotionStatus, MotionTarget
from pack_core.motion.world import Obstacle
from pack_core.palletizing.box_detection import BoxDetection, DetectionStatus
from pack_core.palletizing.cell import PalletizingCell, palletizing_cell
from pack_core.palletizing.grip import ASKED, GripState
from pack_core.palletizing.orders.layout_plan import Insertion, LayoutPlan, LayoutStatus, PlannedBox
from pack_core.palletizing.orders.order import Order
from pack_core.palletizing.orders.order_file import load_order
from pack_core.palletizing.scanner import PlaceScan
from pack_core.paths import config_path
from pack_core.rotations import Pose, angle_between, from_yaw, multiply
from pallet_fsm.palletizer import Palletizer
from pallet_fsm.palletizer_config import PalletizerConfig
from pallet_fsm.ports import (
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
from pallet_fsm.scans.look import ScanConfig
from pallet_fsm.surroundings import furniture, standing_box
from pallet_fsm.tool_poses import LOOKING_DOWN
from unit.pallet_fsm.scans.closed_form import scan_of

PERIOD = 0.05
TICKS = 2
"""Per segment of a move."""
HELD_TICKS = 10
HOME = Pose(np.array([0.0, 0.5, 2.0]), LOOKING_DOWN)
REACH = 0.01
LAST_LINES = ("FINAL", "GRASP")
STOPS = {
    "held": (MotionState.HELD, ""),
    "lost_ways": (MotionState.REFUSED, "the wrist would hit box 3"),
    "stuck": (MotionState.STUCK, "no progress for 1 s"),
    "stuck_at_box": (MotionState.STUCK, "no progress for 1 s"),
}
"""State and reason of the motion after each fault that stops it."""
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


NO_SCANS = ScanConfig(period=0.0)
"""Most tests do without scans, which take most of the time here."""


@dataclass
class Faults:
    """What shall go wrong.

    Attributes:
        unseen: pictures in which there still will be no box.
        turned: pictures after which the box still will be turned by somebody.
        wrong_size: pictures in which it still will have another size.
        slips: grips that still will fail at table A.
        table_slips: the same at table B.
        stuck: moves that still will stop on their way.
        stuck_at_box: moves that still will stop on their last line down to a box on table A.
        refused: moves that still will be refused.
        refused_carrying: the same, counting only those with a box in the hand.
        held: how often the driver still will hold the arm.
        lost_ways: moves that still will find no way on after that.
        lost_at: label of the segment at whose end the hand loses its box; empty: it does not.
        reason: that the gripper gives then.
        mute: parts of the cell that take commands and answer none.
    """

    unseen: int = 0
    turned: int = 0
    wrong_size: int = 0
    slips: int = 0
    table_slips: int = 0
    stuck: int = 0
    stuck_at_box: int = 0
    refused: int = 0
    refused_carrying: int = 0
    held: int = 0
    lost_ways: int = 0
    lost_at: str = ""
    reason: str = ""
    mute: frozenset[str] = frozenset()


@dataclass
class FakeCell:
    """Boxes by name, with their true poses; and strangers, which belong to no order."""

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
    has_stopped: bool = False

    def __post_init__(self) -> None:
        self._cell: PalletizingCell = palletizing_cell()
        self._target: MotionTarget | None = None
        self._state, self._reason, self._ticks = MotionState.IDLE, "", 0
        self._segments: list[tuple[str, Pose]] = []
        self._rng = np.random.default_rng(0)

    def observe(self) -> PalletObservation:
        self.time += PERIOD
        self._advance()
        scans = tuple(self.scans.values())
        return PalletObservation(self.time, self._status(), self.grip, self.spawned, self.detection, scans)

    def apply(self, command: Command) -> None:
        actions: dict[type, Callable[[], None]] = {
            SpawnBox: lambda: self._spawn(command.name, command.dims),
            DiscardBox: lambda: self._discard(command.name),
            TakePicture: lambda: self._look(command.expected),
            ScanPlace: lambda: self._scan(command.place),
            PursueTarget: lambda: self._take(command.target),
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
        blocks = (*furniture(self._cell), *standing, *self.strangers)
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
        self.detection = BoxDetection(self.time, expected.id, status, reason, X_WB, None, None)

    def _take(self, target: MotionTarget) -> None:
        self._target, self._ticks = target, 0
        if self._is_refused():
            self._state, self._reason = MotionState.REFUSED, "the wrist would hit box 3"
            return
        self._state, self._reason, self._segments = MotionState.MOVING, "", segments(target)

    def _is_refused(self) -> bool:
        faults = self.faults
        if self.grip.held and faults.refused_carrying:
            faults.refused_carrying -= 1
            return True
        faults.refused, had = max(0, faults.refused - 1), faults.refused
        return had > 0

    def _stop(self) -> None:
        self.has_stopped, self._segments = True, []
        if self._state is MotionState.MOVING:
            self._state = MotionState.REACHED

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
        if self._state is MotionState.HELD:
            self._ticks += 1
            self._state = MotionState.HELD if self._ticks % HELD_TICKS else MotionState.MOVING
        if self._state is not MotionState.MOVING:
            return
        self._ticks += 1
        if self._ticks % TICKS:
            return
        if (fault := self._fault()) is not None:
            setattr(self.faults, fault, getattr(self.faults, fault) - 1)
            self._state, self._reason = STOPS[fault]
            return
        label, self.X_WT = self._segments.pop(0)
        if label == self.faults.lost_at and self.grip.held:
            self._open(self.faults.reason)
        if self.grip.held:
            self.boxes[self.grip.held] = self.X_WT @ self._X_TB
        if not self._segments:
            self._state = MotionState.REACHED

    def _fault(self) -> str | None:
        """Which fault ends the present segment, if any."""
        is_last_line = not self.grip.held and self._segments[0][0] in LAST_LINES
        for name in STOPS:
            if getattr(self.faults, name) and (name != "stuck_at_box" or is_last_line):
                return name
        return None

    def _status(self) -> MotionStatus:
        label = self._segments[0][0] if self._segments else ""
        return MotionStatus(
            self.time, self._target.id if self._target else 0, self._state, 0, label, 0.0,
            0.0, 0.0, 0.0, 3, self._reason, self.X_WT,
        )  # fmt: skip


def segments(target: MotionTarget) -> list[tuple[str, Pose]]:
    """Labels and ends; where a depart or a hover pose is does not matter here."""
    move = target.move
    if isinstance(move, Path):
        return [(segment.label, segment.X_WT) for segment in move.segments]
    assert isinstance(move, Transfer)
    first = move.lines[0].X_WT
    labels = ["depart", "transit"] if move.depart else ["transit"]
    return [*((label, first) for label in labels), *((line.label, line.X_WT) for line in move.lines)]


def given_order(number: int) -> Order:
    return load_order(config_path("orders", f"order_{number:02}.json"))


def plan_as_given(order: Order) -> LayoutPlan:
    straight = Insertion("Center", np.zeros(3), 0.0)
    boxes = tuple(PlannedBox(item, straight) for item in order.placed)
    return LayoutPlan(LayoutStatus.SUCCESS, "", boxes, 0.0, 0.0)


def run(order: Order, profile: str = "blended", faults: Faults | None = None) -> tuple[Palletizer, FakeCell]:
    """An order from start to end."""
    cell = FakeCell(order, faults or Faults())
    config = PalletizerConfig(profile=profile, scans=NO_SCANS)
    machine = Palletizer(order, plan_as_given(order), palletizing_cell(), config, 0.0)
    while not machine.machine.is_over:
        for command in machine.step(cell.observe()):
            cell.apply(command)
        assert cell.time < 600.0, machine.machine.visits[-5:]
    return machine, cell


def misplacement(cell: FakeCell, report) -> tuple[float, float]:
    """Largest distance [m] and angle [rad] of any placed box from where it was meant to stand."""
    errors = [
        (
            float(np.linalg.norm(cell.boxes[box.name].p - box.X_WB.p)),
            float(angle_between(cell.boxes[box.name].q, box.X_WB.q)),
        )
        for box in report.boxes
        if box.outcome == "placed"
    ]
    return max(e[0] for e in errors), max(e[1] for e in errors)
