"""The action /fill_container: which goals are taken, and how they are reported."""

from __future__ import annotations

from collections.abc import Callable

from pack_interfaces.action import FillContainer
from std_msgs.msg import String

from pack_core.packing.cell import PackingCell
from pack_core.packing.goals import FillMethod
from pack_core.packing.packing_list import parse_list
from pack_core.packing.scene import Scene
from pack_core.ros.contracts import packing as contracts
from pack_core.ros.node import CellNode
from pack_mpc.filling.fill_config import FillSessionConfig
from pack_mpc.ros.fill_clients import FillClients
from pack_mpc.ros.fill_goal import FillGoal
from pack_mpc.ros.fill_messages import to_fill_progress, to_fill_report, to_fill_result
from pack_mpc.ros.mailbox import Mailbox
from pack_mpc.ros.pack_goal import PlacementClient


class FillAction:
    """Begins fill jobs and tells what became of them.

    Args:
        node: that takes the goals.
        placements: asks the planner for placements.
        cell: the cell's physical facts.
    """

    def __init__(self, node: CellNode, placements: PlacementClient, cell: PackingCell) -> None:
        self._placements, self._cell = placements, cell
        self._clients = FillClients(node)
        self._result = node.advertise(contracts.FILL_RESULT)
        self._progress = node.advertise(contracts.FILL_PROGRESS)
        self._told: object = None

    def refusal(self, request: FillContainer.Goal, scene: Scene | None, mailbox: Mailbox) -> str:
        """Why a job cannot begin, in words; empty if it can.

        Raises:
            PackError: the list or the method cannot be used.
        """
        FillMethod.of(request.method)
        parse_list(request.list, "goal", self._cell)
        if scene is None or mailbox.joints is None:
            return f"no {contracts.DESCRIPTION.name} or {contracts.JOINT_STATES.name} yet: is sim up?"
        held = scene.new_object.name
        return f"the pump holds '{held}'; allowed: an empty cup" if mailbox.is_held else ""

    def begin(
        self, request: FillContainer.Goal, config: FillSessionConfig, scene: Callable[[], Scene], time: float
    ) -> FillGoal:
        """The job of an accepted goal; `scene` returns the newest description of the cell."""
        given, method = parse_list(request.list, "goal", self._cell), FillMethod.of(request.method)
        return FillGoal(
            self._clients, self._placements, self._cell, config, given, method, request.seed, scene, time
        )

    def tell(self, goal: FillGoal, time: float) -> None:
        """Publish where a job stands at `time` [s], if that has changed."""
        job = goal.job
        now = (job.stage, job.current, len(job.report.objects), len(job.report.fills))
        if now != self._told:
            self._told = now
            self._progress.publish(String(data=to_fill_progress(goal, time)))

    def report(self, goal: FillGoal, time: float) -> FillContainer.Result:
        """Publish what became of a job that ended at `time` [s], and return the action's result."""
        self._result.publish(String(data=to_fill_report(goal)))
        return to_fill_result(goal, time)
