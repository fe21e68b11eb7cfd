"""Evaluation of a rearrangement, with its plans step by step."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

from pack_core.blocks.problem import PlacedBlock
from pack_evaluation.blocks.from_bag import BlocksRun, load_blocks_run
from pack_evaluation.blocks.measures import BlocksMeasures, measure
from pack_evaluation.blocks.plan_drawing import write_plan
from pack_evaluation.blocks.video import SPEED, write_strip, write_video
from pack_evaluation.evaluator import Evaluation, Evaluator


def draw(run: BlocksRun, folder: Path) -> list[Path]:
    """Every plan, from where its blocks stood when it was made."""
    drawn = []
    for number, plan in enumerate(run.plans, 1):
        first = {action.block: action.start for action in reversed(plan.actions)}
        blocks = tuple(
            PlacedBlock(b.id, first.get(b.id, run.problem.goals[b.id]), b.size) for b in run.problem.blocks
        )
        problem = replace(run.problem, blocks=blocks)
        drawn.append(write_plan(problem, plan, folder / f"plan_{number}.png"))
    return drawn


def report(found: Evaluation[BlocksRun, BlocksMeasures]) -> dict[str, Any]:
    """What the report says of a rearrangement."""
    measures = found.measures
    return {
        "title": f"{len(found.run.problem.blocks)} blocks", "success": measures.success,
        "verdict": measures.exit_reason, "message": measures.message,
    }  # fmt: skip


EVALUATOR = Evaluator(
    load_blocks_run, measure, draw, write_video, "blocks/report.html.j2", report, SPEED, write_strip
)
