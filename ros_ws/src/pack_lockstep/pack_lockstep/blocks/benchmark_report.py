"""The report of a benchmark of the blocks cell: one HTML file that needs nothing beside it."""

from __future__ import annotations

from base64 import b64encode
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from io import BytesIO
from pathlib import Path
from typing import Any

from pack_core.blocks.cell import BlocksCell
from pack_core.blocks.plan import Diagnosis, Plan, PlanStatus
from pack_core.blocks.plan_record import from_record
from pack_evaluation.blocks.plan_drawing import draw_plan
from pack_evaluation.html import render
from pack_evaluation.provenance import checked_out_commit, installed_versions
from pack_evaluation.table import TextTable
from pack_lockstep.blocks.benchmark import PlanJob

TEMPLATE = Path(__file__).with_name("benchmark.html.j2")


@dataclass(frozen=True)
class Picture:
    """A plan drawn step by step, as a base64 PNG."""

    name: str
    data: str


def report_benchmark(
    results: Path,
    table: TextTable,
    jobs: Sequence[PlanJob],
    lines: Sequence[Mapping[str, Any]],
    cell: BlocksCell,
    command: str,
    pictures: int,
) -> Path:
    """Write the report beside the results and return its path.

    Args:
        results: the file of the lines.
        table: of the methods' summaries.
        jobs: what was run.
        lines: the results of the jobs.
        cell: the instances' cell.
        command: the command line.
        pictures: instances whose plans are drawn.
    """
    versions = ", ".join(f"{name} {number}" for name, number in installed_versions().items())
    about = {
        "command": command,
        "commit": checked_out_commit(),
        "versions": versions,
        "results": results.name,
    }
    text = render(
        TEMPLATE, tables=(table, trial_table(lines, table.head[1:])), about=about,
        pictures=draw_plans(jobs, lines, cell, pictures),
    )  # fmt: skip
    path = results.with_suffix(".html")
    path.write_text(text)
    return path


def trial_table(lines: Sequence[Mapping[str, Any]], methods: Sequence[str]) -> TextTable:
    """Every instance, the methods side by side."""
    by_name = {(line["instance"], line["method"]): line for line in lines}
    rows = tuple(
        (name, *(_outcome(by_name.get((name, method))) for method in methods))
        for name in dict.fromkeys(line["instance"] for line in lines)
    )
    note = "Status, actions (lower bound), milliseconds to the first plan."
    return TextTable("Instances", note, ("instance", *methods), rows)


def draw_plans(
    jobs: Iterable[PlanJob], lines: Sequence[Mapping[str, Any]], cell: BlocksCell, count: int
) -> list[Picture]:
    """The plans of the first `count` instances, of every method."""
    instances = list(dict.fromkeys(line["instance"] for line in lines))[:count]
    by_name = {line["name"]: line for line in lines if line["instance"] in instances}
    drawn = []
    for job in jobs:
        if line := by_name.get(job.name):
            status = PlanStatus[line["status"]]
            actions, diagnosis = from_record(line["plan"]), Diagnosis(line["message"])
            made = Plan(status, actions, line["lower_bound"], diagnosis)
            buffer = BytesIO()
            draw_plan(job.instance.problem(cell), made).savefig(buffer, format="png", dpi=110)
            drawn.append(Picture(job.name, b64encode(buffer.getvalue()).decode()))
    return drawn


def _outcome(line: Mapping[str, Any] | None) -> str:
    if line is None:
        return ""
    if not line["is_solved"]:
        return f"{line['status']}: {line['message']}"
    text = f"{line['status']}, {line['actions']} ({line['lower_bound']}), {line['first_plan_ms']:.1f} ms"
    return "; ".join([text, *line["faults"]])
