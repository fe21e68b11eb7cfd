"""The text that says which tag is glued to which block, as one latched message brings it."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated

import yaml
from pydantic import Field

from pack_core.blocks.topics import TAGS
from pack_core.config import Config, parse_config
from pack_core.text.limits import MOST_BLOCKS, BlockName

TagNumber = Annotated[int, Field(ge=0, le=10_000)]


class _Tags(Config):
    tags: Annotated[dict[BlockName, TagNumber], Field(max_length=MOST_BLOCKS)]


def tags_text(tags: Mapping[str, int]) -> str:
    """The text, from the number of every block's tag."""
    return yaml.safe_dump({"tags": dict(tags)})


def parse_tags(text: str) -> dict[str, int]:
    """The number of every block's tag, by the block's id; raises ConfigError."""
    return dict(parse_config(_Tags, text, TAGS).tags)
