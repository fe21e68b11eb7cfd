"""Frames of the palletizing cell that stand still and are no bodies of its model, for /tf_static."""

from __future__ import annotations

from pack_core.palletizing.cell import PalletizingCell
from pack_core.palletizing.scanner import SCANNED, scanner_frame
from pack_core.rotations import Pose


def fixed_frames(cell: PalletizingCell) -> dict[str, tuple[str, Pose]]:
    """X_PF and the parent's name P, by the name of frame F.

    `pallet_deck` is the frame of orders and layouts: a corner of the deck, x along its length.
    `overhead_camera` is that of the pictures, each scanner has its own: z forward, x to the right, y down.
    """
    return {
        "pallet_deck": ("world", cell.pallet.X_WP),
        "overhead_camera": ("world", cell.overhead_camera.X_WC),
    } | {scanner_frame(place): ("world", cell.scanner_pose(place)) for place in SCANNED}
