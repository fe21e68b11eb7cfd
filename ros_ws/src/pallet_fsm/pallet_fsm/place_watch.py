"""What the machine watches on pallets and on table B: that all stands as it was put there.

Each place is scanned again and again while the arm is near it and hides nothing of it.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

import numba
import numpy as np

from pack_core.motion.world import CarriedBox, Obstacle
from pack_core.palletizing.cell import (
    PALLET,
    REORIENTATION_TABLE,
    SECOND_PALLET,
    PalletizingCell,
    palletizing_cell,
)
from pack_core.palletizing.orders.handling import Handling
from pack_core.palletizing.ports import Command, PalletObservation, ScanPlace
from pack_core.robots.kr210 import WRIST_LENGTH
from pack_core.rotations import Array, Pose, from_yaw, multiply
from pack_perception.scans.comparison import Finding, Oddity, ScannedScene, compare
from pack_perception.scans.rays import Rays
from pallet_fsm.order_book import OrderBook
from pallet_fsm.palletizer_config import ScanConfig, SmallMoveConfig
from pallet_fsm.states import BEFORE_REGRASP, State
from pallet_fsm.transitions import Event, Happening

_PARTS = 64
"""Of a line, whose ends are looked at: at 3 m of length they are 5 cm apart."""


class ArmShadow:
    """How far arm and carried box are from being over a place.

    A scanner hangs over the middle of its place, so that only what is over the place can hide any of it. Seen
    from above the arm is a line from its base to its wrist, as its shoulder and elbow turn in one vertical
    plane, and one from there to the pad; a carried box is a circle about the pad.

    Args:
        place: table or pallet.
        cell: the cell's physical facts.
    """

    def __init__(self, place: Obstacle, cell: PalletizingCell) -> None:
        self._X_PW, self._half = place.X_WO.inverse(), 0.5 * place.size[:2]
        self._p_PB = self._X_PW.apply(cell.arm.X_WB.p)
        self._p_TH = np.array([0.0, 0.0, -cell.tool.length - WRIST_LENGTH])

    def clearance(self, X_WT: Pose, carried: CarriedBox | None) -> float:
        """Distance of both from the place, seen from above [m]; negative where the box is over it.

        Args:
            X_WT: the measured tool.
            carried: the box in the hand, if there is one.
        """
        half, wrist, pad = self._half, self._X_PW.apply(X_WT.apply(self._p_TH)), self._X_PW.apply(X_WT.p)
        arm = min(_distance(self._p_PB, wrist, half), _distance(wrist, pad, half))
        if carried is None:
            return float(arm)
        return float(min(arm, _distance(pad, pad, half) - _radius(X_WT.q, carried.corners)))


@numba.njit(cache=True)
def _distance(start: Array, end: Array, half: Array) -> float:
    """Of a line from the place, seen from above [m]: that of the nearest of its points that are looked at.

    Args:
        start: of the line, in the place's frame `(3,)` [m].
        end: likewise.
        half: half the place's edges along x and y `(2,)` [m].
    """
    nearest = np.inf
    for k in range(_PARTS + 1):
        square = 0.0
        for i in range(2):
            beyond = max(abs(start[i] + k / _PARTS * (end[i] - start[i])) - half[i], 0.0)
            square += beyond * beyond
        nearest = min(nearest, square)
    return float(np.sqrt(nearest))


@numba.njit(cache=True)
def _radius(q_WT: Array, corners: Array) -> float:
    """Of the circle about the pad, seen from above, in which a carried box is [m].

    Args:
        q_WT: orientation of the tool `(4,)`.
        corners: of the box in the tool's frame `(8, 3)` [m].
    """
    w, a, b, c = q_WT
    farthest = 0.0
    for i in range(len(corners)):
        # v + w t + u x t, with u = (a, b, c) and t = 2 u x v; only its parts along x and y
        x, y, z = corners[i]
        t, s, r = 2.0 * (b * z - c * y), 2.0 * (c * x - a * z), 2.0 * (a * y - b * x)
        across, along = x + w * t + b * r - c * s, y + w * s + c * t - a * r
        farthest = max(farthest, across * across + along * along)
    return float(np.sqrt(farthest))


GAP = 0.1
"""Time between two measurements of the arm in which it cannot come over a place and be gone again [s]."""


@dataclass(frozen=True)
class ArmDistance:
    """How far arm and carried box were from a place when they were measured: time [s] and clearance [m]."""

    time: float
    clearance: float


class PlaceLook:
    """Looks at one place, again and again while the arm is near it and hides nothing.

    Args:
        name: of the place, one of `SCANNED`.
        place: the place, down to the floor.
        cell: the cell's physical facts.
        config: when it looks, and what counts.
    """

    def __init__(self, name: str, place: Obstacle, cell: PalletizingCell, config: ScanConfig) -> None:
        self._name, self._place, self._config = name, place, config
        self._shadow, self._X_WS = ArmShadow(place, cell), cell.scanner_pose(name)
        mount = cell.scanner(name)
        # On what is higher than the place rays are denser: less of it is enough to count.
        self._least = config.tolerances.area / mount.spacing**2
        self._asked = -float("inf")
        self._expected: tuple[Obstacle, ...] | None = None
        self._distances: list[ArmDistance] = []

    @property
    def is_awaited(self) -> bool:
        """Whether a scan was asked for and has not come."""
        return self._expected is not None

    def is_late(self, time: float) -> bool:
        """Whether the scanner has not answered in time."""
        return self.is_awaited and time > self._asked + self._config.patience

    def ask(
        self, seen: PalletObservation, boxes: Callable[[], tuple[Obstacle, ...]], carried: CarriedBox | None
    ) -> ScanPlace | None:
        """A scan, if it is time for one; `boxes` gives those that must stand there now."""
        config = self._config
        if self.is_awaited or not config.period or seen.time < self._asked + config.period:
            return None
        distance = self._distance(seen, carried)
        if not config.clear <= distance.clearance <= config.near:
            return None
        self._asked, self._expected, self._distances = seen.time, boxes(), [distance]
        return ScanPlace(self._name)

    def answer(self, seen: PalletObservation, carried: CarriedBox | None) -> tuple[Finding, ...]:
        """What is not as it was to be when the scan was asked for.

        There is nothing to tell before the scan has come, and the arm was measured at its time or later: a
        scan tells something only if the arm is known to have hidden nothing then.
        """
        if self._expected is None:
            return ()
        self._distances.append(self._distance(seen, carried))
        for scan in seen.scans:
            if scan.place == self._name and self._asked <= scan.time <= seen.motion.time:
                scene = ScannedScene(Rays.of(scan, self._X_WS), self._place, self._expected, self._least)
                self._expected = None
                return compare(scene, self._config.tolerances) if self._is_free(scan.time) else ()
        return ()

    def _distance(self, seen: PalletObservation, carried: CarriedBox | None) -> ArmDistance:
        return ArmDistance(seen.motion.time, self._shadow.clearance(seen.motion.X_WT, carried))

    def _is_free(self, time: float) -> bool:
        """Whether the arm hid nothing at `time` [s], by what was measured since the scan was asked for.

        Between two measurements that are far apart in time the arm may have come and gone.
        """
        after = next(i for i, distance in enumerate(self._distances) if distance.time >= time)
        until = self._distances[: after + 1]
        is_gapless = after == 0 or until[-1].time - until[-2].time <= GAP
        return is_gapless and all(distance.clearance > self._config.hides for distance in until)


class PlaceWatch:
    """Has pallets and table B scanned, and tells what is not as it should be.

    Args:
        config: when places are scanned, and what counts as a change.
        cell: the cell's physical facts.
        book: what must stand where.
    """

    def __init__(self, config: ScanConfig, cell: PalletizingCell, book: OrderBook) -> None:
        blocks = {block.name: block for block in cell.furniture}
        self._looks = {
            name: PlaceLook(name, blocks[name], cell, config) for name in (*cell.pallets, REORIENTATION_TABLE)
        }
        self._book, self._small = book, config.small
        self._found: dict[str, tuple[Finding, ...]] = {}
        self._commands: list[Command] = []

    @property
    def is_looking(self) -> bool:
        """Whether a scan was asked for and has not come."""
        return any(look.is_awaited for look in self._looks.values())

    def observe(self, seen: PalletObservation) -> None:
        """Take note of scans that have come, and have places scanned."""
        carried = self._book.current.carried
        # A pallet may have been taken away since it was scanned: its boxes are no longer of this cell.
        self._found = {
            name: tuple(
                item for item in look.answer(seen, carried) if not item.box or self._book.has(item.box)
            )
            for name, look in self._looks.items()
        }
        for name, look in self._looks.items():
            if name in seen.taken or (name == REORIENTATION_TABLE and not self._is_table_in_use):
                continue
            command = look.ask(seen, partial(self._book.standing_on, name), carried)
            if command is not None:
                self._commands.append(command)

    def commands(self) -> tuple[Command, ...]:
        """The commands since the last call."""
        commands, self._commands = tuple(self._commands), []
        return commands

    def change(self, state: State, time: float) -> Happening | None:
        """What is seen that is not as it should be, as an event that the state knows."""
        for name, look in self._looks.items():
            if look.is_late(time):
                return Event.HALTED, f"the scanner over {WORDS[name]} does not answer"
        for name, found in self._on_pallets():
            if not self._is_harmless(found):
                return Event.PLACE_CHANGED, f"seen on {WORDS[name]}: {_words(found)}"
            for finding in found:
                self._book.relocate(finding.box, partial(moved_pose, finding), str(finding))
            self._found[name] = ()
        found = self._found.pop(
            REORIENTATION_TABLE, ()
        )  # it counts once: the machine goes on without the box
        if found:
            in_work = self._book.current.name
            is_box = state in BEFORE_REGRASP and any(finding.box == in_work for finding in found)
            event = Event.BOX_CHANGED if is_box else Event.PLACE_CHANGED
            return event, f"seen on table B: {_words(found)}"
        return None

    def note_loss(self) -> None:
        """Strike the boxes off that no longer stand in their places on a pallet."""
        for name, found in self._on_pallets():
            for finding in found:
                if finding.box:
                    self._book.lose(finding.box, f"seen on {WORDS[name]}: {finding}")

    def _is_harmless(self, found: tuple[Finding, ...]) -> bool:
        """Whether all that was found is that boxes stand a little elsewhere, not beside the box in work.

        In a shift they are known to stand there from then on; what was seen wrongly is put right by the
        next scan in the same way.
        """
        return self._book.finds_places and all(
            is_small(finding, self._small) and not self._book.is_beside(finding.box, finding.shift_W)
            for finding in found
        )

    def _on_pallets(self) -> list[tuple[str, tuple[Finding, ...]]]:
        """The pallets on which something is not as it should be, and what."""
        return [(name, found) for name, found in self._found.items() if found and name != REORIENTATION_TABLE]

    @property
    def _is_table_in_use(self) -> bool:
        """Whether the box in work is on its way to table B, or a box stands there."""
        item = self._book.current
        goes_there = item.handling is Handling.TABLE or item.deck == REORIENTATION_TABLE
        is_on_its_way = goes_there and item.X_TB is not None and item.approach is None
        return is_on_its_way or bool(self._book.standing_on(REORIENTATION_TABLE))


WORDS = {PALLET: "the pallet", SECOND_PALLET: "the second pallet", REORIENTATION_TABLE: "table B"}
"""What scanned places are called in reasons."""


def is_small(finding: Finding, config: SmallMoveConfig) -> bool:
    """Whether a box was found so little from its place that it may be known to stand there."""
    is_near = float(np.linalg.norm(finding.shift_W)) <= config.shift
    return finding.oddity is Oddity.MOVED and is_near and abs(finding.turn_deg) <= config.turn_deg


def moved_pose(finding: Finding, X_WB: Pose) -> Pose:
    """Where a box stands that was found elsewhere than at X_WB; it turned about its own vertical."""
    turn = from_yaw(np.deg2rad(finding.turn_deg))
    return Pose(X_WB.p + np.array([*finding.shift_W, 0.0]), multiply(turn, X_WB.q))


def warm_up() -> None:
    """Have numba compile the distance of the arm from a place; loads it where that was done before."""
    cell = palletizing_cell()
    box = CarriedBox(Pose(np.zeros(3)), np.ones(3))
    ArmShadow(cell.furniture[0], cell).clearance(Pose(np.zeros(3)), box)


def _words(findings: tuple[Finding, ...]) -> str:
    return "; ".join(str(finding) for finding in findings)
