"""One scanner's looks at its place: when it looks, and what is not as it should be there."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Self

from pydantic import Field, NonNegativeFloat, PositiveFloat, model_validator

from pack_core.config import Config
from pack_core.motion.world import CarriedBox, Obstacle
from pack_core.palletizing.cell import PalletizingCell
from pack_core.palletizing.ports import PalletObservation, ScanPlace
from pack_core.palletizing.scanner import ScannerMount
from pallet_fsm.scans.comparison import ScannedScene, ScanTolerances, compare
from pallet_fsm.scans.findings import Finding
from pallet_fsm.scans.rays import Rays
from pallet_fsm.scans.shadow import ArmShadow

GAP = 0.1
"""Time between two measurements of the arm in which it cannot come over a place and be gone again [s]."""


class ScanConfig(Config):
    """When the pallet and table B are scanned, and what counts as a change."""

    period: NonNegativeFloat = Field(
        default=0.2, description="between two scans while the arm comes near or leaves; 0: never [s]"
    )
    near: PositiveFloat = Field(
        default=0.5,
        description="distance of arm and carried box from a place, seen from above, within which it is "
        "scanned; while they are farther away nothing depends on it [m]",
    )
    clear: PositiveFloat = Field(
        default=0.15, description="distance from which on a scan is asked for: the arm moves meanwhile [m]"
    )
    hides: PositiveFloat = Field(
        default=0.1, description="distance below which they may hide something of the place [m]"
    )
    patience: PositiveFloat = Field(default=5.0, description="longest time until a scanner answers [s]")
    tolerances: ScanTolerances = ScanTolerances()

    @model_validator(mode="after")
    def _leaves_room_to_look(self) -> Self:
        if not self.hides <= self.clear < self.near:
            raise ValueError(
                f"hides, clear and near are {self.hides}, {self.clear} and {self.near} m; allowed: "
                "hides <= clear < near, or nothing is ever scanned"
            )
        return self


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
        mount: ScannerMount = getattr(cell.scanners, name)
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
