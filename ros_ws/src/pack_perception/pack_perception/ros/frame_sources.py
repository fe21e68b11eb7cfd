"""Where frames come from, and what perception makes of one: here markers."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol

from pack_interfaces.msg import MocapMarkers

from pack_core.packing.cell import PackingCell
from pack_core.packing.depth import DepthFrame
from pack_core.packing.markers import MarkerFrame
from pack_core.packing.scene import Scene
from pack_core.ros.clock import StampCheck
from pack_core.ros.contracts import packing as contracts
from pack_core.ros.contracts.contract import Contract
from pack_core.ros.messages.packing import from_markers
from pack_core.ros.node import CellNode
from pack_core.ros.stream import Stream
from pack_perception.mocap.hand_over_estimator import HandOverEstimator
from pack_perception.mocap.physics_estimator import Correction
from pack_perception.perception_config import PerceptionConfig

Frame = MarkerFrame | DepthFrame


class FrameSource(Protocol):
    """A kind of sensor, as the node `perception` uses it.

    Attributes:
        told: topic of the description that perception begins with.
        streams: those whose messages make it look for frames.
    """

    told: Contract
    streams: Sequence[Stream]

    def begin(self, scene: Scene) -> HandOverEstimator:
        """The estimate of a scene that was told."""
        ...

    def take(self) -> list[Frame]:
        """The frames that have come, oldest first."""
        ...

    def correct(self, estimator: HandOverEstimator, frame: Frame) -> Correction:
        """Correct an estimate that this source has begun."""
        ...

    def unknown(self, estimator: HandOverEstimator | None) -> str:
        """What has to be known before a goal, in words; empty: nothing."""
        ...


class MarkerSource:
    """Markers that the motion capture system sees.

    Args:
        node: who looks.
        cell: the cell's physical facts.
        config: parameters.
    """

    told = contracts.DESCRIPTION

    def __init__(self, node: CellNode, cell: PackingCell, config: PerceptionConfig) -> None:
        self._node, self._cell, self._config = node, cell, config
        self._stamps = StampCheck(node)
        self._markers = Stream(node, contracts.MARKERS)
        self.streams = (self._markers,)
        self._taken: list[Frame] = []

    def begin(self, scene: Scene) -> HandOverEstimator:
        """The estimate of a scene that was told."""
        return HandOverEstimator(scene, self._cell, self._config)

    def take(self) -> list[Frame]:
        """The frames that have come, oldest first."""
        self._taken = []
        for message in self._markers.take_all():
            self._node.guard(contracts.MARKERS, self._add, message)
        return self._taken

    def correct(self, estimator: HandOverEstimator, frame: Frame) -> Correction:
        """Correct an estimate by markers."""
        assert isinstance(frame, MarkerFrame)
        return estimator.correct(frame)

    def unknown(self, estimator: HandOverEstimator | None) -> str:
        """What has to be known before a goal, in words; empty: nothing."""
        return "" if estimator is not None else f"no {self.told.name} yet: is sim up?"

    def _add(self, message: MocapMarkers) -> None:
        frame = from_markers(message)
        self._stamps.check(frame.time)
        self._taken.append(frame)
