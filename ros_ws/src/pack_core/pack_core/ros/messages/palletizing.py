"""Messages of the palletizing cell to values and back: of what is seen, held, planned, and of shifts."""

from __future__ import annotations

import math
from collections.abc import Collection
from typing import Any

import numpy as np
from pack_interfaces.msg import BoardSighting as BoardSightingMsg
from pack_interfaces.msg import BoxDetection as BoxDetectionMsg
from pack_interfaces.msg import ExpectedBox as ExpectedBoxMsg
from pack_interfaces.msg import (
    GripperState,
    LayoutBox,
    ListedItem,
    PalletPlaces,
    SimulatedBox,
    StandingBox,
)
from pack_interfaces.msg import InfeedState as InfeedStateMsg
from pack_interfaces.msg import StandingPallet as StandingPalletMsg
from pack_interfaces.srv import PlanLayout, PlanPlace
from pydantic import TypeAdapter, ValidationError
from sensor_msgs.msg import PointCloud2

from pack_core.config import validate_config
from pack_core.errors import MessageError
from pack_core.palletizing.boxes import BoxBody, BoxDetection, DetectionStatus, ExpectedBox
from pack_core.palletizing.calibration_board import CALIBRATION_BOARD, BoardSighting
from pack_core.palletizing.grip import GripLoad, GripState
from pack_core.palletizing.infeed import InfeedState, PlacesAway
from pack_core.palletizing.orders.item_list import Item
from pack_core.palletizing.orders.layout_plan import Insertion, LayoutPlan, LayoutStatus, PlannedBox
from pack_core.palletizing.orders.next_place import NextStep, PlaceAnswer, PlaceQuestion, StandingPallet
from pack_core.palletizing.orders.placed_box import PlacedBox
from pack_core.palletizing.scanner import PlaceScan, scanner_frame
from pack_core.ros.messages.conversions import (
    WORLD,
    finite,
    from_pose,
    from_stamp,
    from_vector,
    to_point,
    to_pose,
    to_stamp,
    to_vector,
)
from pack_core.ros.messages.point_cloud import POINT_FIELDS, POINT_STEP, to_point_cloud
from pack_core.rotations import Pose
from pack_core.text.limits import ARTICLE_NAMES, MOST_CHARACTERS_OF_NAME, ArticleName
from pack_core.text.shown import shown_value

NEAREST_POINT = 0.1
"""No scanner measures what is nearer than this [m]."""
MOST_POINTS = 100_000
"""Points of a scan at most: comparing more would hold the machine up."""


def to_expected_box(box: ExpectedBox) -> ExpectedBoxMsg:
    """A message of the expected box."""
    message = ExpectedBoxMsg(id=box.id, size=to_vector(box.dims))
    message.header.stamp = to_stamp(box.time)
    return message


def from_expected_box(message: ExpectedBoxMsg) -> ExpectedBox:
    """The expected box in a message; MessageError where its size must not be used."""
    d_x, d_y, d_z = from_vector(message.size, f"size of box '{message.id}'").tolist()
    if not d_x >= d_y >= d_z > 0.0:
        raise MessageError(f"size of box '{message.id}' is {[d_x, d_y, d_z]}; allowed: d_x >= d_y >= d_z > 0")
    return ExpectedBox(message.id, (d_x, d_y, d_z), from_stamp(message.header.stamp))


def to_detection(detection: BoxDetection) -> BoxDetectionMsg:
    """A message of what was detected, or of why nothing was."""
    message = BoxDetectionMsg(
        box_id=detection.box_id, status=int(detection.status), reason=detection.reason, size=detection.size
    )
    message.header.stamp, message.header.frame_id = to_stamp(detection.time), WORLD
    if detection.X_WB is not None and detection.X_WT is not None:
        message.pose, message.grasp = to_pose(detection.X_WB), to_pose(detection.X_WT)
    return message


