"""A consistent cell for shifts without physics: boxes come on a conveyor and follow the hand."""

from dataclasses import dataclass, field, replace

import numpy as np

from pack_core.motion.world import Obstacle
from pack_core.palletizing.cell import palletizing_cell
from pack_core.palletizing.infeed import InfeedState
from pack_core.palletizing.orders.item_list import Item
from pack_core.palletizing.orders.next_place import PlaceAnswer
from pack_core.palletizing.ports import AskPlace, Command, PalletObservation, SendBox, TakePallet
from pack_core.palletizing.shift_journal import EventKind, ShiftEvent
from pack_core.rotations import Pose, from_yaw
from pack_planner.layout.insertion_direction import InsertionConfig
from pack_planner.layout.online_planner import OnlineConfig
from pack_planner.layout.place_answers import PlaceAnswers
from pallet_fsm.palletizer_config import FeederConfig, PalletizerConfig, ScanConfig
from pallet_fsm.shift_job import ShiftConfig, ShiftJob
from pallet_fsm.taking_over import TakenOver
from unit.pack_perception.scans.closed_form import scan_of
from unit.pallet_fsm.fake_cell import REACH, FakeCell
from unit.pallet_fsm.faults import Faults

CELL = palletizing_cell("shift")
LONGEST = 600.0
"""Time that a shift may take [s]."""
ON_THE_WAY, SWAP = 2.0, 30.0
"""Times until the next box is at the barrier, and until an empty pallet stands where a full one was [s]."""


def listed(label: str, size: tuple[float, float, float] = (0.4, 0.3, 0.2), weight: float = 5.0) -> Item:
    return Item(id=label, article=label, size=size, weight=weight, this_side_up=False)


@dataclass(frozen=True)
class Came:
    """A box that comes: what its label says, and its size if that is another one [m]."""

    label: str
    size: tuple[float, float, float] | None = None


@dataclass
class FakeShiftCell(FakeCell):
    """Boxes by name with their sizes; those that come, in order; and the planner that is asked."""

    stream: list[Came] = field(default_factory=list)
    catalogue: dict[str, Item] = field(default_factory=dict)
    config: OnlineConfig = field(default_factory=OnlineConfig)

    def __post_init__(self) -> None:
        super().__post_init__()
        self._cell = CELL
        self.sent: list[float] = []
        self.sizes: dict[str, tuple[float, float, float]] = {}
        self.X_WT = Pose(np.array([-0.4, 1.5, 2.0]), self.X_WT.q)
        self._planner = PlaceAnswers(CELL, self.config, InsertionConfig())
        self._answer: PlaceAnswer | None = None
        self._infeed, self._due, self._away = InfeedState(0.0), np.inf, dict[str, float]()

    def observe(self) -> PalletObservation:
        seen = super().observe()
        if self.time >= self._due:
            self._bring()
        taken = frozenset(place for place, end in self._away.items() if self.time < end)
        return replace(seen, infeed=self._infeed, place=self._answer, taken=taken)

    def apply(self, command: Command) -> None:
        match command:
            case SendBox():
                self.sent.append(self.time)
                self._infeed = replace(self._infeed, box="", label="")
                self._due = self.time + ON_THE_WAY if self.stream else np.inf
            case AskPlace(question):
                self._answer = self._planner.answer(question)
            case TakePallet(place, boxes):
                self._away[place] = self.time + SWAP
                for name in boxes:
                    del self.boxes[name]
            case _:
                super().apply(command)

    def _bring(self) -> None:
        came, number, self._due = self.stream.pop(0), self._infeed.number + 1, np.inf
        size = came.size or tuple(sorted(self.catalogue[came.label].size, reverse=True))
        (x, y), z = CELL.picking_table.centre, CELL.picking_table.height + 0.5 * size[2]
        name = f"b{number}"
        self.boxes[name], self.sizes[name] = Pose(np.array([x, y, z]), from_yaw(0.1)), size
        self._infeed = InfeedState(self.time, number, name, came.label)

    def _scan(self, place: str) -> None:
        standing = [
            Obstacle(name, X_WB, np.array(self.sizes[name]))
            for name, X_WB in self.boxes.items()
            if name != self.grip.held
        ]
        blocks = (*CELL.furniture, *standing, *self.strangers)
        self.scans[place] = scan_of(CELL, place, blocks, self.time)

    def _under_pad(self) -> str:
        for name, X_WB in self.boxes.items():
            p_TB = (self.X_WT.inverse() @ X_WB).p
            if np.linalg.norm(p_TB[:2]) < REACH and 0.0 < p_TB[2] < max(self.sizes[name]) / 2 + REACH:
                return name
        return ""


@dataclass
class ShiftRunning:
    """A shift, its cell and what has happened."""

    job: ShiftJob
    cell: FakeShiftCell
    events: list[ShiftEvent] = field(default_factory=list)

    def of(self, kind: EventKind) -> list[ShiftEvent]:
        return [event for event in self.events if event.kind is kind]


def run_shift(
    stream: list[Came], catalogue: list[Item], config: OnlineConfig | None = None,
    faults: Faults | None = None, *, scans: ScanConfig | None = None, boxes: int | None = None,
    feeder: FeederConfig | None = None,
) -> ShiftRunning:  # fmt: skip
    """A shift from start to end; `scans` says when pallets and table B are scanned, by default never."""
    labels = {item.id: item for item in catalogue}
    cell = FakeShiftCell(
        None, faults or Faults(), stream=stream, catalogue=labels, config=config or OnlineConfig()
    )
    return go_on(cell, boxes or len(stream), scans=scans, feeder=feeder)


def go_on(
    cell: FakeShiftCell, boxes: int, taken_over: TakenOver | None = None, *, scans: ScanConfig | None = None,
    feeder: FeederConfig | None = None,
) -> ShiftRunning:  # fmt: skip
    """A shift in a cell in which something may stand already."""
    machine = PalletizerConfig(scans=scans or ScanConfig(period=0.0), feeder=feeder or FeederConfig())
    job = ShiftJob(CELL, cell.catalogue, ShiftConfig(patience=20.0), machine, boxes, taken_over)
    shift = ShiftRunning(job, cell)
    while not job.is_over:
        for command in job.step(cell.observe()):
            cell.apply(command)
        shift.events += job.events()
        assert cell.time < LONGEST, shift.events[-5:]
    return shift
