"""Harder requests: recorded transfers with something in the way that height alone does not solve."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from pack_core.motion.moves import Transfer
from pack_core.motion.world import Obstacle
from pack_core.rotations import Array, Pose, from_yaw
from pack_lockstep.motion.requests import MotionRequest
from pack_motion.arm.arm import load_arm
from pack_motion.arm.bodies import BodyBoxes
from pack_motion.clearance.check import ClearanceCheck, Conflict, Surrounding
from pack_motion.clearance.transfer import TransferPlanner
from pack_motion.reference.path_planner import PathPlanner
from pack_motion.reference.trajectory import MoveRefused
from pack_motion.tracking.config import motion_set


@dataclass(frozen=True)
class Intruder:
    """What stands in the way: edge lengths are drawn between two boxes' [m]."""

    name: str
    smallest: tuple[float, float, float]
    largest: tuple[float, float, float]

    def drawn(self, p: Array, rng: np.random.Generator) -> Obstacle:
        """One that stands on the floor at `p` `(2,)` [m], turned at random."""
        size = rng.uniform(self.smallest, self.largest)
        X_WO = Pose(np.array([p[0], p[1], 0.5 * size[2]]), from_yaw(float(rng.uniform(-np.pi, np.pi))))
        return Obstacle(self.name, X_WO, size)


INTRUDERS = (
    Intruder("second stack", (1.0, 0.6, 1.2), (1.2, 0.8, 2.2)),
    Intruder("column", (0.2, 0.2, 4.5), (0.4, 0.4, 4.5)),
    Intruder("person", (0.5, 0.4, 1.6), (0.6, 0.5, 1.95)),
)
BESIDE = 0.05
"""What an intruder leaves free beside the arm at the ends of a transfer [m]."""
TURN_ROWS = 100
"""Angles of the first joint at which the first link must be clear."""
REACHES = (0.5, 1.15)
"""Of the distances of both ends from the arm's first axis, the shares between which one stands."""


def harder_requests(recorded: Sequence[MotionRequest], count: int, seed: int) -> list[MotionRequest]:
    """So many requests with an intruder each, the kinds in turn.

    It stands between both ends as seen from the arm's first axis. A request is kept if the intruder is what
    is in the way after all heights of both lines, and if nothing that every way needs is blocked: both ends,
    their shortest lines, and the turn of the first link. Whether the planner finds a way plays no part.
    """
    rng = np.random.default_rng(seed)
    transfers = [request for request in recorded if isinstance(request.target.move, Transfer)]
    found: list[MotionRequest] = []
    while len(found) < count:
        request = transfers[int(rng.integers(len(transfers)))]
        intruder = INTRUDERS[len(found) % len(INTRUDERS)].drawn(_place(request, rng), rng)
        name = f"{len(found):03d} {intruder.name}, {request.name}"
        target = replace(request.target, obstacles=(*request.target.obstacles, intruder))
        harder = replace(request, name=name, target=target)
        if _leaves_ends_clear(request, intruder) and _stopped_by(harder) == intruder.name:
            found.append(harder)
    return found


def _place(request: MotionRequest, rng: np.random.Generator) -> Array:
    """A point on the floor `(2,)` [m] between both ends of a transfer, as seen from the first axis."""
    assert isinstance(request.target.move, Transfer)
    chain = load_arm(request.cell).chain
    ends = chain.forward(request.start.q).p, request.target.move.lines[-1].X_WT.p
    start, end = (p[:2] - chain.points[0][:2] for p in ends)
    turn = float(np.arctan2(start[0] * end[1] - start[1] * end[0], start @ end))
    angle = float(np.arctan2(start[1], start[0])) + turn * float(rng.uniform(0.2, 0.8))
    near, far = sorted(float(np.linalg.norm(p)) for p in (start, end))
    reach = rng.uniform(*REACHES) * rng.uniform(near, far)
    return np.asarray(chain.points[0][:2] + reach * np.array([np.cos(angle), np.sin(angle)]))


def _leaves_ends_clear(request: MotionRequest, intruder: Obstacle) -> bool:
    """Whether the arm is clear of an intruder at both ends of a transfer and where its first link turns."""
    arm, target, transfer = load_arm(request.cell), request.target, request.target.move
    assert isinstance(transfer, Transfer)
    is_clear = ClearanceCheck(arm, BESIDE).gate(
        Surrounding((intruder,), target.carried, opening=target.opening), BESIDE
    )
    q_start, (shoulder, elbow, _) = request.start.q, arm.inverse.branch(request.start.q)
    X_goal = transfer.lines[-1].X_WT
    needed = [[q_start], arm.inverse.candidates(X_goal, shoulder, elbow)]
    for X, retreat in ((arm.chain.forward(q_start), transfer.depart), (X_goal, transfer.hover)):
        if retreat is not None:
            over = Pose(X.p + retreat.lengths[0] * np.asarray(retreat.direction), X.q)
            needed.append(arm.inverse.candidates(over, shoulder, elbow))
    if not all(any(is_clear(q[None]) for q in choices) for choices in needed):
        return False
    turn = np.tile(q_start, (TURN_ROWS, 1))
    turn[:, 0] = np.linspace(q_start[0], needed[1][0][0], TURN_ROWS)
    turning = ClearanceCheck(replace(arm, bodies=_first_link(arm.bodies)), BESIDE)
    return turning.gate(Surrounding((intruder,)), BESIDE)(turn)


def _first_link(bodies: BodyBoxes) -> BodyBoxes:
    """The boxes that the first joint alone moves."""
    own = np.flatnonzero(bodies.link == 0)
    names = tuple(bodies.names[i] for i in own)
    return BodyBoxes(names, bodies.link[own], bodies.R[own], bodies.p[own], bodies.half[own])


def _stopped_by(request: MotionRequest) -> str:
    """What is in the way of a transfer after all heights; empty where it is clear, or its lines are not."""
    arm, config, target = load_arm(request.cell), motion_set("shipped"), request.target
    paths, check = PathPlanner(arm, config.limit_share), ClearanceCheck(arm, config.clearance)
    around = Surrounding(target.obstacles, target.carried, target.contacts, target.opening)
    assert isinstance(target.move, Transfer)
    try:
        found = TransferPlanner(arm, paths, check).by_height(request.start, target.move, around)
    except MoveRefused:
        return ""
    return found.obstacle if isinstance(found, Conflict) else ""