def from_detection(message: BoxDetectionMsg) -> BoxDetection:
    """What a message says of a picture; MessageError where a value must not be used."""
    if message.status not in list(DetectionStatus):
        raise MessageError(f"status is {message.status}; allowed: {[s.value for s in DetectionStatus]}")
    status = DetectionStatus(message.status)
    is_detected = status is DetectionStatus.DETECTED
    length, width = finite(message.size, f"size of box '{message.box_id}'").tolist()
    return BoxDetection(
        from_stamp(message.header.stamp), message.box_id, status, message.reason,
        from_pose(message.pose) if is_detected else None, from_pose(message.grasp) if is_detected else None,
        (length, width),
    )  # fmt: skip


def to_gripper_state(time: float, state: GripState) -> GripperState:
    """A message of a gripper's state at `time` [s].

    While it is still closing, `is_closed` is false and the reason empty.
    """
    message = GripperState(
        is_closed=state.is_closed, object=state.held, coaxial_force=state.load.coaxial,
        shear_force=state.load.shear, moment=state.load.moment, release_reason=state.reason,
    )  # fmt: skip
    message.header.stamp = to_stamp(time)
    return message


def from_gripper_state(message: GripperState) -> GripState:
    """The gripper's state in a message, which does not hold the peak load: the load stands for it.

    Raises:
        MessageError: a load is not finite.
    """
    values = finite([message.coaxial_force, message.shear_force, message.moment], "gripper state: load")
    load = GripLoad(*(float(value) for value in values))
    is_closing = not message.is_closed and not message.release_reason
    return GripState(message.object, is_closing, load, load, message.release_reason)


def fill_layout(response: PlanLayout.Response, plan: LayoutPlan) -> None:
    """Put a plan into a response."""
    response.status, response.message = int(plan.status), plan.reason
    response.gap, response.virtual_margin = plan.gap, plan.virtual_margin
    response.boxes = [to_planned_box(item) for item in plan.boxes]


def from_layout(response: PlanLayout.Response) -> LayoutPlan:
    """The plan in a response.

    Raises:
        MessageError: it must not be used.
    """
    if response.status not in list(LayoutStatus):
        raise MessageError(f"status is {response.status}; allowed: {[s.value for s in LayoutStatus]}")
    boxes = tuple(from_planned_box(item) for item in response.boxes)
    return LayoutPlan(
        LayoutStatus(response.status), response.message, boxes, response.gap, response.virtual_margin
    )


def to_planned_box(item: PlannedBox) -> LayoutBox:
    """A message of a box's place and its way in."""
    return LayoutBox(
        id=item.placed.id, lower=to_point(item.placed.lower), size=to_vector(item.placed.size),
        mass=float(item.placed.mass), direction=item.insertion.direction,
        outward=to_vector(item.insertion.outward), corridor=float(item.insertion.corridor),
    )  # fmt: skip


def from_planned_box(item: LayoutBox) -> PlannedBox:
    """A box's place and its way in, of a message; MessageError where a value must not be used."""
    size = from_vector(item.size, f"size of box '{item.id}'")
    outward = from_vector(item.outward, f"direction of box '{item.id}'")
    lower = finite([item.lower.x, item.lower.y, item.lower.z], f"place of box '{item.id}'")
    finite([item.mass, item.corridor], f"mass or corridor of box '{item.id}'")
    return PlannedBox(
        PlacedBox(item.id, lower, size, item.mass), Insertion(item.direction, outward, item.corridor)
    )


def to_cloud(scan: PlaceScan) -> PointCloud2:
    """A message of a scan: its points in the frame of the scanner, in no particular order."""
    return to_point_cloud(scan.time, scan.points, scanner_frame(scan.place))


