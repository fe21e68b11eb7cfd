"""What every cell has on its wires."""

from __future__ import annotations

from diagnostic_msgs.msg import DiagnosticArray
from pack_interfaces.msg import NodeStatus
from rosgraph_msgs.msg import Clock
from std_msgs.msg import Float64

from pack_core import topics
from pack_core.ros.contracts.contract import EVENTS, LATCHED, LATEST, STREAM, Contract, contracts_in, hz

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
NODE_STATUS = Contract(
    "/node_status", NodeStatus, ("all",), ("user",),
    "how far every node has come since its start: starting, waiting for something, ready or busy",
    qos=LATCHED, rate="on change")
# fmt: on

SHARED = contracts_in(globals())
