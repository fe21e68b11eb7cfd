"""Checks a plan action by action with polygons, independently of the planners' own geometry."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping

from shapely import Polygon, affinity, box

from pack_core.blocks.plan import Action, PickPlace, Plan, Push
from pack_core.blocks.planar import QUARTER, PlanarPose, turn_between, wrapped
from pack_core.blocks.primitive_action import is_refused
from pack_core.blocks.problem import Problem

TOUCH = 1e-6
"""Polygons that overlap by less than this only touch [m]."""
EXACT = 1e-6
"""Largest difference between poses that must be the same [m, rad]."""


def verify(problem: Problem, plan: Plan) -> list[str]:
    """The faults of a plan in words; empty for a valid plan that reaches all goals.

    Blocks that count as standing on their goals are taken to stand there exactly, and a block's first action
    may start within tolerance of where the block was measured, as the planner assumes.
    """
    goals = problem.goals
    poses = {
        name: _snapped(problem, name, pose) if name in goals else pose
        for name, pose in problem.starts.items()
    }
    moved: set[str] = set()
    faults: list[str] = []
    for number, action in enumerate(plan.actions, 1):
        what = f"action {number} ({type(action).__name__} {action.block})"
        if action.block not in poses:
            return [*faults, f"{what}: there is no such block"]
        if action.block not in goals:
            return [*faults, f"{what}: it has no goal, and is to stay"]
        faults += [f"{what}: {fault}" for fault in _faults(problem, poses, action, action.block in moved)]
        poses[action.block] = action.end
        moved.add(action.block)
    return faults + [
        f"{name} does not end at its goal"
        for name, pose in poses.items()
        if name in goals and not _is_home(problem, name, pose)
    ]


def _faults(
    problem: Problem, poses: Mapping[str, PlanarPose], action: Action, has_moved: bool
) -> Iterator[str]:
    yield from _jump(problem, poses[action.block], action.start, has_moved)
    if is_refused(action, problem.refused):
        yield "is what the arm refused"
    if not Polygon(problem.workspace).buffer(EXACT).covers(_block(problem, action.block, action.end)):
        yield "ends outside the workspace"
    if isinstance(action, PickPlace):
        opening = problem.gripper.grasp_opening(problem.sizes[action.block][action.grasp])
        if opening > problem.gripper.max_opening + EXACT:
            yield f"needs an opening of {1e3 * opening:.1f} mm, more than the gripper has"
    sweeps = _push_sweeps if isinstance(action, Push) else _grasp_sweeps
    if isinstance(action, Push):
        yield from _push_faults(problem, action)
    for what, polygon in sweeps(problem, action):
        for name, pose in poses.items():
            if name != action.block and _overlap(polygon, _block(problem, name, pose)):
                yield f"the {what} hits {name}"


def _jump(problem: Problem, now: PlanarPose, start: PlanarPose, has_moved: bool) -> Iterator[str]:
    """A fault if the action does not start where the block stands."""
    distance = EXACT if has_moved else problem.tolerance.push_line + EXACT
    angle = EXACT if has_moved else math.radians(problem.tolerance.angle_deg) + EXACT
    if now.distance_to(start) > distance or abs(turn_between(now, start)) > angle:
        yield f"starts at {start}, but the block stands at {now}"


def _push_faults(problem: Problem, push: Push) -> Iterator[str]:
    if abs(turn_between(push.start, push.end)) > EXACT:
        yield "turns the block"
    across = abs(float(wrapped(push.direction - push.start.yaw, QUARTER)))
    if across * push.distance > EXACT:
        yield f"goes {math.degrees(across):.2f} degrees off the normal of a face"
    shortest, longest = problem.gripper.min_push, problem.gripper.max_push
    if not shortest - EXACT <= push.distance <= longest + EXACT:
        yield f"is {1e3 * push.distance:.1f} mm long; allowed: {1e3 * shortest:.0f} to {1e3 * longest:.0f}"


def _grasp_sweeps(problem: Problem, action: Action) -> Iterator[tuple[str, Polygon]]:
    assert isinstance(action, PickPlace)
    for what, pose in (("gripper at the pick", action.start), ("gripper at the place", action.end)):
        for finger in _fingers(problem, action.block, pose, action.grasp):
            yield what, finger
    yield "block put down", _block(problem, action.block, action.end, problem.gripper.block_margin)


def _thickness(problem: Problem, block: str) -> float:
    """Of a finger at the top of the tallest block; it reaches `insertion` below that of its own [m]."""
    gripper, above = problem.gripper, problem.tallest - problem.sizes[block].z
    return gripper.finger_tip_thickness + gripper.finger_taper * (gripper.insertion + above)


def _fingers(problem: Problem, block: str, pose: PlanarPose, grasp: int) -> Iterator[Polygon]:
    gripper, face = problem.gripper, problem.sizes[block][grasp] / 2
    half = gripper.finger_width / 2 + gripper.safety_margin
    outer = face + gripper.opening_clearance + _thickness(problem, block) + gripper.safety_margin
    for low, high in ((face, outer), (-outer, -face)):
        slab = box(low, -half, high, half)
        yield _at(affinity.rotate(slab, 90 * grasp, origin=(0, 0)), pose)


def _push_sweeps(problem: Problem, action: Action) -> Iterator[tuple[str, Polygon]]:
    """Areas swept by the pushed block, and by the fingers behind it from touchdown to lift-off."""
    gripper, size = problem.gripper, problem.sizes[action.block]
    assert isinstance(action, Push)
    across, half = (extent / 2 for extent in size.across_and_along(action.start, action.direction))
    grown, beside = half + gripper.block_margin, across + gripper.block_margin
    distance = action.distance
    along = PlanarPose(action.start.x, action.start.y, action.direction)
    yield "block pushed", _at(box(-half, -beside, distance + grown, beside), along)
    wide = gripper.push_gap / 2 + _thickness(problem, action.block) + gripper.safety_margin
    rear = -half - gripper.push_standoff - gripper.finger_width - gripper.safety_margin
    yield "gripper pushing", _at(box(rear, -wide, distance - half, wide), along)


def _block(problem: Problem, name: str, pose: PlanarPose, margin: float = 0.0) -> Polygon:
    size = problem.sizes[name]
    x, y = size.x / 2 + margin, size.y / 2 + margin
    return _at(box(-x, -y, x, y), pose)


def _at(shape: Polygon, pose: PlanarPose) -> Polygon:
    turned = affinity.rotate(shape, pose.yaw, origin=(0, 0), use_radians=True)
    return affinity.translate(turned, pose.x, pose.y)


def _overlap(a: Polygon, b: Polygon) -> bool:
    return bool(a.buffer(-TOUCH, join_style="mitre").intersects(b))


def _snapped(problem: Problem, name: str, pose: PlanarPose) -> PlanarPose:
    if not _is_home(problem, name, pose):
        return pose
    goal = problem.goals[name]
    return PlanarPose(goal.x, goal.y, pose.yaw + turn_between(pose, goal, problem.symmetry))


def _is_home(problem: Problem, name: str, pose: PlanarPose) -> bool:
    goal, tolerance = problem.goals[name], problem.tolerance
    turn = abs(turn_between(pose, goal, problem.symmetry))
    return pose.distance_to(goal) <= tolerance.position and turn <= math.radians(tolerance.angle_deg)
