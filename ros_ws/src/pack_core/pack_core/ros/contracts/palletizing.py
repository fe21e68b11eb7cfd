"""The wiring table of the palletizing cell."""

from __future__ import annotations

from pack_interfaces.msg import BoxDetection, ExpectedBox
from pack_interfaces.srv import PlanLayout
from sensor_msgs.msg import CameraInfo, CompressedImage, Image

from pack_core.ros.contracts.contract import LATCHED, LATEST, STREAM, Contract, Kind, contracts_in
from pack_core.ros.contracts.shared import SHARED

# fmt: off
IMAGE = Contract(
    "/camera/image_raw", Image, ("pallet_sim",), ("vision",),
    "picture of the overhead camera, rgb8", qos=LATEST, rate="on demand")
CAMERA_INFO = Contract(
    "/camera/camera_info", CameraInfo, ("pallet_sim",), ("vision",),
    "intrinsics of the overhead camera", qos=LATCHED, rate="with each picture", recorded=True)
EXPECTED_BOX = Contract(
    "/expected_box", ExpectedBox, ("fsm",), ("vision", "recorder"),
    "the box that is to be found in pictures from its stamp on", qos=LATCHED, rate="each box", recorded=True)
BOX_DETECTION = Contract(
    "/box_detection", BoxDetection, ("vision",), ("fsm", "recorder"),
    "the expected box's pose, or why there is none", qos=STREAM, rate="each picture", recorded=True)
VISION_FRAME = Contract(
    "/vision/frame", CompressedImage, ("vision",), ("user",),
    "the whole picture, reduced", qos=LATEST, rate="each picture")
VISION_ROI = Contract(
    "/vision/roi", CompressedImage, ("vision",), ("user",),
    "the part of it that is looked at", qos=LATEST, rate="each picture")
VISION_MASK = Contract(
    "/vision/mask", CompressedImage, ("vision",), ("user",),
    "what counts as box", qos=LATEST, rate="each picture")
VISION_OVERLAY = Contract(
    "/vision/overlay", CompressedImage, ("vision",), ("recorder", "user"),
    "the part with what was found drawn into it", qos=LATEST, rate="each picture", recorded=True)
PLAN_LAYOUT = Contract(
    "/plan_layout", PlanLayout, ("fsm", "user"), ("layout",),
    "gaps between an order's boxes, a sequence, a side for each to come from", kind=Kind.SERVICE)
# fmt: on

CONTRACTS = (*SHARED, *contracts_in(globals()))
