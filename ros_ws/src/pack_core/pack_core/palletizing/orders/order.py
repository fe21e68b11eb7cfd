"""An order: the boxes that arrive, and the place on the pallet that a packing algorithm gave each of them."""

from __future__ import annotations

import math
from functools import cached_property
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import Field, model_validator

from pack_core.config import Config
from pack_core.palletizing.orders.handling import BundlingAxis, Handling, OrientId, Turn, turn_of
from pack_core.palletizing.orders.placed_box import PlacedBox
from pack_core.text.limits import MOST_BOXES, ArticleName, Coordinate, Number

Length = Annotated[Number, Field(ge=0.001, le=10.0)]
EDGE_LIMITS = (0.01, 3.0)
"""Of a box: thinner is a sheet, larger no arm turns [m]."""
Edge = Annotated[Number, Field(ge=EDGE_LIMITS[0], le=EDGE_LIMITS[1])]
MASS_LIMITS = (0.001, 1000.0)
"""Of a box [kg]."""
Mass = Annotated[Number, Field(ge=MASS_LIMITS[0], le=MASS_LIMITS[1])]
MaxLoad = Annotated[Number, Field(ge=0.0, le=1e5)]
"""What may stand on a box [kg]; 0: nothing."""
MaxPressure = Annotated[Number, Field(gt=0.0, le=1e5)]
"""Largest pressure on a box's top [kPa]."""
Count = Annotated[int, Field(strict=True)]
Dims = tuple[Edge, Edge, Edge]


class Units(Config):
    """The units an order is written in."""

    length: Literal["m"]
    mass: Literal["kg"]


class OrderPallet(Config):
    """The pallet: its deck's length and width and how high it is over the floor [m]."""

    length: Length
    width: Length
    deck_height: Length
    type: str = ""
    frame: str = ""


class OrderBox(Config):
    """A box of an order."""

    id: ArticleName
    dims: Dims = Field(description="d_x >= d_y >= d_z as it arrives, d_z upright [m]")
    weight: Mass = Field(description="[kg]")
    orient_id: OrientId
    bundling_axis: BundlingAxis
    position: tuple[Coordinate, Coordinate, Coordinate] = Field(description="lower corner in P [m]")
    placed_dims: Dims | None = Field(None, description="extents on the pallet [m], as a check")
    handling: Handling | None = Field(None, description="what the turn takes, as a check")
    seq: Count | None = None
    article: str = ""
    product_group: str | None = None
    this_side_up: bool | None = None
    max_load: MaxLoad | None = Field(None, description="what may stand on it [kg]; left out: anything")
    max_pressure: MaxPressure | None = Field(None, description="largest pressure on its top [kPa]")
    max_square_pad: Length | None = Field(
        None, description="side of the largest centred pad that misses taller neighbours placed before it [m]"
    )

    @model_validator(mode="after")
    def _arrives_lying(self) -> OrderBox:
        d_x, d_y, d_z = self.dims
        if not d_x >= d_y >= d_z:
            raise ValueError(f"dims are {list(self.dims)}; allowed: d_x >= d_y >= d_z, the largest face down")
        return self

    @cached_property
    def turn(self) -> Turn:
        """The turn from the box's orientation on arrival to that on the pallet."""
        return turn_of(self.dims, self.bundling_axis, self.orient_id)

    @property
    def placed(self) -> PlacedBox:
        """The box at its place on the pallet."""
        limits = (math.inf if limit is None else limit for limit in (self.max_load, self.max_pressure))
        return PlacedBox(self.id, np.array(self.position), np.array(self.turn.extents), self.weight, *limits)


class Order(Config):
    """An order; the fields that are given as a check may be left out."""

    order_id: ArticleName
    pallet: OrderPallet
    boxes: Annotated[tuple[OrderBox, ...], Field(max_length=MOST_BOXES)]
    units: Units | None = None
    source: dict[str, Any] = Field(default_factory=dict, description="where the data come from")
    placement_planner: str = ""
    note: str = ""
    total_boxes: Count | None = Field(None, description="as a check")
    total_weight: Number | None = Field(None, description="[kg], as a check")
    stack_height: Number | None = Field(None, description="over the deck [m], as a check")

    @property
    def placed(self) -> tuple[PlacedBox, ...]:
        """The boxes at their places on the pallet, in the order's sequence."""
        return tuple(item.placed for item in self.boxes)

    def box(self, name: str) -> OrderBox:
        """The box called `name`."""
        return next(item for item in self.boxes if item.id == name)
