"""Of a key that is not known the error says which ones there are, or which one may have been meant."""

from __future__ import annotations

from typing import Annotated, Literal

import pytest
from pydantic import Field

from pack_core.config import Config, parse_config
from pack_core.errors import ConfigError


class Ball(Config):
    kind: Literal["ball"]
    radius: float = 1.0


class Block(Config):
    kind: Literal["block"]
    edges: tuple[float, ...] = ()
    friction: float = 0.4


class Shelf(Config):
    items: tuple[Annotated[Ball | Block, Field(discriminator="kind")], ...] = ()
    height: float | None = None
    first: Block | None = None


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("hieght: 1.0", "'hieght' is not known; did you mean 'height'?"),
        ("colour: red", "'colour' is not known; allowed: items, height, first"),
        ("items: [{kind: ball, raduis: 1.0}]", "'items.0.ball.raduis' is not known; did you mean 'radius'?"),
        ("items: [{kind: ball, edge: 1.0}]", "'items.0.ball.edge' is not known; allowed: kind, radius"),
        ("first: {kind: block, frictoin: 1}", "'first.frictoin' is not known; did you mean 'friction'?"),
    ],
)
def test_what_may_have_been_meant_is_said(text: str, words: str) -> None:
    with pytest.raises(ConfigError) as caught:
        parse_config(Shelf, text, "shelf")
    assert words in str(caught.value)
