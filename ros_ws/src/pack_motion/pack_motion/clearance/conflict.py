"""What comes too near to what."""

from __future__ import annotations

from dataclasses import dataclass

from pack_motion.arm.arm import MotionArm
from pack_motion.reference.path_planner import MotionPlan


@dataclass(frozen=True)
class Conflict:
    """A shortage of room in a plan.

    Attributes:
        body: of the arm, or the carried box.
        obstacle: its name.
        gap: between them [m]; negative where they overlap.
        time: after the start of the move [s].
        segment: of the path.
        text: all that in words.
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
    """The shortage at a row of the plan's trajectory."""
    trajectory = plan.trajectory
    time, segment = float(trajectory.times[row]), int(trajectory.segment[row])
    p = arm.chain.forward(trajectory.q[row]).p
    how = f"{1000 * gap:.0f} mm from" if gap > 0.0 else f"{-1000 * gap:.0f} mm inside"
    text = (
        f"'{body}' would be {how} '{obstacle}' in '{plan.segments[segment].label}', {time:.2f} s "
        f"after the start, the tool at {p.round(3).tolist()} m; needed: {1000 * max(needed, 0.0):.0f} mm"
    )
    return Conflict(body, obstacle, gap, time, segment, text)
