"""The topics of the scanners over the pallet and over table B."""

from __future__ import annotations

from pack_core.ros.contracts import palletizing as contracts
from pack_core.ros.messages.palletizing import to_cloud
from pack_core.ros.node import CellNode
from pack_sim.palletizing.place_scanner import PlaceScanner
from pack_sim.palletizing.snapshot import PhysicsSnapshot


class ScanPublisher:
    """Publishes scans.

    Args:
        node: the node that publishes.
        scanner: makes them.
    """

    def __init__(self, node: CellNode, scanner: PlaceScanner) -> None:
        self._scanner = scanner
        self._points = {
            "pallet": node.advertise(contracts.PALLET_SCAN),
            "reorientation_table": node.advertise(contracts.TABLE_SCAN),
        }

    def publish(self, place: str, still: PhysicsSnapshot) -> None:
        """Scan a place as it was when the physics was held still, and publish the points."""
        self._points[place].publish(to_cloud(self._scanner.scan(place, still)))
