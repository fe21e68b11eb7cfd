"""What comes on the conveyor of a shift: boxes of a stream, turned, close together, some of them faulty."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from typing import Literal

import numpy as np
from pydantic import Field, NonNegativeFloat

from pack_core.config import Config
from pack_core.palletizing.boxes import BoxBody
from pack_core.palletizing.orders.item_list import Item
from pack_sim.palletizing.infeed import ArrivingBox

ARRIVALS = 11
"""Stream of random numbers of how boxes lie on the conveyor."""

BoxFault = Literal["", "no label", "wrong label", "double", "crushed", "oversize"]
FAULTS: tuple[BoxFault, ...] = ("no label", "wrong label", "double", "crushed", "oversize")
WRONG_BY = (0.015, 0.04)
"""By which crushed boxes, and those that are too large, differ from what their labels say [m]."""


class ArrivalConfig(Config):
    """How boxes come."""

    yaw_deg: NonNegativeFloat = Field(default=8.0, description="turned by at most, to either side [deg]")
    offset: NonNegativeFloat = Field(default=0.05, description="beside the belt's middle, at most [m]")
    gaps: tuple[NonNegativeFloat, NonNegativeFloat] = Field(
        default=(0.01, 0.3), description="from one box to the next, least and most [m]"
    )
    faulty: float = Field(
        default=0.02, ge=0, le=1, description="share of boxes without a label, with a wrong one, of which "
        "two stick together, that are crushed, or longer and wider than their label says"
    )  # fmt: skip


class Arrivals:
    """The boxes of a stream, as somebody lays them on the conveyor.

    Args:
        items: what wrong labels say.
        stream: boxes, each with the listed one that it is like.
        config: how they come.
        seed: of how they lie, and of what is wrong with some.
        without: boxes that are left out, as they have come already.

    Attributes:
        faults: what is wrong with boxes, by what they are tracked by; only those of which something is.
    """

    def __init__(
        self, items: Sequence[Item], stream: Iterable[tuple[Item, Item]], config: ArrivalConfig, seed: int,
        without: frozenset[str] = frozenset(),
    ) -> None:  # fmt: skip
        self._items, self._stream, self._config = items, stream, config
        self._seed, self._without = seed, without
        self.faults: dict[str, BoxFault] = {}

    def __iter__(self) -> Iterator[ArrivingBox]:
        """One box after the other, without end."""
        rng, config = np.random.default_rng([self._seed, ARRIVALS]), self._config
        for item, listed in self._stream:
            fault: BoxFault = FAULTS[rng.integers(len(FAULTS))] if rng.random() < config.faulty else ""
            other = self._items[int(rng.integers(len(self._items)))]
            if fault == "wrong label" and other.size == listed.size:
                fault = ""
            label = {"no label": "", "wrong label": other.id}.get(fault, listed.id)
            quarter = rng.integers(2) * np.pi / 2.0
            yaw = float(quarter + np.deg2rad(rng.uniform(-config.yaw_deg, config.yaw_deg)))
            offset, gap = float(rng.uniform(-config.offset, config.offset)), float(rng.uniform(*config.gaps))
            body = _body(item, fault, float(rng.uniform(*WRONG_BY)))
            if item.id in self._without:
                continue  # only now: those that follow are the same whether or not it is left out
            if fault:
                self.faults[item.id] = fault
            yield ArrivingBox(body, label, yaw, offset, gap)


def _body(item: Item, fault: BoxFault, wrong: float) -> BoxBody:
    """A box as it arrives: on its largest face; two that stick together lie side by side.

    One that is crushed is lower by `wrong` [m], or by less where it is low; one too large is larger by it.
    """
    d_x, d_y, d_z = sorted(item.size, reverse=True)
    mass = item.weight
    if fault == "double":
        d_x, d_y, mass = max(d_x, 2.0 * d_y), min(d_x, 2.0 * d_y), 2.0 * mass
    if fault == "crushed":
        d_z -= min(wrong, 0.3 * d_z)
    if fault == "oversize":
        d_x, d_y = d_x + wrong, d_y + wrong
    return BoxBody(item.id, (d_x, d_y, d_z), mass)
