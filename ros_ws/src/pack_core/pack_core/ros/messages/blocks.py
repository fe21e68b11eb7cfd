"""Messages of the blocks cell to values and back: sightings, the fingers, problems, actions and plans."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

from geometry_msgs.msg import Point, Vector3
from pack_interfaces.msg import BlockAction, BlockPose, BlockTolerance
from pack_interfaces.msg import BlockSighting as BlockSightingMsg
from pack_interfaces.msg import GripperFootprint as GripperFootprintMsg
from pack_interfaces.msg import JawState as JawStateMsg
from pack_interfaces.msg import PrimitiveAction as PrimitiveActionMsg
from pack_interfaces.srv import PlanRearrangement
from std_msgs.msg import String

from pack_core.blocks.block_sighting import BlockSighting, parse_tags, tags_text
from pack_core.blocks.gripper import FingerState, FingerStatus, GripperFootprint
from pack_core.blocks.plan import Action, Diagnosis, PickPlace, Plan, PlanStatistics, PlanStatus, Push
from pack_core.blocks.planar import PlanarPose
from pack_core.blocks.primitive_action import PrimitiveAction, PrimitiveKind
from pack_core.blocks.problem import BlockSize, BlockSizes, PlacedBlock, Problem, Tolerance
from pack_core.config import Config, validate_config
from pack_core.errors import ConfigError, MessageError
from pack_core.ros.messages.conversions import WORLD, finite, from_stamp, to_stamp


def to_tags(tags: Mapping[str, int], sizes: BlockSizes) -> String:
    """The number of every block's tag, and the blocks' sizes."""
    return String(data=tags_text(tags, sizes))


def from_tags(message: String) -> tuple[dict[str, int], dict[str, BlockSize]]:
    """The number of every block's tag, and the sizes of those that are not cubes, by id."""
    return parse_tags(message.data)


def to_sighting(sighting: BlockSighting) -> BlockSightingMsg:
    """What was seen in a picture."""
    message = BlockSightingMsg(
        blocks=to_block_poses(sighting.poses), missing=list(sighting.missing),
        doubled=list(sighting.doubled), unknown=list(sighting.unknown),
    )  # fmt: skip
    message.header.stamp, message.header.frame_id = to_stamp(sighting.time), WORLD
    return message


def from_sighting(message: BlockSightingMsg) -> BlockSighting:
    """What was seen in a picture."""
    poses = from_block_poses(message.blocks, "blocks seen")
    for name, pose in poses.items():
        finite(pose.row, f"pose of {name}")
    return BlockSighting(
        from_stamp(message.header.stamp), poses, tuple(message.missing), tuple(message.doubled),
        tuple(message.unknown),
    )  # fmt: skip


def to_finger_state(state: FingerState, command: int) -> JawStateMsg:
    """The gripper's state after so many commands."""
    message = JawStateMsg(opening=state.opening, force=state.force, status=int(state.status), command=command)
    message.header.stamp = to_stamp(state.time)
    return message


def from_finger_state(message: JawStateMsg) -> FingerState:
    """The gripper's state."""
    if message.status not in list(FingerStatus):
        raise MessageError(
            f"status of the gripper is {message.status}; allowed: {[int(s) for s in FingerStatus]}"
        )
    opening, force = finite([message.opening, message.force], "state of the gripper")
    return FingerState(from_stamp(message.header.stamp), opening, force, FingerStatus(message.status))


def to_block_poses(poses: Mapping[str, PlanarPose]) -> list[BlockPose]:
    """Poses by id."""
    return [BlockPose(id=name, x=pose.x, y=pose.y, yaw=pose.yaw) for name, pose in poses.items()]


def from_block_poses(messages: Iterable[BlockPose], what: str) -> dict[str, PlanarPose]:
    """Poses by id; `what` names them in errors."""
    poses: dict[str, PlanarPose] = {}
    for message in messages:
        if message.id in poses:
            raise MessageError(f"block id occurs more than once in the {what}: {message.id}")
        poses[message.id] = PlanarPose(message.x, message.y, message.yaw)
    return poses


