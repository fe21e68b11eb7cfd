"""Pausing simulated time, with the services of simulation_interfaces."""

from __future__ import annotations

import threading

from pack_core.ros.contracts import shared
from pack_core.ros.node import CellNode
from pack_core.ros.simulation_types import GetSimulationState, Result, SetSimulationState, SimulationState

NAMES = {
    SimulationState.STATE_STOPPED: "stopped",
    SimulationState.STATE_PLAYING: "playing",
    SimulationState.STATE_PAUSED: "paused",
    SimulationState.STATE_QUITTING: "quitting",
}
INSTEAD = {
    SimulationState.STATE_STOPPED: "call /sim/reset, which begins anew, and pause first if time shall stand",
    SimulationState.STATE_QUITTING: "end the process of the node 'sim' (Ctrl-C of `pack up`)",
}
"""What to do instead of asking for a state that is not supported."""


class Pause:
    """Lets simulated time stand still and go on.

    Args:
        node: the simulator's node.
        lock: held by the physics while it advances; once `set` has returned, time stands.
    """

    def __init__(self, node: CellNode, lock: threading.Lock) -> None:
        self._node, self._lock = node, lock
        self._playing = threading.Event()
        self._playing.set()
        self._state = node.advertise(shared.SIMULATION_STATE)
        services = (
            (shared.SET_SIMULATION_STATE, self._on_set),
            (shared.GET_SIMULATION_STATE, self._on_get),
        )
        for contract, serve in services:
            node.create_service(contract.type, contract.name, serve)
        self._publish()

    @property
    def is_paused(self) -> bool:
        """Whether simulated time stands still."""
        return not self._playing.is_set()

    def wait(self) -> None:
        """Return when time runs, or the node ends."""
        self._playing.wait()

    def end(self) -> None:
        """Wake who waits, since the node ends."""
        self._playing.set()

    def _on_set(
        self, request: SetSimulationState.Request, response: SetSimulationState.Response
    ) -> SetSimulationState.Response:
        wanted, result = request.state.state, response.result
        if wanted not in (SimulationState.STATE_PLAYING, SimulationState.STATE_PAUSED):
            result.result, result.error_message = Result.FEATURE_UNSUPPORTED, _refusal(wanted)
            return response
        if wanted == self._message().state:
            result.result = SetSimulationState.Response.ALREADY_IN_TARGET_STATE
            result.error_message = f"the simulator is {NAMES[wanted]} already"
            return response
        with self._lock:
            self._playing.set() if wanted == SimulationState.STATE_PLAYING else self._playing.clear()
        self._node.get_logger().info(f"the simulator is {NAMES[wanted]}")
        self._publish()
        result.result = Result.RESULT_OK
        return response

    def _on_get(
        self, _: GetSimulationState.Request, response: GetSimulationState.Response
    ) -> GetSimulationState.Response:
        response.state, response.result.result = self._message(), Result.RESULT_OK
        return response

    def _publish(self) -> None:
        self._state.publish(self._message())

    def _message(self) -> SimulationState:
        state = SimulationState.STATE_PAUSED if self.is_paused else SimulationState.STATE_PLAYING
        return SimulationState(state=state)


def _refusal(state: int) -> str:
    """Why a state is not taken up, and what to do instead."""
    if state in INSTEAD:
        return f"state {state} ({NAMES[state]}) is not supported; {INSTEAD[state]}. Supported: 1 and 2"
    known = ", ".join(f"{number} ({name})" for number, name in NAMES.items())
    return f"state {state} does not exist; known: {known}. Supported: 1 and 2"
