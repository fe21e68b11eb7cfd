"""A goal before your eyes: of a cell that runs, or of one that is started for it and evaluated afterwards."""

from __future__ import annotations

import shutil
import signal
from collections.abc import Callable
from typing import Any, NoReturn

import typer

from pack_bringup.cli.evaluate import evaluator_of, run_evaluation, show
from pack_bringup.cli.options import CellAddress, domain_of, prepare_network
from pack_bringup.cli.outputs import make_output_folder
from pack_bringup.cli.terminal import LiveLine, end_as_by_ctrl_c, notice
from pack_bringup.graph.running import cell_nodes_here, names_of, nodes_here, place, running_cells
from pack_bringup.job import LOG, CellGoal, Job, progress_of, run_demo
from pack_bringup.pace import Pace
from pack_bringup.recording.run_record import BAG_FOLDER
from pack_bringup.viewers import PageProcess
from pack_core.errors import BagError, PackError
from pack_evaluation.record import RECORD


def run_goal(
    goal: CellGoal, at: CellAddress, *, reset: bool, show: Callable[[Any], None] = lambda _: None
) -> NoReturn:
    """Send a goal, show how it goes, and leave with 0 if it succeeded and 1 if not.

    Ctrl-C cancels the goal; its result is still waited for. A second one leaves at once.

    Args:
        goal: what to do.
        at: the cell.
        reset: whether the cell is put into the goal's scene first.
        show: shows what the result says beyond its message.

    Raises:
        PackError: the cell does not run here, or the goal was refused.
    """
    prepare_network(at.network)
    from pack_bringup.ros.goal_client import GoalClient, follow_goal

    where, namespace = domain_of(at.domain), at.namespace
    if not at.network:
        _check_running(goal.cell, where, namespace)
    # Those that run here: a cell may lack some, as the simulator beside a real arm, or have them elsewhere.
    names = sorted({goal.server} | nodes_here(goal.cell, where, namespace))
    canceling = _Canceling()
    with LiveLine() as line:

        def on_turn(node: GoalClient) -> None:
            canceling.serve(node)
            line.show(progress_of(goal, node, Pace(0.0)))

        def make() -> GoalClient:
            contract, message = goal.goal()
            scene = goal.reset() if reset else None
            return GoalClient(contract, message, names, scene, namespace=namespace)

        result = follow_goal(make, on_turn, domain=where)
    reason = getattr(result, "exit_reason", "success" if result.success else "failure")
    typer.echo(f"goal ended: {reason}" + (f", {result.message}" if result.message else ""))
    show(result)
    raise typer.Exit(0 if result.success else 1)


def _check_running(cell: str, domain: int, namespace: str) -> None:
    here = cell_nodes_here(domain, namespace)
    if here and here <= names_of(cell):
        return
    others = [f"in {place(*other)} {what}" for other, what in running_cells().items()]
    elsewhere = f"; {', '.join(others)} (--domain, --namespace)" if others else ""
    raise PackError(
        f"no node of the {cell} cell runs in {place(domain, namespace)} on this machine: "
        f"`pack up {cell}` starts it{elsewhere}"
    )


class _Canceling:
    """Turns the first Ctrl-C into a request for the goal's end, and the second into ours."""

    def __init__(self) -> None:
        self._wanted, self._asked = 0, False
        for number in (signal.SIGINT, signal.SIGTERM):
            signal.signal(number, self._on_signal)

    def serve(self, node: Any) -> None:
        """Pass the request on, if a goal is under way or about to be."""
        if not self._wanted or self._asked:
            return
        if not node.is_sent:
            raise typer.Exit(130)
        self._asked = True
        typer.echo("canceling; Ctrl-C once more leaves the goal to itself")
        node.cancel()

    def _on_signal(self, *_: Any) -> None:
        self._wanted += 1
        if self._wanted > 1:
            raise typer.Exit(130)


def run_live(
    job: Job, *, video: bool, domain: int | None = None, page: PageProcess | None = None
) -> NoReturn:
    """Run a job, evaluate its recording, and leave with 0 only if it succeeded.

    Args:
        job: what to run.
        video: render the run for the report.
        domain: ROS domain id; None: the environment's, else a free one.
        page: a page that shows the run while it goes on; None: none.

    Raises:
        PackError: the folder cannot take the run, a node did not come up or died, or the goal was refused.
    """
    result, pace = run_nodes(job, domain, page, taken_by=())
    try:
        found = run_evaluation(evaluator_of(job.folder), job.folder, job.folder, with_video=video)
    except KeyboardInterrupt:
        typer.echo(f"stopped before the report was written: `pack evaluate {job.folder}` writes it")
        raise typer.Exit(130) from None
    except BagError:
        if result.success:
            raise
        # A goal that fails before the arm has moved is recorded, with nothing in it to measure.
        typer.echo(f"there is no report: the goal ended before its work began\nlog:    {job.folder / LOG}")
        raise typer.Exit(1) from None
    show(found)
    end_live(job, result, pace)


def run_nodes(
    job: Job, domain: int | None, page: PageProcess | None, *, taken_by: tuple[str, ...]
) -> tuple[Any, Pace]:
    """Start the nodes of a job, pursue its goal, and say how that ended; Ctrl-C ends the program.

    Args:
        job: what to run.
        domain: ROS domain id; None: the environment's, else a free one.
        page: a page that shows the run while it goes on; None: none.
        taken_by: names of files, besides those of every run, that the job's folder must not have yet.

    Returns:
        The action's result, and whether the nodes kept up with the clock.

    Raises:
        PackError: as `run_live`; what is refused before a node is started leaves no folder behind.
    """
    prepare_network()
    is_new = not job.folder.exists()
    make_output_folder(job.folder, taken_by=(BAG_FOLDER, RECORD, LOG, *taken_by))
    end_as_by_ctrl_c()
    if page:
        typer.echo(page.announcement)
    try:
        with LiveLine() as line:
            result, pace = run_demo(job, line.show, domain, page)
    except KeyboardInterrupt:
        typer.echo(f"stopped; what was recorded is in {job.folder}")
        raise typer.Exit(130) from None
    except PackError:
        # Refused before a node was started: the log would be there otherwise.
        if is_new and not (job.folder / LOG).exists():
            shutil.rmtree(job.folder)
        raise
    reason = getattr(result, "exit_reason", "success" if result.success else "failure")
    typer.echo(f"goal ended: {reason}" + (f", {result.message}" if result.message else ""))
    return result, pace


def end_live(job: Job, result: Any, pace: Pace) -> NoReturn:
    """Say where the log is and whether the nodes kept up, and leave with 0 only if the job succeeded."""
    typer.echo(f"log:    {job.folder / LOG}")
    if pace.warning:
        notice(pace.warning, typer.colors.YELLOW)
    raise typer.Exit(0 if result.success else 1)