def to_request(
    problem: Problem, *, method: str = "", budget_s: float = 0.0, seed: int = 0
) -> PlanRearrangement.Request:
    """Ask for a plan; the node's own method and budget unless they are given."""
    return PlanRearrangement.Request(
        blocks=[BlockPose(id=b.id, x=b.pose.x, y=b.pose.y, yaw=b.pose.yaw) for b in problem.blocks],
        goals=to_block_poses(problem.goals),
        workspace=[Point(x=float(x), y=float(y)) for x, y in problem.workspace],
        sizes=[Vector3(x=b.size.x, y=b.size.y, z=b.size.z) for b in problem.blocks],
        symmetry=problem.symmetry,
        gripper=GripperFootprintMsg(**problem.gripper.model_dump()),
        tolerance=BlockTolerance(**problem.tolerance.model_dump()),
        starts_may_be_outside=problem.starts_may_be_outside,
        refused=[_to_primitive(primitive) for primitive in problem.refused],
        method=method, budget=budget_s, seed=seed,
    )  # fmt: skip


def from_request(request: PlanRearrangement.Request) -> Problem:
    """The problem of a request; the planner finds what contradicts itself in it."""
    try:
        gripper = validate_config(GripperFootprint, _fields(request.gripper, GripperFootprint), "gripper")
        tolerance = validate_config(Tolerance, _fields(request.tolerance, Tolerance), "tolerance")
    except ConfigError as error:
        raise MessageError(str(error)) from error
    if len(request.sizes) != len(request.blocks):
        raise MessageError(f"{len(request.sizes)} sizes of {len(request.blocks)} blocks; allowed: one each")
    return Problem(
        blocks=tuple(
            PlacedBlock(b.id, PlanarPose(b.x, b.y, b.yaw), BlockSize(size.x, size.y, size.z))
            for b, size in zip(request.blocks, request.sizes, strict=True)
        ),
        goals=from_block_poses(request.goals, "goals"),
        workspace=tuple((corner.x, corner.y) for corner in request.workspace),
        symmetry=request.symmetry, gripper=gripper, tolerance=tolerance,
        starts_may_be_outside=request.starts_may_be_outside,
        refused=tuple(_from_primitive(primitive) for primitive in request.refused),
    )  # fmt: skip


def fill_plan(response: PlanRearrangement.Response, plan: Plan) -> None:
    """Put a plan into a response."""
    response.status = int(plan.status)
    response.message, response.blocks = plan.diagnosis.text, list(plan.diagnosis.blocks)
    response.actions = [to_action(action) for action in plan.actions]
    response.lower_bound = plan.lower_bound
    response.planning_time = float(plan.statistics.total_s)
    response.first_plan_time = float(plan.statistics.first_plan_s)


def from_response(response: PlanRearrangement.Response) -> Plan:
    """The plan in a response."""
    if response.status not in list(PlanStatus):
        raise MessageError(f"status is {response.status}; allowed: {[int(s) for s in PlanStatus]}")
    return Plan(
        PlanStatus(response.status),
        tuple(_from_action(action) for action in response.actions),
        response.lower_bound,
        Diagnosis(response.message, tuple(response.blocks)),
        PlanStatistics(first_plan_s=response.first_plan_time, total_s=response.planning_time),
    )


def to_action(action: Action) -> BlockAction:
    """One action."""
    start, end = to_block_poses({action.block: action.start}), to_block_poses({action.block: action.end})
    if isinstance(action, Push):
        return BlockAction(kind=BlockAction.PUSH, start=start[0], end=end[0])
    return BlockAction(kind=BlockAction.PICK_PLACE, start=start[0], end=end[0], grasp=action.grasp)


def _from_action(message: BlockAction) -> Action:
    start, end = (PlanarPose(pose.x, pose.y, pose.yaw) for pose in (message.start, message.end))
    if not (start.is_finite and end.is_finite and message.start.id == message.end.id):
        raise MessageError(f"action of {message.start.id} and {message.end.id} from {start} to {end}")
    if message.kind == BlockAction.PUSH:
        return Push(message.start.id, start, end)
    if message.kind != BlockAction.PICK_PLACE or message.grasp not in (0, 1):
        raise MessageError(f"action is of kind {message.kind} with grasp {message.grasp}")
    return PickPlace(message.start.id, start, end, message.grasp)


def _to_primitive(primitive: PrimitiveAction) -> PrimitiveActionMsg:
    at = primitive.at
    return PrimitiveActionMsg(kind=primitive.kind, x=at.x, y=at.y, heading=at.yaw)


def _from_primitive(message: PrimitiveActionMsg) -> PrimitiveAction:
    at = PlanarPose(message.x, message.y, message.heading)
    if message.kind not in list(PrimitiveKind) or not at.is_finite:
        raise MessageError(f"refused primitive action is of kind {message.kind} at {at}")
    return PrimitiveAction(PrimitiveKind(message.kind), at)


def _fields(message: Any, config: type[Config]) -> dict[str, float]:
    return {name: float(getattr(message, name)) for name in config.model_fields}
