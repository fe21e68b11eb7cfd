"""Status, feedback and result of a goal as messages."""

from __future__ import annotations

import json
from dataclasses import asdict

from pack_interfaces.action import PackObject
from pack_interfaces.msg import MpcStatus
from std_msgs.msg import String

from pack_core.packing.load_shedding import LoadShedding
from pack_core.ros.messages.conversions import WORLD, to_pose, to_stamp
from pack_mpc.controller import ControlPlan
from pack_mpc.observation import PackingObservation
from pack_mpc.session import PackingSession


def to_status(
    session: PackingSession, seen: PackingObservation, plan: ControlPlan, load: LoadShedding
) -> MpcStatus:
    """The status of one iteration, for plots and the recorder."""
    task, machine = session.task, session.task.machine
    assert machine is not None
    message = MpcStatus(
        stage=machine.stage.name, elapsed=task.elapsed(seen.joints.time), distance=task.distance,
        cost=plan.solution.cost, iteration_ms=plan.iteration_ms, step_size=plan.solution.step_size,
        regularisation=plan.solution.regularisation, target=to_pose(machine.placement.X_WN),
        collisions=list(machine.placement.collisions), placements=len(task.tried),
        warning="; ".join(filter(None, (to_look(session), plan.solution.warning, load.in_words))),
    )  # fmt: skip
    message.header.stamp, message.header.frame_id = to_stamp(seen.joints.time), WORLD
    return message


def to_look(session: PackingSession) -> str:
    """Which objects the goal is looking for, in words; empty if it is not."""
    task = session.task
    return f"looking for {', '.join(task.unseen)}" if task.is_looking else ""


def to_feedback(session: PackingSession, seen: PackingObservation, plan: ControlPlan) -> PackObject.Feedback:
    """The feedback of one iteration, for the client that sent the goal."""
    task, machine = session.task, session.task.machine
    assert machine is not None
    return PackObject.Feedback(
        stage=machine.stage.name, elapsed=task.elapsed(seen.joints.time), distance=task.distance,
        cost=plan.solution.cost, iteration_ms=plan.iteration_ms,
    )  # fmt: skip


def to_outcome(session: PackingSession) -> String:
    """The outcome of a goal that has ended, as JSON."""
    outcome = session.task.outcome
    assert outcome is not None
    return String(data=json.dumps(asdict(outcome), default=lambda reason: reason.value))


def to_result(session: PackingSession) -> PackObject.Result:
    """The result of a goal that has ended."""
    outcome = session.task.outcome
    assert outcome is not None
    return PackObject.Result(
        success=outcome.success, exit_reason=outcome.exit_reason.value, message=outcome.message,
        execution_time=outcome.execution_time, distance=outcome.distance, force_mean=outcome.force_mean,
        force_peak=outcome.force_peak, iteration_ms=session.iteration_ms, placements=outcome.placements,
    )  # fmt: skip
