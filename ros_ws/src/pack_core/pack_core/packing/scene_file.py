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
    return parse_scene(read_text(path), str(path), cell, path.parent)


def scene_text(path: Path) -> str:
    """A scene file's text as it can be sent: with the corners of meshes in the place of their files."""
    return Scene.from_yaml(read_text(path), str(path), path.parent).to_yaml()


def parse_scene(text: str, source: str, cell: PackingCell | None = None, folder: Path | None = None) -> Scene:
    """Read a scene file's text, as `load_scene` does.

    Args:
        text: the text.
        source: names it in errors.
        cell: the cell that shall pack the scene; None: the cell as configured.
        folder: where the mesh files are that the text names; None: it may name none.
    """
    scene = Scene.from_yaml(text, source, folder)
    check_scene(scene, cell or packing_cell(), source)
    return scene
