"""Which two bodies come too near to each other in a plan."""

from __future__ import annotations

from dataclasses import dataclass

from pack_motion.arm.arm import MotionArm
from pack_motion.reference.path_planner import MotionPlan


@dataclass(frozen=True)
class Conflict:
    """A violation of the clearance in a plan.

    Attributes:
        body: name of the arm's body, or of the carried box.
        obstacle: name of the obstacle.
        gap: distance between them [m]; negative where they overlap.
        time: time after the start of the move [s].
        segment: index of the segment of the path.
        text: all of this as an error text.
    """

    body: str
    obstacle: str
    gap: float
    time: float
    segment: int
    text: str


def conflict_at(
    arm: MotionArm, plan: MotionPlan, row: int, body: str, obstacle: str, gap: float, needed: float
) -> Conflict:
    """Describe the conflict at a row of the plan's trajectory; `gap` and `needed` are in metres."""
    trajectory = plan.trajectory
    time, segment = float(trajectory.times[row]), int(trajectory.segment[row])
    p = arm.chain.forward(trajectory.q[row]).p
    how = f"{1000 * gap:.0f} mm from" if gap > 0.0 else f"{-1000 * gap:.0f} mm inside"
    text = (
        f"'{body}' would be {how} '{obstacle}' in '{plan.segments[segment].label}', {time:.2f} s "
        f"after the start, the tool at {p.round(3).tolist()} m; needed: {1000 * max(needed, 0.0):.0f} mm"
    )
    return Conflict(body, obstacle, gap, time, segment, text)
