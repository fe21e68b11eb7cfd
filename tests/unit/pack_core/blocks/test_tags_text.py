"""What is told of the blocks on the table: the numbers of their tags, and sizes that are not a cube's."""

import pytest

from pack_core.blocks.block_sighting import parse_tags, tags_text
from pack_core.blocks.problem import CUBE, BlockSize
from pack_core.errors import ConfigError

TAGS = {"a": 0, "b": 3}


def test_tags_and_sizes_are_read_back() -> None:
    sizes = {"a": BlockSize(0.04, 0.06, 0.045), "b": CUBE}
    assert parse_tags(tags_text(TAGS, sizes)) == (TAGS, {"a": sizes["a"]})
    assert parse_tags(tags_text(TAGS)) == (TAGS, {})


@pytest.mark.parametrize("edges", ["[0.04, 0.06]", "[0.04, 0.06, 0.0]", "[0.04, 0.06, 5]", "0.04"])
def test_edges_that_no_block_has_are_refused(edges: str) -> None:
    with pytest.raises(ConfigError, match=r"sizes\.a"):
        parse_tags(f"tags: {{a: 0}}\nsizes: {{a: {edges}}}")
