"""Pausing a simulator and stopping its arm, as a test's probe does it."""

from __future__ import annotations

from typing import Any

from pack_interfaces.msg import SimulationResult, SimulationState
from pack_interfaces.srv import SetSimulationState, StopArm

from integration.harness import Graph
from pack_core.ros.contracts import shared
from pack_core.ros.conversions import from_stamp

WHO = "the test's button"


def set_state(graph: Graph, state: int) -> SimulationResult:
    """Ask the simulator for a state."""
    request = SetSimulationState.Request(state=SimulationState(state=state))
    return graph.call(shared.SET_SIMULATION_STATE, request).result


def pause(graph: Graph) -> None:
    """Let simulated time stand still."""
    assert set_state(graph, SimulationState.STATE_PAUSED).result == SimulationResult.RESULT_OK


def play(graph: Graph) -> None:
    """Let simulated time go on."""
    assert set_state(graph, SimulationState.STATE_PLAYING).result == SimulationResult.RESULT_OK


def stop_arm(graph: Graph) -> None:
    """Stop the arm, by its driver's service."""
    assert graph.call(shared.STOP_ARM, StopArm.Request(reason=WHO)).success


def braking_time(graph: Graph) -> float:
    """Stop the arm and wait until its driver says that it stands; the simulated time between [s]."""
    mail: list[Any] = graph.probe.mail[shared.ARM_STATE.name]
    known = len(mail)
    stop_arm(graph)
    graph.wait_until(lambda: any(message.is_standing for message in mail[known:]), 30.0)
    stopped, standing = mail[known], mail[-1]
    assert (stopped.is_stopped, stopped.is_standing, stopped.reason) == (True, False, WHO)
    return from_stamp(standing.header.stamp) - from_stamp(stopped.header.stamp)
