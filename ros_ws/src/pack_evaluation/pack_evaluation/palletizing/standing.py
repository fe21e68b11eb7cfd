"""Where the things of a recorded cell truly stand."""

from __future__ import annotations

import numpy as np

from pack_core.palletizing.cell import palletizing_cell
from pack_core.palletizing.imperfections import Displacement
from pack_core.palletizing.model import fixed_frames
from pack_core.robots.kr210 import BASE
from pack_core.rotations import Pose
from pack_evaluation.bag import Bag
from pack_evaluation.palletizing.run import StandingCell

TF_STATIC, DECK = "/tf_static", "pallet_deck"
"""The topic that has the frames of what stands still, and the pallet's frame."""
TABLES = ("picking_table", "reorientation_table")


def frames_in(bag: Bag) -> dict[str, Pose]:
    """The true poses of what stands still in the world, by the names of the frames; the newest of each."""
    found: dict[str, Pose] = {}
    for message in bag.of(TF_STATIC):
        for item in message.transforms:
            if item.header.frame_id == "world":
                p, q = item.transform.translation, item.transform.rotation
                pose = Pose(np.array([p.x, p.y, p.z]), np.array([q.w, q.x, q.y, q.z]))
                found[item.child_frame_id] = pose
    return found


def standing_cell(frames: dict[str, Pose]) -> StandingCell:
    """The cell with tables, pallet and arm at the poses of frames; what has none stands where it should."""
    cell = palletizing_cell()
    nominal = {name: Pose(getattr(cell, name).middle) for name in TABLES}
    nominal["pallet"] = fixed_frames(cell)[DECK][1]
    true = {**frames, "pallet": frames.get(DECK, nominal["pallet"])}
    moved = {
        name: getattr(cell, name).model_copy(
            update={"displacement": Displacement.between(X_WF, true[name], getattr(cell, name).middle)}
        )
        for name, X_WF in nominal.items()
        if name in true
    }
    return StandingCell(cell.model_copy(update=moved), frames.get(BASE))