def from_cloud(message: PointCloud2, place: str) -> PlaceScan:
    """The scan of a place in a message.

    Raises:
        MessageError: it is of another scanner, has other fields, or a point that no scanner can measure.
    """
    frame, n = message.header.frame_id, message.width * message.height
    if frame != scanner_frame(place):
        raise MessageError(f"points in the frame '{frame}'; allowed: {scanner_frame(place)}")
    is_packed = list(message.fields) == list(POINT_FIELDS) and not message.is_bigendian
    if not is_packed or len(message.data) != POINT_STEP * n or not 0 < n <= MOST_POINTS:
        raise MessageError(
            f"{n} points in {len(message.data)} bytes with {len(message.fields)} fields; allowed: 1 to "
            f"{MOST_POINTS} points, x, y, z as little-endian floats, without padding"
        )
    points = finite(np.frombuffer(message.data, dtype="<f4").reshape(n, 3), "a scan's points")
    if np.any(np.linalg.norm(points, axis=1) < NEAREST_POINT):
        raise MessageError(f"a point nearer to the scanner than {NEAREST_POINT} m")
    return PlaceScan(from_stamp(message.header.stamp), place, points)


def to_sighting(sighting: BoardSighting) -> BoardSightingMsg:
    """A message of a sighting."""
    u, v = sighting.pixels.T.tolist()
    message = BoardSightingMsg(width=sighting.width, ids=sighting.ids.tolist(), u=u, v=v)
    message.header.stamp = to_stamp(sighting.time)
    return message


def from_sighting(message: BoardSightingMsg) -> BoardSighting:
    """The sighting in a message; MessageError where it must not be used."""
    ids, most = np.array(message.ids, dtype=int), len(CALIBRATION_BOARD.corners())
    pixels = [finite(values, f"corners, {name}") for name, values in (("u", message.u), ("v", message.v))]
    if not message.width or any(len(values) != len(ids) for values in pixels) or np.any(ids >= most):
        raise MessageError(
            f"{len(ids)} corners with {len(pixels[0])} u and {len(pixels[1])} v in a picture of width "
            f"{message.width}; allowed: as many of each, and numbers below {most}"
        )
    return BoardSighting(from_stamp(message.header.stamp), message.width, ids, np.column_stack(pixels))


STEPS = {
    NextStep.PLACE: PlanPlace.Response.PLACE,
    NextStep.SET_ASIDE: PlanPlace.Response.SET_ASIDE,
    NextStep.REJECT: PlanPlace.Response.REJECT,
    NextStep.CLOSE: PlanPlace.Response.CLOSE,
}
"""What is done next, as the message has it."""


def to_infeed(state: InfeedState) -> InfeedStateMsg:
    """A message of what the conveyor tells."""
    message = InfeedStateMsg(number=state.number, box=state.box, label=state.label)
    message.header.stamp = to_stamp(state.time)
    return message


_NAMES = TypeAdapter(ArticleName)
"""Checks names by which boxes are tracked."""


def from_infeed(message: InfeedStateMsg) -> InfeedState:
    """What the conveyor tells in a message; MessageError where a box has a name that none may have."""
    if message.box:
        try:
            _NAMES.validate_python(message.box)
        except ValidationError as error:
            allowed = f"up to {MOST_CHARACTERS_OF_NAME} of {ARTICLE_NAMES}"
            raise MessageError(f"box is {shown_value(message.box)}; allowed: {allowed}") from error
    return InfeedState(from_stamp(message.header.stamp), message.number, message.box, message.label)


def to_places(away: PlacesAway) -> PalletPlaces:
    """A message of the places on which no pallet stands."""
    message = PalletPlaces(away=sorted(away.places))
    message.header.stamp = to_stamp(away.time)
    return message


def from_places(message: PalletPlaces) -> PlacesAway:
    """The places on which no pallet stands, in a message."""
    return PlacesAway(from_stamp(message.header.stamp), frozenset(message.away))


def to_simulated(box: BoxBody, X_WB: Pose) -> SimulatedBox:
    """A message of a box that stands at X_WB."""
    return SimulatedBox(name=box.name, size=list(box.size), mass=box.mass, pose=to_pose(X_WB))


def from_simulated(message: SimulatedBox) -> tuple[BoxBody, Pose]:
    """A box in a message, and X_WB; MessageError where it cannot be."""
    x, y, z = finite(message.size, f"size of box '{message.name}'").tolist()
    return BoxBody(message.name, (x, y, z), message.mass), from_pose(message.pose)


