"""Replays of the palletizing cell: box vision and the layout planner."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import product
from typing import Any

import numpy as np

from pack_core.errors import BagError, PackError
from pack_core.motion.topics import CAMERA_INFO, IMAGE
from pack_core.palletizing.boxes import BoxDetection, ExpectedBox
from pack_core.palletizing.calibration import known_cell
from pack_core.palletizing.orders.layout_plan import LayoutPlan, LayoutStatus
from pack_core.palletizing.orders.order_file import parse_order
from pack_core.palletizing.topics import BOX_DETECTION, EXPECTED_BOX, LAYOUT_EVENTS
from pack_core.ros.messages.camera import from_camera_info, from_image
from pack_core.ros.messages.palletizing import from_detection, from_expected_box, from_layout
from pack_core.rotations import Array
from pack_evaluation.bag import Bag, fitting
from pack_lockstep.node_parameters import load_parameters
from pack_lockstep.palletizing.settings import checked_preset
from pack_lockstep.replay import (
    Replay,
    RunConditions,
    answered,
    calls_in,
    exact_row,
    farthest_mm,
    latest,
    pictures_in,
)
from pack_perception.boxes.box_vision import BoxVision, VisionConfig
from pack_perception.boxes.table_camera import TableCamera
from pack_planner.layout.layout_planner import LayoutConfig, LayoutPlanner

USUAL_PRESET = "rigid"
CORNERS: Array = np.array(list(product((-0.5, 0.5), repeat=3)))
"""Corners of a box in its own frame, in units of its edges `(8, 3)`."""


def replay_vision(bag: Bag, run: RunConditions) -> Replay:
    """Look for the expected box in every picture again, and compare with what was detected."""
    pictures, infos = pictures_in(bag), bag.of(CAMERA_INFO)
    preset = run.preset or USUAL_PRESET
    known = known_cell(preset, run.calibration)
    vision = BoxVision(load_parameters("palletizing/vision", VisionConfig, checked_preset(preset).vision))
    boxes = [from_expected_box(message) for message in bag.of(EXPECTED_BOX)]
    rows = []
    with fitting(bag.path):
        for time, message, picture in answered(bag, bag.of(BOX_DETECTION), pictures):
            recorded = from_detection(message)
            told = from_camera_info(latest(infos, time), known.cell.overhead_camera.X_WC)
            table = TableCamera(known.cell, vision, camera := known.camera(told))
            box = _expected(bag, boxes, recorded)
            again = table.detect(from_image(picture, camera), box, time).detection
            rows.append(exact_row(f"{box.id} at {time:.3f} s", detection_difference_mm(again, recorded, box)))
    return Replay("vision", {IMAGE: len(pictures), EXPECTED_BOX: len(boxes)}, tuple(rows))


def _expected(bag: Bag, boxes: Sequence[ExpectedBox], detection: BoxDetection) -> ExpectedBox:
    """The box that was looked for."""
    for box in reversed(boxes):
        if box.id == detection.box_id and box.time <= detection.time:
            return box
    raise BagError(f"{bag.path}: box '{detection.box_id}' was detected, but nobody expected it")


def detection_difference_mm(one: BoxDetection, other: BoxDetection, box: ExpectedBox) -> float:
    """The farthest that a corner of the box, or an edge's length, differs; inf for another status."""
    if (one.status, one.reason) != (other.status, other.reason):
        return float("inf")
    sizes = 1e3 * float(np.abs(np.subtract(one.size, other.size)).max())
    if one.X_WB is None or other.X_WB is None:
        return sizes
    corners = CORNERS * box.dims
    return max(sizes, farthest_mm(one.X_WB.apply(corners), other.X_WB.apply(corners)))


def replay_layout(bag: Bag, run: RunConditions) -> Replay:
    """Plan the layout of every order again, and compare with the one that was answered."""
    changes = checked_preset(run.preset or USUAL_PRESET).layout
    config = load_parameters("palletizing/layout", LayoutConfig, changes)
    calls = calls_in(bag, LAYOUT_EVENTS)
    with fitting(bag.path):
        rows = tuple(
            exact_row(
                f"layout {number}",
                layout_difference_mm(_plan_again(config, call.request), from_layout(call.answer)),
            )
            for number, call in enumerate(calls, start=1)
        )
    return Replay("layout", {LAYOUT_EVENTS: len(calls)}, rows)


def _plan_again(config: LayoutConfig, request: Any) -> LayoutPlan:
    try:
        order = parse_order(request.order, "the order of the request", config.support)
        return LayoutPlanner(config).plan(order, request.gap if request.gap >= 0.0 else None)
    except PackError as error:
        return LayoutPlan(LayoutStatus.INVALID_INPUT, str(error), (), 0.0, 0.0)


def layout_difference_mm(one: LayoutPlan, other: LayoutPlan) -> float:
    """The farthest that a corner of a box, or an end of a corridor, differs.

    It is inf for another status, reason, sequence of boxes, or side that one comes from.
    """
    if _words(one) != _words(other):
        return float("inf")
    return farthest_mm(_points(one), _points(other))


def _words(plan: LayoutPlan) -> tuple[Any, ...]:
    return plan.status, plan.reason, [(item.placed.id, item.insertion.direction) for item in plan.boxes]


def _points(plan: LayoutPlan) -> Array:
    """Two corners of every box in its place, and where its corridor begins `(3 n, 3)` in P [m]."""
    return np.array(
        [
            point
            for item in plan.boxes
            for point in (item.placed.lower, item.placed.upper, item.insertion.start(item.placed.lower))
        ]
    ).reshape(-1, 3)


REPLAYS = {"vision": replay_vision, "layout": replay_layout}
"""The nodes that can be replayed, by name."""
