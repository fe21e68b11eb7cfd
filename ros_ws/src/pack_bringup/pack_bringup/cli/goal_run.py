"""What the goal commands of all cells share: options, and following a goal to its end."""

from __future__ import annotations

import signal
from collections.abc import Callable
from typing import Annotated, Any, NoReturn

import typer

from pack_bringup.cell_goal import CellGoal
from pack_bringup.cli.domain_option import domain_of
from pack_bringup.cli.live import LiveLine
from pack_bringup.cli.network_option import prepare_network
from pack_bringup.demo import progress_of
from pack_bringup.graph.running import nodes_here, running_cells
from pack_bringup.pace import Pace
from pack_core.errors import PackError

Reset = Annotated[
    bool, typer.Option(help="Put the cell into the goal's scene first; --no-reset: as the cell stands.")
]


def run_goal(
    goal: CellGoal, *, reset: bool, domain: int | None, network: str,
    show: Callable[[Any], None] = lambda _: None,
) -> NoReturn:  # fmt: skip
    """Send a goal, show how it goes, and leave with 0 if it succeeded and 1 if not.

    Ctrl-C cancels the goal; its result is still waited for. A second one leaves at once.

    Args:
        goal: what to do.
        reset: whether the cell is put into the goal's scene first.
        domain: ROS domain id; None: the environment's.
        network: the network of a cell on several machines; empty: this machine.
        show: shows what the result says beyond its message.

    Raises:
        PackError: the cell does not run here, or the goal was refused.
    """
    prepare_network(network)
    from pack_bringup.ros.follow_goal import follow_goal
    from pack_bringup.ros.goal_client import GoalClient

    where = domain_of(domain)
    if not network:
        _check_running(goal.cell, where)
    # Those that run here: a cell may lack some, as the simulator beside a real arm, or have them elsewhere.
    names = sorted({goal.server} | nodes_here(goal.cell, where))
    canceling = _Canceling()
    with LiveLine() as line:

        def on_turn(node: GoalClient) -> None:
            canceling.serve(node)
            line.show(progress_of(goal, node, Pace(0.0)))

        def make() -> GoalClient:
            contract, message = goal.goal()
            return GoalClient(contract, message, names, goal.reset() if reset else None)

        result = follow_goal(make, on_turn, domain=where)
    reason = getattr(result, "exit_reason", "success" if result.success else "failure")
    typer.echo(f"goal ended: {reason}" + (f", {result.message}" if result.message else ""))
    show(result)
    raise typer.Exit(0 if result.success else 1)


def _check_running(cell: str, domain: int) -> None:
    if nodes_here(cell, domain):
        return
    others = [f"in domain {number} {what}" for number, what in running_cells().items()]
    elsewhere = f"; {', '.join(others)} (--domain)" if others else ""
    raise PackError(
        f"no node of the {cell} cell runs in ROS domain {domain} on this machine: "
        f"`pack up {cell}` starts it{elsewhere}"
    )


class _Canceling:
    """Turns the first Ctrl-C into a request for the goal's end, and the second into ours."""

    def __init__(self) -> None:
        self._wanted, self._asked = 0, False
        for number in (signal.SIGINT, signal.SIGTERM):
            signal.signal(number, self._on_signal)

    def serve(self, node: Any) -> None:
        """Pass the request on, once there is a goal to cancel."""
        if not self._wanted or self._asked:
            return
        if not node.is_accepted:
            raise typer.Exit(130)
        self._asked = True
        typer.echo("canceling; Ctrl-C once more leaves the goal to itself")
        node.cancel()

    def _on_signal(self, *_: Any) -> None:
        self._wanted += 1
        if self._wanted > 1:
            raise typer.Exit(130)
