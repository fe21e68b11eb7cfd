"""A cell in which the held object and the pump hide what stands in the middle of the container."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from integration.packing.cell_rig import EASY
from pack_core.packing.scene_file import load_scene
from pack_core.rotations import Pose

FROM_ABOVE = (
    "{mocap: {cameras: [[0.5, 0.0, 2.4], [0.45, 0.1, 2.4], [0.45, -0.1, 2.4]], has_side_markers: false}}"
)
"""What lies over config/cells/packing.yaml: all cameras are right above the container."""


def write_hidden_scene(folder: Path) -> Path:
    """The easy scene with its box moved under the held object; there is still room beside it."""
    scene = load_scene(EASY)
    moved = {"soup_can": Pose(np.array([0.41, 0.06, 0.055])), "tea_box": Pose(np.array([0.5, 0.0, 0.065]))}
    path = folder / "hidden_scene.yaml"
    path.write_text(scene.with_poses(moved).to_yaml())
    return path
