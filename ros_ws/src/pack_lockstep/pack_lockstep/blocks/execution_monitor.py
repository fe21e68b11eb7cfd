"""What an execution did to the blocks, from the simulator's truth."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from block_fsm.requests import ExecutorRequest, Look, MoveArm, MoveFingers
from pack_core.blocks.planar import PlanarPose
from pack_core.rotations import Pose, angle_between
from pack_core.states import SceneState


@dataclass(frozen=True)
class Slip:
    """How far a block moved in the hand between being lifted and being let go [m, rad]."""

    distance: float
    angle: float


class ExecutionMonitor:
    """Is shown every request before it is carried out.

    Attributes:
        slips: of every block that was carried.
        disturbance: farthest that a block was moved by an action on another one [m].
    """

    def __init__(self) -> None:
        self.slips: list[Slip] = []
        self.disturbance = 0.0
        self._before: dict[str, PlanarPose] = {}
        self._carried: tuple[str, Pose] | None = None

    def on_request(self, request: ExecutorRequest, truth: SceneState, X_WT: Pose, block: str) -> None:
        """Note what a request is about to change.

        Args:
            request: what is about to be carried out.
            truth: where the blocks are.
            X_WT: where the tool is.
            block: that the action under way is on; empty between actions.
        """
        if isinstance(request, MoveArm) and request.path.segments[0].label == "lift":
            self._carried = (block, X_WT.inverse() @ truth.objects[block].X_WO)
        elif isinstance(request, MoveFingers) and self._carried is not None:
            self._note_slip(truth, X_WT)
        elif isinstance(request, Look):
            self._note_bystanders({name: PlanarPose.of(o.X_WO) for name, o in truth.objects.items()}, block)

    def _note_slip(self, truth: SceneState, X_WT: Pose) -> None:
        assert self._carried is not None
        (block, X_TB), self._carried = self._carried, None
        now = X_WT.inverse() @ truth.objects[block].X_WO
        distance = float(np.linalg.norm(now.p - X_TB.p))
        self.slips.append(Slip(distance, float(angle_between(now.q, X_TB.q))))

    def _note_bystanders(self, now: dict[str, PlanarPose], moved: str) -> None:
        for name, pose in self._before.items():
            if name != moved:
                self.disturbance = max(self.disturbance, pose.distance_to(now[name]))
        self._before = now
