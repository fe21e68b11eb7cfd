"""Pausing a simulator and stopping its arm, as a test's probe does it."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from itertools import pairwise
from typing import Any

import numpy as np
from pack_interfaces.srv import StopArm
from rclpy.parameter import Parameter

from integration.harness import Graph
from pack_core.joints import JointSample
from pack_core.ros.contracts import motion, shared
from pack_core.ros.messages.conversions import from_stamp
from pack_core.ros.simulation_types import Result, SetSimulationState, SimulationState
from pack_core.rotations import Array
from pack_motion.motion_node import MotionNode

WHO = "the test's button"
FACTOR = "real_time_factor"
SLOW = 0.1
"""Real-time factor at which the 40 ms of setpoints that the driver has last for 0.4 s of wall clock."""
FRESH = 0.05
"""Half of the age at which a driver brakes for want of newer setpoints, in every cell [s]."""
AMPLE = 0.02
"""Half of the time for which the setpoints of the motion last [s]."""
TICK = 0.004
"""What the pacing counts for a turn in which simulated time stands [s]."""
REPORTS = 4
"""Reports of health of each node during a pause, one a second: peers have time to miss each other."""
GOES_ON = 0.25
"""After a pause: longer than setpoints last, so that any joint states that it cost would show [s]."""


@contextmanager
def slowly(sim: Any) -> Iterator[None]:
    """Let simulated time pass so slowly meanwhile that a busy machine costs nobody what is measured in it.

    No setpoints come too late then, and nobody's answer does.
    """
    factor = sim.get_parameter(FACTOR).value
    sim.set_parameters([Parameter(FACTOR, value=SLOW)])
    yield
    sim.set_parameters([Parameter(FACTOR, value=factor)])


def accept_times(node: Any) -> list[float]:
    """Simulated times at which the driver takes setpoints from now on [s]."""
    times: list[float] = []
    accept: Callable[[Any], None] = node.simulator.accept

    def noted(setpoints: Any) -> None:
        accept(setpoints)
        times.append(node.simulator.time)

    node.simulator.accept = noted
    return times


@contextmanager
def standing_without_setpoints(node: Any, accepted: list[float], fresh: float = FRESH) -> Iterator[None]:
    """Let simulated time stand meanwhile whenever the driver's setpoints are `fresh` old, or none have come.

    However late a busy machine hands them over, the driver then has them in time, also the first ones.

    Args:
        node: the simulator's.
        accepted: when it took them, as `accept_times` notes it.
        fresh: age of the newest setpoints at which time stands until there are newer ones [s].
    """
    advance: Callable[[], float] = node.advance
    begun = node.simulator.time

    def held() -> float:
        is_fed = node.simulator.time < (accepted[-1] if accepted else begun) + fresh
        return advance() if is_fed else TICK

    node.advance = held
    yield
    node.advance = advance


def set_state(graph: Graph, state: int) -> Result:
    """Ask the simulator for a state."""
    request = SetSimulationState.Request(state=SimulationState(state=state))
    return graph.call(shared.SET_SIMULATION_STATE, request).result


def pause(graph: Graph) -> None:
    """Let simulated time stand still."""
    assert set_state(graph, SimulationState.STATE_PAUSED).result == Result.RESULT_OK


def play(graph: Graph) -> None:
    """Let simulated time go on."""
    assert set_state(graph, SimulationState.STATE_PLAYING).result == Result.RESULT_OK


def stop_arm(graph: Graph) -> None:
    """Stop the arm, by its driver's service."""
    assert graph.call(shared.STOP_ARM, StopArm.Request(reason=WHO)).success


def braking_time(graph: Graph) -> float:
    """Stop the arm and wait until its driver says that it stands; the simulated time between [s]."""
    mail: list[Any] = graph.probe.mail[shared.ARM_STATE.name]
    known = len(mail)
    stop_arm(graph)
    graph.wait_until(lambda: any(message.is_standing for message in mail[known:]), 30.0)
    stopped, standing = mail[known], next(message for message in mail[known:] if message.is_standing)
    assert (stopped.is_stopped, stopped.is_standing, stopped.reason) == (True, False, WHO)
    return from_stamp(standing.header.stamp) - from_stamp(stopped.header.stamp)


def assert_a_pause_loses_nothing(graph: Graph, sim: Any, motion_node: MotionNode) -> float:
    """Pause a simulator in the middle of a move, and let it go on.

    Time stands still, nobody takes it for a fault, the arm moves on as if nothing had been, and the move is
    carried out to its end. Around the pause time passes so slowly that a busy machine loses no joint states,
    and stands where setpoints are late for all that.

    Returns:
        The simulated time of the pause [s].
    """
    graph.probe.listen(shared.DIAGNOSTICS)
    with slowly(sim), standing_without_setpoints(sim, accept_times(sim), AMPLE):
        interruptions = motion_node.health.counts["interrupted"]
        pause(graph)
        stands, mail = sim.simulator.time, graph.probe.mail[shared.DIAGNOSTICS.name]
        heard = len(mail)
        graph.wait_until(lambda: len(mail) > heard + REPORTS * 2)  # each of two nodes reports once a second
        assert sim.simulator.time == stands
        assert (sim.health.faults, motion_node.health.faults) == ({}, {})
        play(graph)
        graph.wait_until(lambda: sim.simulator.time > stands + GOES_ON, 30.0)
        assert motion_node.health.counts["interrupted"] == interruptions
    graph.wait_until(lambda: graph.probe.last(motion.MOTION_STATUS).state == "REACHED", 60.0)
    return float(stands)


def assert_no_jump(samples: Sequence[JointSample], stands: float, velocity: Array) -> None:
    """Between joint states no joint moved faster than it can, and the first after a pause came at once.

    Args:
        samples: joint states before and after the pause; a busy machine may have lost some in between.
        stands: simulated time at which the simulator was paused [s].
        velocity: velocity limits of the joints `(n,)` [rad/s].
    """
    before = max(sample.time for sample in samples if sample.time <= stands + 1e-6)
    after = min(sample.time for sample in samples if sample.time > stands + 1e-6)
    assert after - before < 0.05
    for early, late in pairwise(samples):
        assert np.all(np.abs(late.q - early.q) <= velocity * (late.time - early.time) + 1e-4)
