"""Streams of boxes in a sequence that nobody knows, drawn from lists of items."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path

import numpy as np

from pack_core.palletizing.orders.item_list import Item, load_items
from pack_core.paths import config_path


def shipped_lists() -> list[Path]:
    """The lists of config/item_lists."""
    return sorted(config_path("item_lists").glob("*.csv"))


def listed_items(files: Iterable[Path]) -> tuple[Item, ...]:
    """The items of lists in millimetres; their ids tell the lists apart, and are what labels say."""
    return tuple(
        item.model_copy(update={"id": f"{path.stem}-{item.id}"})
        for path in files
        for item in load_items(path, "mm")
    )


def box_stream(
    items: Sequence[Item], seed: int, max_pressure: float | None = None, fragile: float = 0.0
) -> Iterator[tuple[Item, Item]]:
    """Boxes without end, drawn evenly with replacement, each with the listed one that it is like.

    Args:
        items: from which boxes are drawn.
        seed: of the stream.
        max_pressure: on any box's top [kPa]; None: as listed.
        fragile: share of boxes on which nothing may stand.
    """
    rng, number = np.random.default_rng(seed), 0
    while True:
        number += 1
        listed = items[int(rng.integers(len(items)))]
        limits = {
            "max_load": 0.0 if rng.random() < fragile else listed.max_load,
            "max_pressure": listed.max_pressure if max_pressure is None else max_pressure,
        }
        yield listed.model_copy(update={"id": f"{number}-{listed.article}"[:64], **limits}), listed
