"""Motion targets, their obstacles and the motion's status, to messages and back."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from pack_interfaces.msg import BoxObstacle, BoxObstacles, MotionRetreat, MotionSegment
from pack_interfaces.msg import MotionStatus as MotionStatusMsg
from pack_interfaces.msg import MotionTarget as MotionTargetMsg

from pack_core.errors import MessageError, PackError
from pack_core.motion.moves import JointMove, Line, Mode, Move, Path, PoseMove, Retreat, Segment, Transfer
from pack_core.motion.target import MotionState, MotionStatus, MotionTarget, ReachTolerance
from pack_core.motion.world import CarriedBox, Obstacle
from pack_core.ros.messages.conversions import (
    WORLD,
    finite,
    from_pose,
    from_stamp,
    from_vector,
    to_pose,
    to_stamp,
    to_vector,
)


def to_target(target: MotionTarget, time: float) -> MotionTargetMsg:
    """A message of a target that is sent at `time` [s]."""
    message = MotionTargetMsg(id=target.id, is_checked=target.is_checked, contacts=sorted(target.contacts))
    message.header.stamp, message.header.frame_id = to_stamp(time), WORLD
    move = target.move
    segments = move.segments if isinstance(move, Path) else move.lines
    message.segments = [_to_segment(segment) for segment in segments]
    if isinstance(move, Transfer):
        message.is_transfer, message.departs = True, move.depart is not None
        message.hover = _to_retreat(move.hover)
        message.depart = _to_retreat(move.depart or move.hover)  # unused without `departs`, but never empty
        message.speed, message.acceleration = move.speed, move.acceleration
    if target.carried is not None:
        message.is_carrying = True
        message.carried_pose = to_pose(target.carried.X_TB)
        message.carried_size = to_vector(target.carried.size)
    message.obstacles = [to_obstacle(item) for item in target.obstacles]
    message.position_tolerance = target.tolerance.position
    message.orientation_tolerance_deg = target.tolerance.orientation_deg
    message.reached_steps, message.opening = target.tolerance.steps, float(target.opening)
    return message


def from_target(message: MotionTargetMsg) -> MotionTarget:
    """The target in a message; an empty path means: stop.

    Raises:
        MessageError: it has values that must not be used.
    """
    carried = None
    try:
        if message.is_carrying:
            carried = CarriedBox(from_pose(message.carried_pose), from_vector(message.carried_size, "size"))
        return MotionTarget(
            message.id, _move_of(message), carried, from_obstacles(message.obstacles),
            frozenset(message.contacts),
            ReachTolerance(
                message.position_tolerance, message.orientation_tolerance_deg, int(message.reached_steps)
            ),
            message.is_checked, float(finite([message.opening], "opening")[0]),
        )  # fmt: skip
    except PackError as error:
        raise MessageError(str(error)) from error


def to_status(status: MotionStatus) -> MotionStatusMsg:
    """Where a move stands."""
    message = MotionStatusMsg(
        id=status.id, state=status.state.value, segment=status.segment, label=status.label,
        remaining=status.remaining, position_error=status.position_error,
        orientation_error=status.orientation_error, path_error=status.path_error,
        reached_steps=status.reached_steps, reason=status.reason, tool=to_pose(status.X_WT),
    )  # fmt: skip
    message.header.stamp, message.header.frame_id = to_stamp(status.time), WORLD
    return message


def from_status(message: MotionStatusMsg) -> MotionStatus:
    """Where a move stands."""
    if message.state not in [state.value for state in MotionState]:
        raise MessageError(f"motion state '{message.state}'; allowed: {[s.value for s in MotionState]}")
    return MotionStatus(
        from_stamp(message.header.stamp), message.id, MotionState(message.state), message.segment,
        message.label, message.remaining, message.position_error, message.orientation_error,
        message.path_error, int(message.reached_steps), message.reason, from_pose(message.tool),
    )  # fmt: skip


def _move_of(message: MotionTargetMsg) -> Move:
    segments = tuple(_from_segment(item) for item in message.segments)
    if not message.is_transfer:
        return Path(segments)
    lines = tuple(item for item in segments if isinstance(item, Line))
    if not lines or len(lines) != len(segments):
        raise MessageError("a transfer's segments must all be lines, and at least one")
    depart = _from_retreat(message.depart) if message.departs else None
    shares = _share(message.speed, "speed"), _share(message.acceleration, "acceleration")
    return Transfer(lines, _from_retreat(message.hover), depart, *shares)


def _to_segment(segment: Segment) -> MotionSegment:
    message = MotionSegment(
        speed=segment.speed, acceleration=segment.acceleration, label=segment.label, mode=segment.mode.value
    )
    if isinstance(segment, JointMove):
        message.kind, message.joints, message.stop = MotionSegment.JOINT_MOVE, list(segment.q), segment.stop
    elif isinstance(segment, PoseMove):
        message.kind, message.pose, message.stop = (
            MotionSegment.POSE_MOVE,
            to_pose(segment.X_WT),
            segment.stop,
        )
    else:
        message.kind, message.pose = MotionSegment.LINE, to_pose(segment.X_WT)
        message.entry_speed, message.exit_speed = segment.entry_speed, segment.exit_speed
        message.blend = segment.blend
    return message


def _from_segment(message: MotionSegment) -> Segment:
    modes = [mode.value for mode in Mode]
    if message.mode not in modes:
        raise MessageError(f"mode of '{message.label}' is '{message.mode}'; allowed: {', '.join(modes)}")
    mode, label = Mode(message.mode), message.label
    if message.kind == MotionSegment.LINE:
        speeds = finite(
            [message.speed, message.acceleration, message.entry_speed, message.exit_speed, message.blend],
            f"a speed of '{label}'",
        )
        if speeds.min() < 0.0 or speeds[:2].min() <= 0.0:
            raise MessageError(
                f"speeds of '{label}' are {speeds.tolist()}; allowed: positive, or 0 at its ends"
            )
        return Line(from_pose(message.pose), *speeds.tolist(), label, mode)
    shares = _share(message.speed, label), _share(message.acceleration, label)
    if message.kind == MotionSegment.POSE_MOVE:
        return PoseMove(from_pose(message.pose), *shares, message.stop, label, mode)
    if message.kind == MotionSegment.JOINT_MOVE:
        return JointMove(finite(message.joints, f"joints of '{label}'"), *shares, message.stop, label, mode)
    raise MessageError(f"kind of '{label}' is {message.kind}; allowed: 0 (joint), 1 (pose), 2 (line)")


def _share(value: float, what: str) -> float:
    if not 0.0 < value <= 1.0:
        raise MessageError(f"share of the joint limits of '{what}' is {value}; allowed: above 0, at most 1")
    return float(value)


def _to_retreat(retreat: Retreat) -> MotionRetreat:
    return MotionRetreat(
        direction=to_vector(retreat.direction), shortest=retreat.lengths[0], longest=retreat.lengths[1],
        speed=retreat.speed, acceleration=retreat.acceleration, pass_speed=retreat.pass_speed,
        slow_length=retreat.slow_length, slow_speed=retreat.slow_speed,
    )  # fmt: skip


def _from_retreat(message: MotionRetreat) -> Retreat:
    direction = from_vector(message.direction, "direction of a retreat")
    lengths = finite([message.shortest, message.longest], "length of a retreat")
    if not np.linalg.norm(direction) > 0.0 or not 0.0 <= lengths[0] <= lengths[1]:
        raise MessageError(
            f"a retreat along {direction.tolist()} by {lengths.tolist()} m; allowed: rising lengths"
        )
    speeds = finite(
        [message.speed, message.acceleration, message.pass_speed, message.slow_length, message.slow_speed],
        "speed of a retreat",
    )
    if speeds[3] < 0.0 or (speeds[3] > 0.0 and speeds[4] <= 0.0):
        raise MessageError(
            f"a retreat is slow for {speeds[3]:g} m, at {speeds[4]:g} m/s; "
            "allowed: a length from 0, a speed above 0"
        )
    return Retreat(direction, (float(lengths[0]), float(lengths[1])), *speeds.tolist())


def to_obstacle(item: Obstacle) -> BoxObstacle:
    """A message of an obstacle."""
    return BoxObstacle(
        name=item.name, pose=to_pose(item.X_WO), size=to_vector(item.size),
        velocity=to_vector(item.v_WO_W), is_moving=item.is_moving,
    )  # fmt: skip


def to_obstacles(obstacles: Iterable[Obstacle], time: float) -> BoxObstacles:
    """A message of moving obstacles as they were seen at `time` [s]."""
    message = BoxObstacles(obstacles=[to_obstacle(item) for item in obstacles])
    message.header.stamp, message.header.frame_id = to_stamp(time), WORLD
    return message


def from_obstacles(messages: Iterable[BoxObstacle]) -> tuple[Obstacle, ...]:
    """The obstacles in messages; MessageError or PackError where one has values that must not be used."""
    return tuple(
        Obstacle(
            item.name, from_pose(item.pose), from_vector(item.size, f"size of {item.name}"),
            from_vector(item.velocity, f"velocity of {item.name}"), item.is_moving,
        )
        for item in messages
    )  # fmt: skip
