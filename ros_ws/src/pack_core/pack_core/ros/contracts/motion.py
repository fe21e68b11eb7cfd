"""What cells that move through motion targets have on their wires."""

from __future__ import annotations

from pack_interfaces.msg import BoxObstacles, MotionStatus, MotionTarget
from sensor_msgs.msg import JointState
from trajectory_msgs.msg import JointTrajectory

from pack_core.ros.contracts.contract import EVENTS, LATEST, STREAM, Contract, contracts_in

# fmt: off
JOINT_STATES = Contract(
    "/joint_states", JointState, ("sim",), ("motion", "recorder"),
    "measured joint positions, velocities and torques", qos=STREAM, rate="250 Hz", recorded=True)
MOTION_TARGET = Contract(
    "/motion/target", MotionTarget, ("fsm", "user"), ("motion", "recorder"),
    "a move, what it is made among, and what is carried; without segments: stop",
    qos=EVENTS, rate="each move", recorded=True)
MOTION_STATUS = Contract(
    "/motion/status", MotionStatus, ("motion",), ("fsm", "recorder", "user"),
    "state, running segment, measured errors, reasons", qos=STREAM, rate="250 Hz", recorded=True)
MOTION_OBSTACLES = Contract(
    "/motion/obstacles", BoxObstacles, ("user",), ("motion", "recorder"),
    "where things that move are", qos=LATEST, rate="as seen", recorded=True)
SETPOINTS = Contract(
    "/joint_setpoints", JointTrajectory, ("motion",), ("sim", "recorder"),
    "joint positions, velocities and accelerations, stamped with their start, which has come",
    qos=LATEST, rate="250 Hz", recorded=True)
# fmt: on

MOTION = contracts_in(globals())
