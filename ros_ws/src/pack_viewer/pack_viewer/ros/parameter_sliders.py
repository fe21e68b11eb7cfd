"""Sliders of a running node's parameters: what they are, and between which limits, is asked of the node."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from rcl_interfaces.msg import ParameterEvent
from rclpy.parameter import Parameter, parameter_value_to_python
from rclpy.parameter_client import AsyncParameterClient
from rclpy.task import Future
from viser import GuiApi, GuiEvent

from pack_core.ros.node import CellNode
from pack_viewer.event_log import EventLog
from pack_viewer.ros.run_form import TunedParameters

LOOK_PERIOD = 1.0
"""Between two checks whether the node has come up (again) [s of wall clock]."""
SEND_PERIOD = 0.3
"""Least time between two requests while a slider is dragged [s of wall clock]."""
STEPS = 100
"""Of a slider, from one limit to the other."""
EVENTS = "/parameter_events"


class ParameterSliders:
    """Shows the values that the node has, whoever has changed them, and sets those that are dragged.

    Args:
        node: who asks; it must be spun meanwhile.
        gui: where they are added, once the node is up.
        log: is told what was changed and what was refused.
        wanted: which parameters.

    Attributes:
        sliders: by name of the parameter, without the prefix.
    """

    def __init__(self, node: CellNode, gui: GuiApi, log: EventLog, wanted: TunedParameters) -> None:
        self._node, self._gui, self._log, self._wanted = node, gui, log, wanted
        self._client = AsyncParameterClient(node, wanted.node)
        self._folder = gui.add_folder(wanted.title, expand_by_default=False)
        self.sliders: dict[str, Any] = {}
        self._dragged: dict[str, tuple[float, str]] = {}
        self._is_up = False
        node.create_timer(LOOK_PERIOD, self._look, clock=node.wall)
        node.create_timer(SEND_PERIOD, self._send, clock=node.wall)
        node.create_subscription(ParameterEvent, EVENTS, self._on_event, 100)

    def _look(self) -> None:
        """Ask a node that has come up what it has."""
        was_up, self._is_up = self._is_up, self._client.services_are_ready()
        if self._is_up and not was_up:
            prefix = self._wanted.prefix
            listed = self._client.list_parameters([prefix], 0)
            _then(listed, lambda answer: self._describe(list(answer.result.names)))

    def _describe(self, names: list[str]) -> None:
        if names:
            described = self._client.describe_parameters(names)
            _then(described, lambda answer: self._read(names, answer.descriptors))

    def _read(self, names: list[str], descriptors: list[Any]) -> None:
        def show(answer: Any) -> None:
            for name, descriptor, value in zip(names, descriptors, answer.values, strict=True):
                self._show(name, parameter_value_to_python(value), descriptor)

        _then(self._client.get_parameters(names), show)

    def _show(self, name: str, value: float, descriptor: Any) -> None:
        """Let the slider of a parameter stand where the node has it; make it if there is none."""
        short = name.removeprefix(f"{self._wanted.prefix}.")
        if short in self.sliders:
            self._put(short, value)
            return
        limits = descriptor.floating_point_range
        if not limits or descriptor.read_only:
            return
        least, most = limits[0].from_value, limits[0].to_value
        with self._folder:
            slider = self._gui.add_slider(
                short.replace("_", " "), min=least, max=most, step=(most - least) / STEPS,
                initial_value=value, hint=descriptor.description,
            )  # fmt: skip
        slider.on_update(lambda event: self._on_drag(short, event))
        self.sliders[short] = slider

    def _put(self, short: str, value: float) -> None:
        if short not in self._dragged and self.sliders[short].value != value:
            self.sliders[short].value = value

    def _on_drag(self, short: str, event: GuiEvent[Any]) -> None:
        if event.client is None:  # it was put here
            return
        self._dragged[short] = (float(self.sliders[short].value), f"browser {event.client.client_id + 1}")

    def _send(self) -> None:
        dragged, self._dragged = self._dragged, {}
        for short, (value, who) in dragged.items():
            self.set(short, value, who)

    def set(self, short: str, value: float, who: str) -> None:
        """Have the node take another value; what it refuses is put back."""
        name = f"{self._wanted.prefix}.{short}"

        def judge(answer: Any) -> None:
            (result,) = answer.results
            if result.successful:
                self._log.add(f"{who}: {short.replace('_', ' ')} x {value:g}, {result.reason}", "person")
                return
            self._log.add(result.reason, "error")
            self._is_up = False  # so that what the node has is read again

        _then(self._client.set_parameters([Parameter(name, value=value)]), judge)

    def _on_event(self, event: ParameterEvent) -> None:
        if event.node != self._node.in_cell(f"/{self._wanted.node}"):
            return
        for parameter in (*event.new_parameters, *event.changed_parameters):
            short = parameter.name.removeprefix(f"{self._wanted.prefix}.")
            if short in self.sliders:
                self._put(short, parameter_value_to_python(parameter.value))


def _then(future: Future, act: Callable[[Any], None]) -> None:
    """Go on with an answer once it is there."""
    future.add_done_callback(lambda done: act(done.result()))
