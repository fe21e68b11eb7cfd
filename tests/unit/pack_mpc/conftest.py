"""A scene for the controller."""

from unit.packing_scene import joints, plant, scene, state  # noqa: F401
