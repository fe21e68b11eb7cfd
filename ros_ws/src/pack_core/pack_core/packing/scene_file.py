"""Reads scene files and refuses those that describe an impossible scene."""

from __future__ import annotations

from pathlib import Path

from pack_core.packing.cell import PackingCell, packing_cell
from pack_core.packing.scene import Scene
from pack_core.packing.scene_check import check_scene
from pack_core.text.reader import read_text


def load_scene(path: Path, cell: PackingCell | None = None) -> Scene:
    """Read a scene file with a pose for every object.

    Args:
        path: the file.
        cell: the cell that shall pack the scene; None: the cell as configured.

    Raises:
        ConfigError: a key, value or pose is missing or not allowed.
    """
    return parse_scene(read_text(path), str(path), cell)


def parse_scene(text: str, source: str, cell: PackingCell | None = None) -> Scene:
    """Read a scene file's text, as `load_scene` does; `source` names it in errors."""
    scene = Scene.from_yaml(text, source)
    check_scene(scene, cell or packing_cell(), source)
    return scene