def to_question(question: PlaceQuestion) -> PlanPlace.Request:
    """A request that asks where boxes go."""
    return PlanPlace.Request(
        pallets=[
            StandingPalletMsg(
                place=pallet.place, boxes=[_to_standing(box) for box in pallet.boxes], missed=pallet.missed
            )
            for pallet in question.pallets
        ],
        buffered=[_to_item(item) for item in question.buffered],
        known=[_to_item(item) for item in question.known],
        room=question.room,
    )


def from_question(request: PlanPlace.Request, number: int, places: Collection[str]) -> PlaceQuestion:
    """The question in a request.

    Args:
        request: the message.
        number: which the question is given.
        places: names of the cell's places for pallets.

    Raises:
        PackError: a pallet, a box or an item cannot be.
    """
    if unknown := [pallet.place for pallet in request.pallets if pallet.place not in places]:
        raise MessageError(f"place is '{unknown[0]}'; allowed: {', '.join(places)}")
    pallets = (
        StandingPallet(pallet.place, tuple(_from_standing(box) for box in pallet.boxes), pallet.missed)
        for pallet in request.pallets
    )
    buffered, known = (
        tuple(_from_item(item) for item in items) for items in (request.buffered, request.known)
    )
    return PlaceQuestion(number, tuple(pallets), buffered, known, request.room)


def fill_answer(response: PlanPlace.Response, answer: PlaceAnswer) -> None:
    """Put an answer into a response."""
    response.success, response.step, response.reason = True, STEPS[answer.step], answer.reason
    response.item, response.pallet = answer.item, answer.pallet
    if answer.plan is not None:
        response.plan = to_planned_box(answer.plan)


def from_answer(response: PlanPlace.Response, number: int) -> PlaceAnswer:
    """The answer to the question of this number; MessageError where it must not be used."""
    steps = {value: step for step, value in STEPS.items()}
    if response.step not in steps:
        raise MessageError(f"step is {response.step}; allowed: {sorted(steps)}")
    step = steps[response.step]
    plan = from_planned_box(response.plan) if step is NextStep.PLACE else None
    return PlaceAnswer(number, step, response.reason, response.item, response.pallet, plan)


def _to_standing(box: PlacedBox) -> StandingBox:
    return StandingBox(
        id=box.id, lower=to_point(box.lower), size=to_vector(box.size), mass=float(box.mass),
        max_load=box.max_load, max_pressure=box.max_pressure,
    )  # fmt: skip


def _from_standing(message: StandingBox) -> PlacedBox:
    what = f"of box '{message.id}'"
    lower = finite([message.lower.x, message.lower.y, message.lower.z], f"place {what}")
    size = from_vector(message.size, f"size {what}")
    finite([message.mass], f"mass {what}")
    if not (size > 0.0).all() or not message.mass > 0.0:
        raise MessageError(f"size {what} is {size.tolist()} m, mass {message.mass} kg; allowed: above 0")
    limits = {name: _limit(getattr(message, name), f"{name} {what}") for name in ("max_load", "max_pressure")}
    return PlacedBox(message.id, lower, size, message.mass, **limits)


def _limit(value: float, what: str) -> float:
    """A limit that may be infinite."""
    if math.isnan(value) or value < 0.0:
        raise MessageError(f"{what} is {value}; allowed: 0 or more, infinite for none")
    return value


def _to_item(item: Item) -> ListedItem:
    return ListedItem(
        id=item.id, article=item.article, size=list(item.size), mass=item.weight,
        this_side_up=item.this_side_up,
        max_load=math.inf if item.max_load is None else item.max_load,
        max_pressure=math.inf if item.max_pressure is None else item.max_pressure,
    )  # fmt: skip


def _from_item(message: ListedItem) -> Item:
    values: dict[str, Any] = {
        "id": message.id, "article": message.article, "size": tuple(message.size.tolist()),
        "weight": message.mass, "this_side_up": message.this_side_up,
    }  # fmt: skip
    for name in ("max_load", "max_pressure"):
        limit = _limit(getattr(message, name), f"{name} of box '{message.id}'")
        values[name] = None if math.isinf(limit) else limit
    return validate_config(Item, values, f"item '{message.id}' of the request")
