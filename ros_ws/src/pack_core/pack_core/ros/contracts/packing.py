"""The wiring table of the packing cell."""

from __future__ import annotations

from geometry_msgs.msg import WrenchStamped
from pack_interfaces.action import FillContainer, PackObject
from pack_interfaces.msg import GripperState, MocapMarkers, MpcStatus, SceneState, SettledSamples
from pack_interfaces.srv import GripperCommand, PlanFilling, PlanPlacement, PresentObject, ResetScene
from sensor_msgs.msg import CameraInfo, Image, JointState, PointCloud2
from std_msgs.msg import Header, String
from trajectory_msgs.msg import JointTrajectory
from visualization_msgs.msg import MarkerArray

from pack_core.packing import topics
from pack_core.packing.seen_deviations import SEEN
from pack_core.ros.contracts.contract import LATCHED, LATEST, STREAM, Contract, Kind, contracts_in, hz
from pack_core.ros.contracts.shared import SHARED

# fmt: off
DESCRIPTION = Contract(
    topics.DESCRIPTION, String, ("sim", "perception"), ("perception", "planner", "mpc", "recorder", "user"),
    "shapes, sizes and masses of container and objects, as a scene file without poses; with depth cameras "
    "from perception, as described or as seen",
    qos=LATCHED, rate="at reset, each hand-over, each look", recorded=True)
SIM_DESCRIPTION = Contract(
    topics.SIM_DESCRIPTION, String, ("sim",), ("perception", "recorder", "user"),
    "the same as the cell was told; perception with depth cameras begins with it", qos=LATCHED,
    rate="at reset and each hand-over", recorded=True)
JOINT_STATES = Contract(
    topics.JOINT_STATES, JointState, ("sim",), ("perception", "mpc", "recorder", "user"),
    "measured joint positions, velocities and torques", qos=STREAM, rate=hz(topics.JOINT_RATE), recorded=True)
SETPOINTS = Contract(
    topics.SETPOINTS, JointTrajectory, ("mpc",), ("sim", "recorder"),
    "joint positions, velocities and feed-forward torques over the horizon, stamped with their start",
    qos=LATEST, rate="each iteration", recorded=True)
CONTROLLER_TRAJECTORY = Contract(
    "/joint_trajectory_controller/joint_trajectory", JointTrajectory, ("user",), ("user",),
    "the same from the node `relay` to a driver's controller, where `relay.joint_trajectory` names it",
    qos=LATEST, rate="each iteration")
MARKERS = Contract(
    topics.MARKERS, MocapMarkers, ("sim",), ("perception", "recorder"),
    "markers that at least two cameras see", qos=STREAM, rate=hz(topics.MARKER_RATE), recorded=True)
DEPTH_IMAGE_1, DEPTH_IMAGE_2, DEPTH_IMAGE_3 = DEPTH_IMAGES = tuple(
    Contract(
        name, Image, ("sim",), ("perception", "recorder", "user"),
        "depths of a depth camera, if there is one, 16UC1: whole millimetres, 0 where nothing was measured",
        qos=STREAM, rate=hz(topics.DEPTH_RATE), recorded=True)
    for name in topics.DEPTH_IMAGES)
DEPTH_INFO_1, DEPTH_INFO_2, DEPTH_INFO_3 = DEPTH_INFOS = tuple(
    Contract(
        name, CameraInfo, ("sim",), ("perception", "recorder", "user"), "intrinsics of a depth camera",
        qos=LATCHED, rate="at reset", recorded=True)
    for name in topics.DEPTH_INFOS)
DEPTH_POINTS_1, DEPTH_POINTS_2, DEPTH_POINTS_3 = DEPTH_POINTS = tuple(
    Contract(
        name, PointCloud2, ("sim",), ("user",),
        "the same depths as points in the frame of the camera, a row for each row of the image, not a number "
        "where nothing was measured",
        qos=LATEST, rate=f"{hz(topics.DEPTH_RATE)}, while somebody listens")
    for name in topics.DEPTH_POINTS)
SEEN_OBJECTS = Contract(
    SEEN, String, ("perception",), ("recorder", "user"),
    "standard deviations of what a look with depth cameras saw, as YAML", qos=LATCHED, rate="each look",
    recorded=True)
