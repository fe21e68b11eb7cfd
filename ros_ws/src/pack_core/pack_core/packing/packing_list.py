"""Lists of objects that fill a container: `config/packing_lists/*.yaml`, or drawn from a catalogue."""

from __future__ import annotations

from collections import Counter
from enum import Enum
from pathlib import Path
from typing import Annotated, Self

import numpy as np
import yaml
from pydantic import Field, model_validator

from pack_core.config import Config, load_config, parse_config
from pack_core.errors import ConfigError
from pack_core.packing.cell import PackingCell
from pack_core.packing.objects import ObjectModel
from pack_core.packing.scene import Container, Scene, name_fault
from pack_core.paths import config_path
from pack_core.pose_config import PoseConfig

CATALOGUE = ("packing_lists", "supermarket.yaml")
"""Objects of which lists are drawn where none is given: a file of config/."""
DRAWN = 8
"""Objects in a list that is drawn."""
ROUNDING = 0.998
"""A circle's polygon holds a disc of this share of its radius."""


class PackingOrder(Enum):
    """Which object of a list comes next."""

    LIST = "list"
    """As the list has them."""
    PLANNED = "planned"
    """As they fit best."""


class PackingList(Config):
    """Objects to be packed one after the other, with the keys of a scene file.

    Attributes:
        objects: shapes, sizes and masses; without poses, as each is handed over when it is due.
        container: what is filled; None: the cell's.
        order: whether the list's order binds.
    """

    objects: Annotated[list[ObjectModel], Field(min_length=1, max_length=40)]
    container: Container | None = None
    order: PackingOrder = PackingOrder.PLANNED

    @model_validator(mode="after")
    def _can_be_handed_over(self) -> Self:
        if posed := [item.name for item in self.objects if item.pose is not None]:
            raise ValueError(f"'pose' of {', '.join(posed)}; allowed: none, objects are handed over")
        if fault := name_fault([item.name for item in self.objects]):
            raise ValueError(fault)
        return self

    def start(self, cell: PackingCell) -> Scene:
        """The scene in which a job begins: an empty container, and the first object handed over."""
        given = cell.scene
        return Scene(
            container=self.container or given.container, friction=given.friction, objects=[],
            new_object=handed_over(self.objects[0], cell),
        )  # fmt: skip

    def to_yaml(self) -> str:
        """The text of a list file."""
        text: str = yaml.safe_dump(self.model_dump(mode="json", exclude_none=True), sort_keys=False)
        return text

    def check(self, cell: PackingCell, source: str) -> None:
        """Refuse objects that the arm cannot carry or the cup cannot grip.

        Raises:
            ConfigError: an object is too heavy, or its flat top narrower than the cup.
        """
        limit, width = cell.robot.arm.payload - cell.pump.mass, 2.0 * cell.pump.cup_radius
        for item in self.objects:
            if item.mass > limit:
                raise ConfigError(
                    f"{source}: mass of '{item.name}' is {item.mass} kg; allowed: up to {limit:.1f} kg, the "
                    "arm's payload less the pump"
                )
            if item.flat_top < ROUNDING * cell.pump.cup_radius:
                raise ConfigError(
                    f"{source}: the top of '{item.name}' is flat over {2e3 * item.flat_top:.0f} mm about its "
                    f"middle; allowed: from {1e3 * width:.0f} mm on, the width of the cup"
                )


def draw_list(seed: int, count: int, catalogue: PackingList) -> PackingList:
    """A random list: `count` objects of a catalogue, each drawn from all of them.

    The same seed gives the same list. An object that is drawn again has its number behind its name.
    """
    rng = np.random.default_rng([seed, count])
    drawn = [catalogue.objects[i] for i in rng.integers(len(catalogue.objects), size=count)]
    times: Counter[str] = Counter()
    objects = []
    for item in drawn:
        times[item.name] += 1
        number = times[item.name]
        name = item.name if number == 1 else f"{item.name}_{number}"
        objects.append(item.model_copy(update={"name": name}))
    return catalogue.model_copy(update={"objects": objects})


def supermarket_list(seed: int, cell: PackingCell | None = None) -> PackingList:
    """The list of `DRAWN` supermarket objects that a seed stands for; checked as `load_list` does."""
    return draw_list(seed, DRAWN, load_list(config_path(*CATALOGUE), cell))


def handed_over(item: ObjectModel, cell: PackingCell) -> ObjectModel:
    """The object where the cell hands it over, as announced."""
    return item.model_copy(update={"pose": PoseConfig.from_pose(cell.hand_over.pose_of(item))})


def load_list(path: Path, cell: PackingCell | None = None) -> PackingList:
    """Read a list file.

    Args:
        path: the file.
        cell: the cell that shall pack the list; None: one that checks it itself.

    Raises:
        ConfigError: a key or value is missing or not allowed.
    """
    found = load_config(PackingList, path)
    if cell is not None:
        found.check(cell, str(path))
    return found


def parse_list(text: str, source: str, cell: PackingCell | None = None) -> PackingList:
    """Read a list file's text, as `load_list` does; `source` names it in errors."""
    found = parse_config(PackingList, text, source)
    if cell is not None:
        found.check(cell, source)
    return found
