"""The wiring table of the palletizing cell."""

from __future__ import annotations

from dataclasses import replace

from pack_interfaces.action import CalibrateCell, Palletize, RunShift
from pack_interfaces.msg import (
    BoardSighting,
    BoxDetection,
    ExpectedBox,
    GripperState,
    InfeedState,
    PalletPlaces,
    PalletState,
    SceneState,
    UnwantedContact,
)
from pack_interfaces.srv import (
    GripperCommand,
    LayOnTable,
    PlanLayout,
    PlanPlace,
    RemoveBox,
    ReplacePallet,
    ResetCell,
    SpawnBox,
)
from sensor_msgs.msg import CompressedImage, PointCloud2
from std_msgs.msg import String
from std_srvs.srv import Trigger

from pack_core.palletizing import topics
from pack_core.ros.contracts import motion
from pack_core.ros.contracts.contract import EVENTS, LATCHED, LATEST, STREAM, Contract, Kind, contracts_in, hz
from pack_core.ros.contracts.motion import overhead_camera
from pack_core.ros.contracts.shared import SHARED


def scanner(place: str, points: str, what: str, *, is_of_shifts: bool = False) -> tuple[Contract, Contract]:
    """How a scan of a place is asked for, and where its points come.

    Args:
        place: its name, as in `pack_core.palletizing.cell`.
        points: name of the topic of the points.
        what: the scanner hangs over, in words.
        is_of_shifts: whether only a cell for shifts has it.
    """
    where = "; only in a cell for shifts" if is_of_shifts else ""
    trigger = Contract(
        f"/{place}_scanner/trigger", Trigger, ("fsm", "user"), ("sim",),
        f"scan {what} now; the points follow, stamped with this moment{where}", kind=Kind.SERVICE,
    )  # fmt: skip
    scan = Contract(
        points, PointCloud2, ("sim",), ("fsm", "recorder", "user"),
        f"where the rays of the scanner over {what} met something, in the frame `{place}_scanner`",
        qos=LATEST, rate="on demand", recorded=True,
    )  # fmt: skip
    return trigger, scan


# fmt: off
JOINT_STATES = replace(motion.JOINT_STATES, targets=("motion", "fsm", "recorder", "user"))
BOXES = Contract(
    topics.BOXES, String, ("sim",), ("recorder", "user"),
    "name, size and mass of every box in the cell, as YAML", qos=LATCHED, rate="on change", recorded=True)
GRIPPER_STATE = Contract(
    topics.GRIPPER_STATE, GripperState, ("sim",), ("fsm", "recorder", "user"),
    "what the gripper holds and how hard it is loaded; still closing: neither closed nor with a reason",
    qos=STREAM, rate=hz(topics.GRIPPER_RATE), recorded=True)
TRUTH = Contract(
    topics.TRUTH, SceneState, ("sim",), ("recorder", "user"),
    "true poses and twists of the boxes; for whoever looks on, never for what controls",
    qos=STREAM, rate=hz(topics.TRUTH_RATE), recorded=True)
CONTACTS = Contract(
    topics.CONTACTS, UnwantedContact, ("sim",), ("recorder", "user"),
    "arm, tool or carried box touched something that they should not, with more than a set force",
    qos=STREAM, rate="each contact", recorded=True)
GRIPPER_COMMAND = Contract(
    "/gripper/command", GripperCommand, ("fsm", "user"), ("sim",),
    "close or open the gripper; answers at once, the state tells how it went", kind=Kind.SERVICE)
SPAWN_BOX = Contract(
    "/sim/spawn", SpawnBox, ("fsm", "user"), ("sim",), "a box arrives on the picking table",
    kind=Kind.SERVICE)
LAY_ON_TABLE = Contract(
    "/picking_table/lay", LayOnTable, ("fsm", "user"), ("sim",),
    "the operator lays something on the picking table by its marks: the calibration board, or a test box",
    kind=Kind.SERVICE)
REMOVE_BOX = Contract(
    "/sim/remove", RemoveBox, ("fsm", "user"), ("sim",), "a box is taken out of the cell", kind=Kind.SERVICE)
RESET = Contract(
    "/sim/reset", ResetCell, ("user",), ("sim",),
    "empty the cell, bring the arm home, and put boxes there that are asked for", kind=Kind.SERVICE)
TRIGGER, IMAGE, CAMERA_INFO = overhead_camera("vision")
EXPECTED_BOX = Contract(
    topics.EXPECTED_BOX, ExpectedBox, ("fsm",), ("vision", "recorder"),
    "the box that is to be found in pictures from its stamp on", qos=LATCHED, rate="each box", recorded=True)
BOX_DETECTION = Contract(
    topics.BOX_DETECTION, BoxDetection, ("vision",), ("fsm", "recorder", "user"),
    "the expected box's pose, or why there is none", qos=STREAM, rate="each picture", recorded=True)
