"""Sets of objects that scenes are drawn from: `config/object_sets/*.yaml`."""

from __future__ import annotations

from functools import cache
from typing import Annotated

import numpy as np
from pydantic import Field

from pack_core.config import Config, load_config
from pack_core.errors import PackError
from pack_core.packing.cell import DrawnObjects, PackingCell
from pack_core.packing.free_space import fitting_yaws, footprint
from pack_core.packing.objects import ObjectModel
from pack_core.packing.scene import Scene
from pack_core.paths import config_path
from pack_core.rotations import Pose
from pack_core.text.limits import MOST_OBJECTS

MOST_DRAWS = 1000
"""Draws after which no scene of the wanted area is expected any more."""


class ObjectSet(Config):
    """Objects to draw from, without poses."""

    objects: Annotated[list[ObjectModel], Field(min_length=2, max_length=100)]


@cache
def load_set(name: str) -> ObjectSet:
    """The set `config/object_sets/<name>.yaml`; raises ConfigError."""
    return load_config(ObjectSet, config_path("object_sets", f"{name}.yaml"))


def draw_new_object(drawn: DrawnObjects, cell: PackingCell, rng: np.random.Generator) -> ObjectModel:
    """One object of the set that can be packed, each as likely as the others.

    Raises:
        PackError: none can be packed.
    """
    packable = [item for item in load_set(drawn.object_set).objects if can_be_packed(item, cell)]
    if not packable:
        raise PackError(
            f"no object of config/object_sets/{drawn.object_set}.yaml can be packed: none fits, is as high "
            "as the walls less the pump's stem, and has a flat top as wide as the cup; change `drawn`"
        )
    return packable[rng.integers(len(packable))]


def draw_scene(drawn: DrawnObjects, cell: PackingCell, new: ObjectModel, rng: np.random.Generator) -> Scene:
    """A description with others beside the new object, drawn without repetition until they cover enough.

    Raises:
        PackError: the set has no objects that cover as much.
    """
    items = [item for item in load_set(drawn.object_set).objects if item.name != new.name]
    area = float(np.prod(cell.scene.container.size))
    shares = {item.name: footprint(item, Pose(np.zeros(3))).area / area for item in (*items, new)}
    least, most = drawn.base_area
    for _ in range(MOST_DRAWS):
        chosen: list[ObjectModel] = []
        covered = shares[new.name]
        for i in rng.permutation(len(items)):
            item = items[int(i)]
            if covered + shares[item.name] <= most and len(chosen) < MOST_OBJECTS:
                chosen.append(item)
                covered += shares[item.name]
            if least <= covered <= most:
                return cell.scene.model_copy(update={"objects": chosen, "new_object": new})
    raise PackError(
        f"no objects of config/object_sets/{drawn.object_set}.yaml cover {least} to {most} of the base "
        f"together with '{new.name}'; change `drawn` of the cell"
    )


def can_be_packed(item: ObjectModel, cell: PackingCell) -> bool:
    """Whether the pump carries an object by a flat top, and puts it down without diving below the rim."""
    container, pump = cell.scene.container, cell.pump
    try:
        fitting_yaws(item, container, 0.0)
    except PackError:
        return False
    is_high = 2.0 * float(item.half_extents[2]) + pump.stem_length >= container.height
    is_held = item.flat_top >= pump.cup_radius and item.mass <= cell.robot.arm.payload - pump.mass
    return is_high and is_held