SCENE = Contract(
    topics.SCENE, SceneState, ("perception",), ("mpc", "recorder", "user"),
    "estimated pose and twist of every object, with source and age", qos=STREAM,
    rate=hz(topics.MARKER_RATE), recorded=True)
WRENCH = Contract(
    topics.WRENCH, WrenchStamped, ("sim",), ("mpc", "recorder", "user"),
    "force on the suction cup, less the held object's weight, and torque, in the frame `tip`",
    qos=STREAM, rate=hz(topics.WRENCH_RATE), recorded=True)
WRENCH_ZEROED = Contract(
    topics.WRENCH_ZEROED, Header, ("sim",), ("mpc", "recorder", "user"),
    "when the force sensor was last set to zero with an empty cup", qos=LATCHED,
    rate="at reset and each grip", recorded=True)
GRIPPER_STATE = Contract(
    topics.GRIPPER_STATE, GripperState, ("sim",), ("perception", "mpc", "recorder", "user"),
    "what the pump holds and how hard it is pulled", qos=STREAM, rate=hz(topics.GRIPPER_RATE), recorded=True)
TRUTH = Contract(
    topics.TRUTH, SceneState, ("sim",), ("recorder", "user"),
    "true poses and twists; for whoever looks on, never for what controls", qos=STREAM,
    rate=hz(topics.TRUTH_RATE), recorded=True)
MPC_STATUS = Contract(
    topics.MPC_STATUS, MpcStatus, ("mpc",), ("recorder", "user"),
    "stage, cost, distance and iteration time", qos=STREAM, rate="each iteration", recorded=True)
VISUAL_MARKERS = Contract(
    "/markers", MarkerArray, ("planner",), ("user",),
    "placement samples, the cheapest as a settled scene, and the chosen pose for RViz and Foxglove",
    qos=LATCHED, rate="on change")
SETTLED_SAMPLES = Contract(
    topics.SETTLED_SAMPLES, SettledSamples, ("planner",), ("recorder", "user"),
    "some samples of a placement as settled scenes, with their costs", qos=LATCHED, rate="each placement",
    recorded=True)
RESULT = Contract(
    topics.RESULT, String, ("mpc",), ("recorder", "user"),
    "how the last goal ended, as JSON with the fields of the action's result", qos=LATCHED,
    rate="each goal", recorded=True)
PLAN_PLACEMENT = Contract(
    "/plan_placement", PlanPlacement, ("mpc", "user"), ("planner",),
    "find a packing pose for the held object, by Algorithm 1", kind=Kind.SERVICE)
RESET = Contract(
    "/sim/reset", ResetScene, ("user",), ("sim",), "begin with another scene, arm at home",
    kind=Kind.SERVICE)
PLAN_FILLING = Contract(
    "/plan_filling", PlanFilling, ("mpc", "user"), ("planner",),
    "where the remaining objects of a list shall stand, and which comes next", kind=Kind.SERVICE)
PRESENT = Contract(
    "/hand_over/present", PresentObject, ("mpc", "user"), ("sim",),
    "the next object arrives beside the container, to be picked up", kind=Kind.SERVICE)
GRIPPER_COMMAND = Contract(
    "/gripper/command", GripperCommand, ("mpc", "user"), ("sim",), "close or open the pump",
    kind=Kind.SERVICE)
PACK_OBJECT = Contract(
    "/pack_object", PackObject, ("user",), ("mpc",), "pack the held object into the container",
    kind=Kind.ACTION)
FILL_CONTAINER = Contract(
    "/fill_container", FillContainer, ("user",), ("mpc",),
    "pack the objects of a list, one after the other", kind=Kind.ACTION)
FILL_PROGRESS = Contract(
    topics.FILL_PROGRESS, String, ("mpc",), ("recorder", "user"),
    "where a fill job stands: object, stage, the objects handled so far and to come, and the fill, as JSON",
    qos=LATCHED, rate="each stage of each object", recorded=True)
FILL_RESULT = Contract(
    topics.FILL_RESULT, String, ("mpc",), ("recorder", "user"),
    "each object's fate in the last fill job, and the fill over time, as JSON", qos=LATCHED,
    rate="each fill job", recorded=True)
# fmt: on

CONTRACTS = (*SHARED, *contracts_in(globals()))