BOARD_SIGHTING = Contract(
    topics.BOARD_SIGHTING, BoardSighting, ("vision",), ("fsm", "recorder", "user"),
    "corners of the calibration board in a picture, when it is what is expected", qos=STREAM,
    rate="each picture", recorded=True)
SCAN_PALLET, PALLET_SCAN = scanner("pallet", topics.PALLET_SCAN, "the pallet")
SCAN_TABLE, TABLE_SCAN = scanner("reorientation_table", topics.TABLE_SCAN, "table B")
SCAN_PICKING, PICKING_SCAN = scanner(
    "picking_table", topics.PICKING_SCAN, "the conveyor's barrier", is_of_shifts=True)
SCAN_SECOND, SECOND_SCAN = scanner(
    "second_pallet", topics.SECOND_SCAN, "the second pallet", is_of_shifts=True)
INFEED_STATE = Contract(
    topics.INFEED_STATE, InfeedState, ("sim",), ("fsm", "recorder", "user"),
    "the box at the conveyor's barrier and what its label says; only in a cell for shifts", qos=LATCHED,
    rate="on change", recorded=True)
SEND_BOX = Contract(
    "/infeed/send", Trigger, ("fsm", "user"), ("sim",),
    "have the conveyor bring the next box, once the one at the barrier is gone", kind=Kind.SERVICE)
PALLET_PLACES = Contract(
    topics.PALLET_PLACES, PalletPlaces, ("sim",), ("fsm", "recorder", "user"),
    "the places on which no pallet stands while a full one is replaced; only in a cell for shifts",
    qos=LATCHED, rate="on change", recorded=True)
REPLACE_PALLET = Contract(
    "/pallets/replace", ReplacePallet, ("fsm", "user"), ("sim",),
    "have a full pallet taken away, and an empty one brought", kind=Kind.SERVICE)
VISION_FRAME = Contract(
    "/vision/frame", CompressedImage, ("vision",), ("user",),
    "the whole picture, at lower resolution", qos=LATEST, rate="each picture")
VISION_ROI = Contract(
    "/vision/roi", CompressedImage, ("vision",), ("user",),
    "the part of the picture in which the box is searched", qos=LATEST, rate="each picture")
VISION_MASK = Contract(
    "/vision/mask", CompressedImage, ("vision",), ("user",),
    "the pixels of that part that are taken for the box", qos=LATEST, rate="each picture")
VISION_OVERLAY = Contract(
    topics.VISION_OVERLAY, CompressedImage, ("vision",), ("recorder", "user"),
    "that part with what was found drawn into it", qos=LATEST, rate="each picture", recorded=True)
PLAN_LAYOUT = Contract(
    "/plan_layout", PlanLayout, ("fsm", "user"), ("layout",),
    "where an order's boxes stand, with gaps, in which sequence they come, and from which side",
    kind=Kind.SERVICE, recorded=True)
PLAN_PLACE = Contract(
    "/plan_place", PlanPlace, ("fsm", "user"), ("layout",),
    "where a box goes that has just come, from what stands on the pallets; only in a cell for shifts",
    kind=Kind.SERVICE, recorded=True)
PALLET_STATE = Contract(
    topics.PALLET_STATE, PalletState, ("fsm",), ("recorder", "user"),
    "the machine entered a state: which, for which box, on what event, and why if it is a fault",
    qos=EVENTS, rate="each state", recorded=True)
RESULT = Contract(
    topics.RESULT, String, ("fsm",), ("recorder", "user"),
    "what became of the last order and of each of its boxes, as JSON", qos=LATCHED,
    rate="each order", recorded=True)
PALLETIZE = Contract(
    "/palletize", Palletize, ("user",), ("fsm",), "build an order's pallet", kind=Kind.ACTION)
RUN_SHIFT = Contract(
    "/run_shift", RunShift, ("user",), ("fsm",),
    "run a shift, or go on with one; only in a cell for shifts", kind=Kind.ACTION)
CALIBRATE = Contract(
    "/calibrate_cell", CalibrateCell, ("user",), ("fsm",),
    "find out where tables, pallet and camera are and how far the gears give, or test what was found",
    kind=Kind.ACTION)
# fmt: on
SCANS = {
    "pallet": (SCAN_PALLET, PALLET_SCAN),
    "reorientation_table": (SCAN_TABLE, TABLE_SCAN),
    "picking_table": (SCAN_PICKING, PICKING_SCAN),
    "second_pallet": (SCAN_SECOND, SECOND_SCAN),
}
"""By the name of a place, how a scan of it is asked for, and where its points come. The names are those of
`pack_core.palletizing.cell`, which takes long to import."""

MOTION = (line for line in motion.MOTION if line.name != JOINT_STATES.name)
CONTRACTS = (*SHARED, *MOTION, *contracts_in(globals()))
