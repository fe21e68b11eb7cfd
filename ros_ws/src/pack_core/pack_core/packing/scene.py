"""A scene: the container, what stands in it, and the new object that is to be packed."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Annotated

import numpy as np
import yaml
from pydantic import Field, model_validator

from pack_core.config import Config, parse_config
from pack_core.errors import ConfigError
from pack_core.packing.objects import ObjectModel
from pack_core.packing.scene_item import Friction, SceneItem
from pack_core.pose_config import PoseConfig
from pack_core.robots.packing_arms import PACKING_ARMS
from pack_core.rotations import Array, Pose
from pack_core.text.limits import MOST_OBJECTS, Coordinate, Number

# names of bodies that the cell's own model uses, and how names of its other parts begin
RESERVED = {"world", "table", "tool", "tip"}
RESERVED_PREFIXES = ("wall_", "pump_", "tip_", *(f"{name}_" for name in PACKING_ARMS))


class Container(Config):
    """An open box with its base on the table (z = 0), edges along the world axes."""

    centre: tuple[Coordinate, Coordinate] = (0.5, 0.0)
    size: tuple[Annotated[Number, Field(gt=0.05, lt=0.8)], Annotated[Number, Field(gt=0.05, lt=0.8)]]
    height: Annotated[Number, Field(gt=0.02, lt=0.5)]
    wall: Annotated[Number, Field(gt=0.001, lt=0.05)] = 0.008

    @property
    def lower(self) -> Array:
        """Inner corner `(2,)` with the smallest x and y [m]."""
        return np.array(self.centre) - 0.5 * np.array(self.size)

    @property
    def upper(self) -> Array:
        """Inner corner `(2,)` with the largest x and y [m]."""
        return np.array(self.centre) + 0.5 * np.array(self.size)


def name_fault(names: Sequence[str]) -> str:
    """Why objects cannot have these names in a cell; empty if they can."""
    if doubled := sorted({name for name in names if names.count(name) > 1}):
        return f"objects share a name: {', '.join(doubled)}; allowed: every object its own"
    if taken := sorted(name for name in names if name in RESERVED or name.startswith(RESERVED_PREFIXES)):
        return f"names that the cell itself uses: {', '.join(taken)}; allowed: others"
    return ""


class Scene(Config):
    """The content of a scene file. Without poses of its objects it is a description of the cell."""

    container: Container
    friction: Friction
    objects: Annotated[list[ObjectModel], Field(max_length=MOST_OBJECTS)]
    new_object: ObjectModel
    """The object that is packed next: it hangs from the pump, or stands at its `pose` to be picked up."""
    grip: PoseConfig | None = None
    """X_TN: how the new object N hangs from the cup T; None: upright, by the middle of its top."""

    @model_validator(mode="after")
    def _names_differ(self) -> Scene:
        names = [item.name for item in (*self.objects, self.new_object)]
        if fault := name_fault(names):
            raise ValueError(fault)
        return self

    @property
    def is_handed_over(self) -> bool:
        """Whether the new object stands at a pose of its own, for the arm to pick it up."""
        return self.new_object.pose is not None

    @property
    def names(self) -> list[str]:
        """Names of the objects in the container, in the file's order."""
        return [item.name for item in self.objects]

    @property
    def rim(self) -> float:
        """Height of the walls or of the tallest object, whichever is higher [m]; above it the way is free."""
        return max((self.container.height, *(2.0 * float(item.half_extents[2]) for item in self.objects)))

    def model_of(self, name: str) -> SceneItem:
        """The object called `name`.

        Raises:
            ConfigError: there is none.
        """
        for item in (*self.objects, self.new_object):
            if item.name == name:
                return item
        raise ConfigError(f"no object '{name}' in the scene; it has {[*self.names, self.new_object.name]}")

    def poses(self) -> dict[str, Pose]:
        """X_WO of every object in the container.

        Raises:
            ConfigError: the scene is a description, without poses.
        """
        missing = [item.name for item in self.objects if item.pose is None]
        if missing:
            raise ConfigError(
                f"key 'pose' is missing in {', '.join(missing)}; give `pose: position: [x, y, z]`"
            )
        return {item.name: item.pose.to_pose() for item in self.objects if item.pose}

    def with_poses(self, poses: dict[str, Pose]) -> Scene:
        """The same scene with its objects at the poses X_WO."""
        moved = [
            item.model_copy(update={"pose": PoseConfig.from_pose(poses[item.name])}) for item in self.objects
        ]
        return self.model_copy(update={"objects": moved})

    def gripped(self, X_TN: Pose) -> Scene:
        """The same scene with the new object hanging from the cup at X_TN."""
        held = self.new_object.model_copy(update={"pose": None})
        return self.model_copy(update={"new_object": held, "grip": PoseConfig.from_pose(X_TN)})

    def with_next(self, item: SceneItem, *, keep: bool) -> Scene:
        """The scene in which another object is the new one; `keep`: the old one stays in the container."""
        objects = [*self.objects, self.new_object] if keep else self.objects
        return self.model_copy(update={"objects": objects, "new_object": item, "grip": None})

    def description(self) -> Scene:
        """The scene without poses, as every node may know it: shapes, sizes and masses alone."""
        bare = [item.model_copy(update={"pose": None}) for item in self.objects]
        return self.model_copy(update={"objects": bare})

    def to_yaml(self) -> str:
        """The scene file's text."""
        return yaml.safe_dump(self.model_dump(mode="json", exclude_none=True), sort_keys=False)

    @classmethod
    def from_yaml(cls, text: str, source: str = "scene", folder: Path | None = None) -> Scene:
        """Read a scene file's text; `source` names it in errors, `folder` has the meshes that it names."""
        return parse_config(cls, text, source, folder)
