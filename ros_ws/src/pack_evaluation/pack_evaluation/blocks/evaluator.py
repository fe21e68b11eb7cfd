"""Evaluation of a rearrangement, with its plans step by step."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from pack_core.blocks.cell import blocks_cell
from pack_core.blocks.problem import PlacedBlock
from pack_evaluation.blocks.from_bag import BlocksRun, load_blocks_run
from pack_evaluation.blocks.measures import BlocksMeasures, measure
from pack_evaluation.blocks.plan_drawing import write_plan
from pack_evaluation.blocks.video import write_strip, write_video
from pack_evaluation.evaluator import Evaluation, Evaluator, OnProgress
from pack_evaluation.html import embedded, render
from pack_evaluation.record import about_the_run

TEMPLATE = Path(__file__).with_name("report.html.j2")


class BlocksEvaluator(Evaluator[BlocksRun, BlocksMeasures]):
    """Evaluates the rearrangement of a recording."""

    def load(self, path: Path, goal: int | None = None) -> BlocksRun:
        """A rearrangement in a recording."""
        return load_blocks_run(path, goal)

    def measure(self, run: BlocksRun) -> BlocksMeasures:
        """Everything that is measured of the run."""
        return measure(run)

    def draw(self, run: BlocksRun, folder: Path) -> list[Path]:
        """Every plan, from where its blocks stood when it was made."""
        drawn = []
        for number, plan in enumerate(run.plans, 1):
            first = {action.block: action.start for action in reversed(plan.actions)}
            blocks = tuple(
                PlacedBlock(b.id, first.get(b.id, run.problem.goals[b.id])) for b in run.problem.blocks
            )
            problem = replace(run.problem, blocks=blocks)
            drawn.append(write_plan(problem, plan, folder / f"plan_{number}.png"))
        return drawn

    def film(self, run: BlocksRun, path: Path, progress: OnProgress) -> None:
        """Render the run as MP4."""
        write_video(run, blocks_cell(), path, progress)

    def page(self, found: Evaluation[BlocksRun, BlocksMeasures]) -> str:
        """The report."""
        return render(
            TEMPLATE, title=f"{len(found.run.problem.blocks)} blocks", run=found.run,
            measures=found.measures, rows=found.rows, plots=[embedded(plot) for plot in found.plots],
            video=embedded(found.video) if found.video else "",
            replay=found.replay.name if found.replay else "",
            record=about_the_run(found.record),
        )  # fmt: skip

    def still(self, run: BlocksRun, path: Path) -> None:
        """Write moments evenly spread over the run, row by row."""
        write_strip(run, blocks_cell(), path)


EVALUATOR = BlocksEvaluator()
