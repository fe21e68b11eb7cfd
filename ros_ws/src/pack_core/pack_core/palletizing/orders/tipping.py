"""The closed tipping rule: which boxes tip when the pallet is accelerated, without any simulation.

Each box, together with all that it carries, is taken as one rigid body that stands on its support polygon.
Accelerated horizontally by a share g of gravity, it stays if its centre of mass, displaced by g times the
centre's height above the box's base, is still within that polygon, whatever the direction.
"""

from __future__ import annotations

from collections.abc import Sequence

from pydantic import Field

from pack_core.config import Config
from pack_core.palletizing.orders.placed_box import PlacedBox
from pack_core.palletizing.orders.stack import push_of, stack_of


class TippingConfig(Config):
    """The push that every box must withstand with all that it carries."""

    push: float = Field(
        0.25, ge=0, le=1,
        description="horizontal acceleration by the closed rule, as a share of gravity; more than the 0.2 of "
        "EUMOS 40509 that is tested, since neighbours push each other",
    )  # fmt: skip


def pushes_of(boxes: Sequence[PlacedBox]) -> dict[str, float]:
    """The push that each box withstands with all that it carries, by name, as a share of gravity."""
    stack, from_below = stack_of(boxes)
    return {box.id: float(push_of(stack, i, stack.loads[i])) for i, box in enumerate(from_below)}


def tipping_boxes(boxes: Sequence[PlacedBox], config: TippingConfig) -> dict[str, str]:
    """The names of the boxes that tip, and the reason for each."""
    return {
        name: f"with all that it carries it tips at {max(push, 0.0):.2f} g by the closed rule; wanted: "
        f"{config.push:g} g"
        for name, push in pushes_of(boxes).items()
        if push < config.push
    }
