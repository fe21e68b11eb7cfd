"""`pack benchmark hands CELL`: what somebody does by hand in each state, and what becomes of it."""

from __future__ import annotations

from dataclasses import asdict
from typing import Annotated

import typer

from pack_bringup.cli.benchmark_options import Fresh, JsonFile, Output

FILE, SUMMARY = "hands.jsonl", "hands.json"


def hands(
    cell: Annotated[str, typer.Argument(help="Cell to reach into, e.g. `palletizing`.")],
    deed: Annotated[list[str] | None, typer.Option(help="Only this deed; may be repeated.")] = None,
    state: Annotated[list[str] | None, typer.Option(help="Only in this state; may be repeated.")] = None,
    seed: Annotated[int, typer.Option(min=0, help="Of where boxes arrive and of noise.")] = 0,
    output: Output = None,
    fresh: Fresh = False,
    json_file: JsonFile = None,
) -> None:
    """Reach into a cell while it works, in each of its states, and tell what becomes of it.

    Objects are removed, turned, moved, exchanged and added, the vacuum is lost, the camera is silent. It runs
    without ROS on simulated time and repeats bit for bit. The table says what the cell noticed and when, how
    the order or problem ended, and what truly stands where it should.

    A case takes a quarter of a minute; interrupted, the table goes on where it was.

    - `pack benchmark hands palletizing`
    - `pack benchmark hands blocks --deed "block removed"`
    """
    from pack_bringup.cli.json_file import write_json
    from pack_bringup.cli.live import command_line
    from pack_bringup.cli.output_folder import make_output_folder
    from pack_bringup.cli.terminal import show_table
    from pack_bringup.cli.trial_progress import TrialProgress
    from pack_core.cells import cell_part
    from pack_core.paths import bags_path
    from pack_evaluation.provenance import provenance
    from pack_lockstep.benchmarking.benchmark import Verdict
    from pack_lockstep.benchmarking.trial_file import TrialFile
    from pack_lockstep.hands import HAND_COLUMNS, hand_row

    part = cell_part(cell, "hands")
    cases = part.wanted(deed or (), state or ())
    folder = output or bags_path() / "benchmarks" / f"hands_{cell}"
    make_output_folder(folder)
    if fresh:
        (folder / FILE).unlink(missing_ok=True)
    results = TrialFile(folder / FILE, cell, {"hands": "1", "seed": seed}, provenance(command_line()))
    left = [case for case in cases if case.name not in results.trials]
    with TrialProgress(len(cases), len(cases) - len(left)) as bar:
        for case in left:
            results.add(asdict(part.run(case, seed)))
            _, _, noticed, _, ended, *_ = hand_row(results.trials[case.name])
            bar.add(Verdict(case.name, not results.trials[case.name]["problem"], f"{ended}; {noticed}"))
    kept = [results.trials[case.name] for case in cases]
    rows = [hand_row(report) for report in kept]
    show_table(HAND_COLUMNS, rows, title=f"By hand in the cell {cell}", note=part.note)
    for path in filter(None, (folder / SUMMARY, json_file)):
        write_json(path, {"cell": cell, "seed": seed, "cases": kept})
