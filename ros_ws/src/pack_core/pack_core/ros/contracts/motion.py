"""What cells that move through motion targets have on their wires, and an overhead camera of such a cell."""

from __future__ import annotations

from control_msgs.action import FollowJointTrajectory
from control_msgs.msg import JointTrajectoryControllerState
from pack_interfaces.msg import BoxObstacles, MotionStatus, MotionTarget, Separation
from sensor_msgs.msg import CameraInfo, Image, JointState
from std_srvs.srv import Trigger
from trajectory_msgs.msg import JointTrajectory
from visualization_msgs.msg import MarkerArray

from pack_core.motion import topics
from pack_core.ros.contracts.contract import (
    EVENTS,
    LATCHED,
    LATEST,
    NEWEST,
    STREAM,
    Contract,
    Kind,
    contracts_in,
    hz,
)

# fmt: off
JOINT_STATES = Contract(
    topics.JOINT_STATES, JointState, ("sim",), ("motion", "recorder", "user"),
    "measured joint positions, velocities and torques", qos=STREAM, rate=hz(topics.JOINT_RATE), recorded=True)
MOTION_TARGET = Contract(
    topics.MOTION_TARGET, MotionTarget, ("fsm", "user"), ("motion", "recorder"),
    "a move, what it is made among, and what is carried; without segments: stop",
    qos=EVENTS, rate="each move", recorded=True)
MOTION_STATUS = Contract(
    topics.MOTION_STATUS, MotionStatus, ("motion",), ("fsm", "recorder", "user"),
    "state of the move, running segment, measured errors, reason of a refusal", qos=STREAM,
    rate=hz(topics.JOINT_RATE), recorded=True)
MOTION_OBSTACLES = Contract(
    topics.MOTION_OBSTACLES, BoxObstacles, ("sim", "user"), ("motion", "recorder"),
    "where moving obstacles were at the stamp; from the sim of a cell that a sensor watches", qos=LATEST,
    rate="as seen", recorded=True)
SEPARATION = Contract(
    topics.MOTION_SEPARATION, Separation, ("motion",), ("recorder", "user"),
    "by how much the arm is farther from people than it must be", qos=STREAM,
    rate=f"{hz(topics.JOINT_RATE)}, while somebody is seen", recorded=True)
SETPOINTS = Contract(
    topics.SETPOINTS, JointTrajectory, ("motion",), ("sim", "recorder"),
    "joint positions, velocities and accelerations, stamped with their start, which has come",
    qos=LATEST, rate=hz(topics.JOINT_RATE), recorded=True)
FOLLOW_JOINT_TRAJECTORY = Contract(
    f"{topics.CONTROLLER}/follow_joint_trajectory", FollowJointTrajectory, ("motion",), ("user",),
    "whole moves for a driver's controller, not setpoints, where `motion.follow_joint_trajectory` names it",
    kind=Kind.ACTION)
CONTROLLER_STATE = Contract(
    f"{topics.CONTROLLER}/controller_state", JointTrajectoryControllerState, ("user",), ("motion",),
    "how fast that controller goes through its trajectory", qos=NEWEST, rate="each cycle of the controller")
GOAL_MARKERS = Contract(
    topics.GOAL_MARKERS, MarkerArray, ("fsm",), ("recorder", "user"),
    "where boxes or blocks are to stand at the end of the goal, for RViz and Foxglove", qos=LATCHED,
    rate="each goal", recorded=True)
# fmt: on

MOTION = contracts_in(globals())


def overhead_camera(vision: str) -> tuple[Contract, Contract, Contract]:
    """The camera's trigger, its pictures and its intrinsics, for the node `vision` that looks at them."""
    trigger = Contract(
        "/camera/trigger", Trigger, ("fsm", "user"), ("sim",),
        "take a picture now; it follows, stamped with this moment", kind=Kind.SERVICE,
    )  # fmt: skip
    image = Contract(
        topics.IMAGE, Image, ("sim",), (vision, "recorder"),
        "picture of the overhead camera, rgb8; recorded with `recorder.pictures`", qos=LATEST,
        rate="on demand",
    )  # fmt: skip
    info = Contract(
        topics.CAMERA_INFO, CameraInfo, ("sim",), (vision, "recorder"),
        "intrinsics of the overhead camera", qos=LATCHED, rate="with each picture", recorded=True,
    )  # fmt: skip
    return trigger, image, info
