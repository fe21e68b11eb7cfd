"""The wiring table of the blocks cell."""

from __future__ import annotations

from pack_interfaces.action import Rearrange
from pack_interfaces.msg import BlockSighting, JawState, RearrangeStatus, SceneState
from pack_interfaces.srv import JawCommand, PlanRearrangement, ResetScene
from std_msgs.msg import String

from pack_core.blocks import topics
from pack_core.ros.contracts.contract import LATCHED, STREAM, Contract, Kind, contracts_in, hz
from pack_core.ros.contracts.motion import MOTION, overhead_camera
from pack_core.ros.contracts.shared import SHARED

# fmt: off
TAGS = Contract(
    topics.TAGS, String, ("sim",), ("tags", "recorder", "user"),
    "every block's tag and, unless it is a cube, size [m], by its id, as YAML", qos=LATCHED, rate="at reset",
    recorded=True)
JAW_STATE = Contract(
    topics.JAW_STATE, JawState, ("sim",), ("fsm", "recorder", "user"),
    "where the fingers are, how hard they press, whether they hold something",
    qos=STREAM, rate=hz(topics.JAW_RATE), recorded=True)
JAW_COMMAND = Contract(
    "/gripper/command", JawCommand, ("fsm", "user"), ("sim",),
    "an opening and a force; answers at once, the state tells how it went", kind=Kind.SERVICE)
TRIGGER, IMAGE, CAMERA_INFO = overhead_camera("tags")
BLOCK_POSES = Contract(
    topics.BLOCK_POSES, BlockSighting, ("tags",), ("fsm", "recorder", "user"),
    "poses of the blocks in a picture; those not seen, and those seen twice",
    qos=STREAM, rate="each picture", recorded=True)
PLAN_REARRANGEMENT = Contract(
    "/plan_rearrangement", PlanRearrangement, ("fsm", "user"), ("rearrangement",),
    "actions that bring every block to its goal, or why there are none", kind=Kind.SERVICE,
    recorded=True)
STATUS = Contract(
    topics.STATUS, RearrangeStatus, ("fsm",), ("recorder", "user"),
    "phase, plan and what was done so far", qos=STREAM, rate="on change", recorded=True)
RESULT = Contract(
    topics.RESULT, String, ("fsm",), ("recorder", "user"),
    "how the last goal ended, as JSON with the fields of the action's result and the goal's problem",
    qos=LATCHED, rate="each goal", recorded=True)
REARRANGE = Contract(
    "/rearrange", Rearrange, ("user",), ("fsm",), "bring every block to its goal", kind=Kind.ACTION)
TRUTH = Contract(
    topics.TRUTH, SceneState, ("sim",), ("recorder", "user"),
    "true poses and twists of the blocks; for whoever looks on, never for what controls",
    qos=STREAM, rate=hz(topics.TRUTH_RATE), recorded=True)
RESET = Contract(
    "/sim/reset", ResetScene, ("user",), ("sim",),
    "blocks where a problem file's text has them, arm at its look-out", kind=Kind.SERVICE)
# fmt: on

CONTRACTS = (*SHARED, *MOTION, *contracts_in(globals()))
