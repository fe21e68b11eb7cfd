"""Where a layout's boxes are to stand, for viewers."""

from __future__ import annotations

from pack_core.palletizing.cell import PalletizingCell
from pack_core.palletizing.orders.layout_plan import LayoutPlan
from pack_core.rotations import Array, Pose


def places(plan: LayoutPlan, cell: PalletizingCell) -> dict[str, tuple[Array, Pose]]:
    """Extents along the pallet's axes `(3,)` [m] and X_WG, the pose of the middle, by the box's name."""
    X_WP = cell.pallet.X_WP
    boxes = (planned.placed for planned in plan.boxes)
    return {box.id: (box.size, X_WP @ Pose(box.centre)) for box in boxes}
