"""What tag perception says about the blocks on the table, and the text with the tag of every block."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated

import yaml
from pydantic import Field

from pack_core.blocks.planar import PlanarPose
from pack_core.blocks.problem import CUBE, CUBES, BlockSize, BlockSizes
from pack_core.blocks.topics import TAGS
from pack_core.config import Config, parse_config
from pack_core.text.limits import MOST_BLOCKS, BlockName

Edge = Annotated[float, Field(gt=0.0, le=1.0)]
"""Of a block [m]."""
TagNumber = Annotated[int, Field(ge=0, le=10_000)]


@dataclass(frozen=True)
class BlockSighting:
    """One picture's worth of blocks.

    Attributes:
        time: when the picture was taken [s].
        poses: X_WB of every block that was seen, by id; also of blocks that nobody knows, called "tag 7".
        missing: ids of blocks whose tag was not seen.
        doubled: ids of blocks whose tag was seen more than once; their pose is not told.
        unknown: numbers of tags that belong to no known block.
    """

    time: float
    poses: Mapping[str, PlanarPose]
    missing: tuple[str, ...] = ()
    doubled: tuple[str, ...] = ()
    unknown: tuple[int, ...] = ()

    @property
    def unplaced(self) -> tuple[str, ...]:
        """Tags of no known block that do not lie on top of a block: nobody knows what they are on."""
        return tuple(unknown_id(number) for number in self.unknown if unknown_id(number) not in self.poses)

    @property
    def is_complete(self) -> bool:
        """Every block was seen exactly once, and everything else that is there is known to be a block."""
        return not self.missing and not self.doubled and not self.unplaced

    @property
    def lacks(self) -> str:
        """What is not clear, in words; empty for a complete sighting."""
        lacks = {
            "not seen": self.missing, "seen more than once": self.doubled,
            "on top of no block": self.unplaced,
        }  # fmt: skip
        return "; ".join(f"{what}: {', '.join(names)}" for what, names in lacks.items() if names)


def unknown_id(number: int) -> str:
    """What a block with a tag of this number is called that nobody knows."""
    return f"tag {number}"


class _Tags(Config):
    tags: Annotated[dict[BlockName, TagNumber], Field(max_length=MOST_BLOCKS)]
    sizes: dict[BlockName, tuple[Edge, Edge, Edge]] = Field({}, max_length=MOST_BLOCKS)


def tags_text(tags: Mapping[str, int], sizes: BlockSizes = CUBES) -> str:
    """The text, from the number of every block's tag, and the sizes [m] of those that are not cubes."""
    own = {name: list(size) for name, size in sizes.items() if size != CUBE}
    return yaml.safe_dump({"tags": dict(tags), **({"sizes": own} if own else {})})


def parse_tags(text: str) -> tuple[dict[str, int], dict[str, BlockSize]]:
    """The number of every block's tag, and the sizes [m] of those that are not cubes, by id.

    Raises:
        ConfigError: the text is none of these.
    """
    read = parse_config(_Tags, text, TAGS)
    return dict(read.tags), {name: BlockSize(*edges) for name, edges in read.sizes.items()}
