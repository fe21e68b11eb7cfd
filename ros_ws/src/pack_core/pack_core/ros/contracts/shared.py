"""What every cell has on its wires."""

from __future__ import annotations

from diagnostic_msgs.msg import DiagnosticArray
from pack_interfaces.msg import ArmState, NodeStatus
from pack_interfaces.srv import StopArm
from rosgraph_msgs.msg import Clock
from std_msgs.msg import Float64, String
from std_srvs.srv import Trigger
from tf2_msgs.msg import TFMessage
from visualization_msgs.msg import MarkerArray

from pack_core import topics
from pack_core.ros.contracts.contract import (
    EVENTS,
    LATCHED,
    LATEST,
    STREAM,
    Contract,
    Kind,
    contracts_in,
    hz,
)
from pack_core.ros.simulation_types import GetSimulationState, SetSimulationState, SimulationState

# fmt: off
CLOCK = Contract(
    topics.CLOCK, Clock, ("sim",), ("all",), "simulated time", qos=LATEST,
    rate=hz(topics.CLOCK_RATE), recorded=True)
REAL_TIME_FACTOR = Contract(
    topics.REAL_TIME_FACTOR, Float64, ("sim",), ("recorder", "user"),
    "simulated seconds per second of wall clock, as achieved", qos=STREAM,
    rate="1 Hz of wall clock", recorded=True)
DIAGNOSTICS = Contract(
    topics.DIAGNOSTICS, DiagnosticArray, ("all",), ("recorder", "user"),
    "health of every node: counts of refused messages, silent peers", qos=EVENTS,
    rate="1 Hz of wall clock", recorded=True)
SIMULATION_STATE = Contract(
    topics.SIMULATION_STATE, SimulationState, ("sim",), ("recorder", "user"),
    "whether simulated time runs or is paused", qos=LATCHED, rate="on change", recorded=True)
SET_SIMULATION_STATE = Contract(
    "/set_simulation_state", SetSimulationState, ("user",), ("sim",),
    "pause, or go on; as simulation_interfaces has it", kind=Kind.SERVICE)
GET_SIMULATION_STATE = Contract(
    "/get_simulation_state", GetSimulationState, ("user",), ("sim",),
    "whether simulated time runs; as simulation_interfaces has it", kind=Kind.SERVICE)
ARM_STATE = Contract(
    topics.ARM_STATE, ArmState, ("sim",), ("all", "user"),
    "whether the arm was stopped, why, and whether it stands", qos=LATCHED, rate="on change", recorded=True)
STOP_ARM = Contract(
    "/arm/stop", StopArm, ("user",), ("sim",),
    "brake the arm at once and hold it; setpoints are refused and goals end", kind=Kind.SERVICE)
RESUME_ARM = Contract(
    "/arm/resume", Trigger, ("user", "all"), ("sim",),
    "follow setpoints again after a stop; the next goal and a reset do it, too", kind=Kind.SERVICE)
NODE_STATUS = Contract(
    "/node_status", NodeStatus, ("all",), ("user",),
    "how far every node has come since its start: starting, waiting for something, ready or busy",
    qos=LATCHED, rate="on change")
TF = Contract(
    "/tf", TFMessage, ("sim",), ("recorder", "user"),
    "where links, tool and objects truly are; what rests comes once a second; for viewers only",
    qos=EVENTS, rate="up to 30 Hz", recorded=True)
TF_STATIC = Contract(
    "/tf_static", TFMessage, ("sim",), ("recorder", "user"),
    "where base, tool's mount, camera and furniture are", qos=LATCHED, rate="on change", recorded=True)
ROBOT_DESCRIPTION = Contract(
    "/robot_description", String, ("sim",), ("recorder", "user"),
    "the robot as URDF, its links being frames of /tf", qos=LATCHED, rate="once", recorded=True)
CELL_MARKERS = Contract(
    "/cell/markers", MarkerArray, ("sim",), ("recorder", "user"),
    "shapes of objects, container, pallet and tables, each fixed to its frame of /tf", qos=LATCHED,
    rate="on change", recorded=True)
# fmt: on

SHARED = contracts_in(globals())
