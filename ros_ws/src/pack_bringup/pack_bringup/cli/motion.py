"""`pack benchmark motion`: planners of the arms' moves, side by side on recorded requests."""

from __future__ import annotations

from typing import Annotated

import typer

from pack_bringup.cli.options import JsonFile
from pack_bringup.cli.outputs import command_line, write_json
from pack_bringup.cli.terminal import TrialProgress, notice, show_table


def motion(
    planner: Annotated[
        list[str] | None, typer.Option(help="Planner by its name; may be repeated. Default: shipped.")
    ] = None,
    requests: Annotated[
        list[str] | None,
        typer.Option(help="Set of requests, recorded or harder; may be repeated. Default: both."),
    ] = None,
    record: Annotated[
        bool, typer.Option("--record", help="Record both sets anew first, from runs in lockstep.")
    ] = False,
    json_file: JsonFile = None,
) -> None:
    """Plan recorded requests of the cells' arms, and have every plan checked by other code.

    The set recorded has what orders and problems of blocks asked of the arms in lockstep; in harder,
    something stands in the way of transfers that height alone does not clear. A plan counts as a success if
    it keeps limits, ends and clearance by MuJoCo's own distances. Planning is timed as processor time of its
    thread. With toppra installed, durations are compared with the least that the same path takes without
    limits of jerk.

    - `pack benchmark motion`
    - `pack benchmark motion --requests harder --planner shipped --planner height`
    - `pack benchmark motion --planner ompl --json motion.json`
    """
    from pack_evaluation.provenance import provenance
    from pack_lockstep.benchmarking.benchmark import Verdict
    from pack_lockstep.motion.benchmark import (
        MOTION_COLUMNS,
        SETS,
        count_trials,
        motion_row,
        motion_summary,
        record_requests,
        run_motion_benchmark,
    )

    if record:
        notice("recording takes several minutes", typer.colors.YELLOW)
        record_requests()
    chosen = requests or list(SETS), planner or ["shipped"]
    trials = []
    with TrialProgress(count_trials(*chosen)) as bar:
        for trial in run_motion_benchmark(*chosen):
            trials.append(trial)
            text = trial.problem or f"{trial.planner}, planned in {trial.planning_ms:.0f} ms"
            bar.add(Verdict(trial.name, not trial.problem, text))
    summary = motion_summary(trials)
    show_table(MOTION_COLUMNS, [motion_row(kind) for kind in summary])
    if json_file is not None:
        write_json(json_file, {**provenance(command_line()), "results": summary})
