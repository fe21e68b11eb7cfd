"""Message definitions for bags: the standard ones, and those that the workspace installs."""

from __future__ import annotations

from pathlib import Path

from ament_index_python.packages import get_package_share_directory
from rosbags.typesys import Stores, get_types_from_msg, get_typestore
from rosbags.typesys.store import Typestore

INTERFACES = "pack_interfaces"


def message_types() -> Typestore:
    """All types that the cells' topics use, for whole schemas and type hashes."""
    types = get_typestore(Stores.ROS2_JAZZY)
    folder = Path(get_package_share_directory(INTERFACES), "msg")
    for path in sorted(folder.glob("*.msg")):
        types.register(get_types_from_msg(path.read_text(), f"{INTERFACES}/msg/{path.stem}"))
    return types
