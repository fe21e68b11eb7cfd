"""Layout plans to messages and back."""

from __future__ import annotations

from pack_interfaces.msg import LayoutBox
from pack_interfaces.srv import PlanLayout

from pack_core.errors import MessageError
from pack_core.palletizing.orders.layout_plan import Insertion, LayoutPlan, LayoutStatus, PlannedBox
from pack_core.palletizing.orders.placed_box import PlacedBox
from pack_core.ros.conversions import finite, from_vector, to_point, to_vector


def fill_layout(response: PlanLayout.Response, plan: LayoutPlan) -> None:
    """Put a plan into a response."""
    response.status, response.message = int(plan.status), plan.reason
    response.gap, response.virtual_margin = plan.gap, plan.virtual_margin
    response.boxes = [_to_box(item) for item in plan.boxes]


def from_layout(response: PlanLayout.Response) -> LayoutPlan:
    """The plan in a response.

    Raises:
        MessageError: it must not be used.
    """
    if response.status not in list(LayoutStatus):
        raise MessageError(f"status is {response.status}; allowed: {[s.value for s in LayoutStatus]}")
    boxes = tuple(_from_box(item) for item in response.boxes)
    return LayoutPlan(
        LayoutStatus(response.status), response.message, boxes, response.gap, response.virtual_margin
    )


def _to_box(item: PlannedBox) -> LayoutBox:
    return LayoutBox(
        id=item.placed.id, lower=to_point(item.placed.lower), size=to_vector(item.placed.size),
        mass=float(item.placed.mass), direction=item.insertion.direction,
        outward=to_vector(item.insertion.outward), corridor=float(item.insertion.corridor),
    )  # fmt: skip


def _from_box(item: LayoutBox) -> PlannedBox:
    size = from_vector(item.size, f"size of box '{item.id}'")
    outward = from_vector(item.outward, f"direction of box '{item.id}'")
    lower = finite([item.lower.x, item.lower.y, item.lower.z], f"place of box '{item.id}'")
    finite([item.mass, item.corridor], f"mass or corridor of box '{item.id}'")
    return PlannedBox(
        PlacedBox(item.id, lower, size, item.mass), Insertion(item.direction, outward, item.corridor)
    )
