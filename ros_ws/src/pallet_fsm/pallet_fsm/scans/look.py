"""One scanner's looks at its place: when it looks, and what is not as it should be there."""

from __future__ import annotations

from pydantic import Field, NonNegativeFloat, PositiveFloat

from pack_core.config import Config
from pack_core.motion.world import CarriedBox, Obstacle
from pack_core.palletizing.cell import PalletizingCell
from pack_core.palletizing.scanner import PlaceScan, ScannerMount
from pallet_fsm.ports import PalletObservation, ScanPlace
from pallet_fsm.scans.comparison import ScanTolerances, Scene, compare
from pallet_fsm.scans.findings import Finding
from pallet_fsm.scans.rays import Rays
from pallet_fsm.scans.shadow import clearance


class ScanConfig(Config):
    """When the pallet and table B are scanned, and what counts as a change."""

    period: NonNegativeFloat = Field(
        default=0.2, description="between two scans while the arm comes near or leaves; 0: never [s]"
    )
    clear: PositiveFloat = Field(
        default=0.12,
        description="distance of arm and carried box from a place, seen from above, at which they hide "
        "nothing of it [m]",
    )
    near: PositiveFloat = Field(
        default=0.5,
        description="distance within which the place is scanned; farther away nothing depends on it [m]",
    )
    patience: PositiveFloat = Field(default=5.0, description="longest time until a scanner answers [s]")
    tolerances: ScanTolerances = ScanTolerances()


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
        self._p_WB, self._X_WS = cell.arm.X_WB.p, cell.scanner_pose(name)
        mount: ScannerMount = getattr(cell.scanners, name)
        # On what is higher than the place rays are denser: less of it is enough to count.
        self._least = config.tolerances.area / mount.spacing**2
        self._asked = -float("inf")
        self._expected: tuple[Obstacle, ...] | None = None

    @property
    def is_awaited(self) -> bool:
        """Whether a scan was asked for and has not come."""
        return self._expected is not None

    def is_late(self, time: float) -> bool:
        """Whether the scanner has not answered in time."""
        return self.is_awaited and time > self._asked + self._config.patience

    def ask(
        self, seen: PalletObservation, boxes: tuple[Obstacle, ...], carried: CarriedBox | None
    ) -> ScanPlace | None:
        """A scan, if it is time for one; `boxes` are those that must stand there now."""
        config = self._config
        if not config.period or self.is_awaited or seen.time < self._asked + config.period:
            return None
        apart = clearance(self._place, self._p_WB, seen.motion.X_WT, carried)
        if not config.clear <= apart <= config.near:
            return None
        self._asked, self._expected = seen.time, boxes
        return ScanPlace(self._name)

    def answer(self, scans: tuple[PlaceScan, ...]) -> tuple[Finding, ...]:
        """What is not as it was to be when the scan was asked for; nothing before it has come."""
        if self._expected is None:
            return ()
        for scan in scans:
            if scan.place == self._name and scan.time >= self._asked:
                scene = Scene(Rays.of(scan, self._X_WS), self._place, self._expected, self._least)
                self._expected = None
                return compare(scene, self._config.tolerances)
        return ()
