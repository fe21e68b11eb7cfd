"""Takes in what the conveyor of a shift brings: measures boxes, and tells whether they are as labelled."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from pydantic import Field, NonNegativeFloat, PositiveFloat

from pack_core.config import Config
from pack_core.motion.world import Obstacle
from pack_core.palletizing.cell import PICKING_TABLE, PalletizingCell
from pack_core.palletizing.infeed import InfeedState
from pack_core.palletizing.orders.item_list import Item
from pack_core.palletizing.ports import Command, PalletObservation, ScanPlace, SendBox
from pack_core.palletizing.scanner import PlaceScan
from pack_core.rotations import Array, Pose
from pack_perception.scans.box_measurement import BoxMeasurementConfig, measure_box
from pack_perception.scans.rays import Rays
from pallet_fsm.order_book import WorkItem
from pallet_fsm.place_watch import ArmShadow

UPRIGHT = 0.01
"""By which a box may be higher than wide and still counts as lying on its largest face [m]."""


class IntakeConfig(Config):
    """When a box on the conveyor is measured, and what of it is believed."""

    settle: NonNegativeFloat = Field(
        default=0.3, description="from a box's coming to the barrier to its scan, so that it is at rest [s]"
    )
    clear: PositiveFloat = Field(
        default=0.15, description="distance of arm and carried box from the conveyor, seen from above, from "
        "which on it moves and is scanned [m]"
    )  # fmt: skip
    size_tolerance: PositiveFloat = Field(
        default=0.005, description="by which a box may differ from what its label says [m]"
    )
    patience: PositiveFloat = Field(default=5.0, description="longest time until the scanner answers [s]")
    measurement: BoxMeasurementConfig = BoxMeasurementConfig()


@dataclass(frozen=True)
class Arrival:
    """A box that came and was measured.

    Attributes:
        box: what the conveyor tracks it by.
        item: what it is; None: it belongs on no pallet.
        doubt: why it belongs on no pallet, in words; empty where it does.
        dims: measured edges, the longest first `(3,)` [m]; zeros where nothing was measured.
        X_WB: measured pose with its axes along these edges; None where the arm cannot grip it.
    """

    box: str
    item: Item | None
    doubt: str
    dims: Array
    X_WB: Pose | None


class Intake:
    """Has the conveyor bring one box after the other.

    Args:
        cell: the cell's physical facts.
        catalogue: what each label stands for.
        config: parameters.

    Attributes:
        arrival: the box that waits at the barrier; None until it was measured.
        reason: why there will be no more boxes; empty as long as there may be.
    """

    def __init__(self, cell: PalletizingCell, catalogue: Mapping[str, Item], config: IntakeConfig) -> None:
        self._catalogue, self._config = catalogue, config
        self._table = next(block for block in cell.furniture if block.name == PICKING_TABLE)
        assert cell.shift is not None
        self._room = _raised(self._table, cell.shift.infeed.headroom)
        self._shadow, self._X_WS = ArmShadow(self._table, cell), cell.scanner_pose(PICKING_TABLE)
        self._spacing = cell.scanner(PICKING_TABLE).spacing
        self._number: int | None = None
        self._came: float | None = None
        self._asked: float | None = None
        self._is_sent = False
        self.arrival: Arrival | None = None
        self.reason = ""

    def send(self) -> SendBox:
        """Have the next box brought, now that the last one has left the conveyor."""
        self.clear()
        self._is_sent = True
        return SendBox()

    def clear(self) -> None:
        """Forget the box at the barrier: it has left the conveyor."""
        self.arrival = self._came = self._asked = None

    @property
    def is_sent(self) -> bool:
        """Whether a box was sent for and was not measured."""
        return self._is_sent

    @property
    def is_measuring(self) -> bool:
        """Whether a box stands at the barrier and was not measured."""
        return self._is_sent and self._came is not None

    @property
    def is_waiting(self) -> bool:
        """Whether a box was sent for and has not come to the barrier."""
        return self._is_sent and self._came is None

    def obstacles(self) -> tuple[Obstacle, ...]:
        """What the arm must not touch on the conveyor: a box as measured, or all the room while one comes."""
        arrival = self.arrival
        if arrival is not None and arrival.X_WB is not None:
            return (Obstacle(arrival.box, arrival.X_WB, arrival.dims),)
        return (self._room,) if self._is_sent or arrival is not None else ()

    def step(self, seen: PalletObservation, work: WorkItem | None) -> tuple[Command, ...]:
        """Follow a box from the barrier to its measurement; the commands of this step.

        Args:
            seen: what is known now.
            work: the box in work, which the arm may hold over the conveyor.
        """
        infeed = seen.infeed
        if infeed is None or not self._is_sent or self.arrival is not None:
            return ()
        if not infeed.box or infeed.number != self._number:
            # None stands there, or another one than was noted: what was begun does not count.
            self._came = self._asked = None
            if infeed.box:
                self._number, self._came = infeed.number, seen.time
            return ()
        if self._came is None:
            return ()  # what the conveyor tells is from before the box was sent for
        if self._asked is None:
            return self._look(seen, work)
        scan = next((scan for scan in seen.scans if scan.place == PICKING_TABLE), None)
        if scan is not None and scan.time >= self._asked:
            self.arrival, self._is_sent = self._judged(scan, infeed), False
        elif seen.time > self._asked + self._config.patience:
            self.reason = "the scanner over the conveyor does not answer"
        return ()

    def is_clear(self, seen: PalletObservation, work: WorkItem | None) -> bool:
        """Whether arm and carried box are beside the conveyor, so that boxes may move on it and be seen."""
        carried = None if work is None else work.carried
        return self._shadow.clearance(seen.motion.X_WT, carried) >= self._config.clear

    def _look(self, seen: PalletObservation, work: WorkItem | None) -> tuple[Command, ...]:
        assert self._came is not None
        if seen.time < self._came + self._config.settle or not self.is_clear(seen, work):
            return ()
        self._asked = seen.time
        return (ScanPlace(PICKING_TABLE),)

    def _judged(self, scan: PlaceScan, infeed: InfeedState) -> Arrival:
        rays = Rays.of(scan, self._X_WS)
        found = measure_box(rays, self._table, self._spacing, self._config.measurement)
        length, width, height = found.size
        if found.X_WB is None or height > width + UPRIGHT:
            doubt = found.doubt or "it does not lie on its largest face"
            return Arrival(infeed.box, None, doubt, found.size, None)
        dims = np.array([length, max(width, height), height])
        item = self._catalogue.get(infeed.label)
        doubt = found.doubt or self._doubt(dims, item, infeed.label)
        if doubt or item is None:
            return Arrival(infeed.box, None, doubt, dims, found.X_WB)
        return Arrival(infeed.box, item.model_copy(update={"id": infeed.box}), "", dims, found.X_WB)

    def _doubt(self, dims: Array, item: Item | None, label: str) -> str:
        """Why a box that was measured well is not what it should be; empty where it is."""
        if not label:
            return "its label cannot be read"
        if item is None:
            return f"its label says '{label}', which is in no list"
        listed = np.array(sorted(item.size, reverse=True))
        if np.any(np.abs(dims - listed) > self._config.size_tolerance):
            return f"it is {_millimetres(dims)} mm, its label says {_millimetres(listed)} mm"
        return ""


def _raised(block: Obstacle, height: float) -> Obstacle:
    """A block over the conveyor, down to the floor, that is higher than it [m]."""
    higher = np.array([0.0, 0.0, height])
    return Obstacle("conveyor", block.X_WO @ Pose(0.5 * higher), block.size + higher)


def _millimetres(size: Array) -> str:
    return " x ".join(f"{1e3 * edge:.0f}" for edge in size)
